#pragma once
#include "render/bodies.h"
#include "render/renderer.h"

namespace rubble::render {

/// Deformable surfaces on the GPU.
class Surfaces {
 public:
  void set(std::span<const Surface> surfaces);
  /// `firstSlot` is the slot of the first surface in the tables of the bodies, which must be bound.
  void draw(const DrawView& view, std::uint32_t firstSlot);

 private:
  struct Part {
    gl::VertexArray array;
    gl::Buffer vertices{GL_ARRAY_BUFFER}, indices{GL_ELEMENT_ARRAY_BUFFER};
    GLsizei indexCount = 0;
  };
  std::vector<Part> parts_;
  std::size_t used_ = 0;
  gl::Program program_{"surface.vert", "body.frag", {"MESH", "HEAT"}},
      depths_{"surface.vert", "nothing.frag", {"MESH"}};
};

}  // namespace rubble::render
