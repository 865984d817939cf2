#pragma once
#include <span>

#include "render/camera.h"
#include "render/gl.h"
#include "render/overlay.h"

namespace rubble::render {

/// Lines over a finished picture: fainter where bodies are before them.
class Lines {
 public:
  void set(std::span<const Line> lines, const Vec3& origin);
  bool empty() const { return count_ == 0; }
  /// Onto the bound framebuffer, whose picture has these depths.
  void draw(const Eye& eye, const gl::Texture& depths);

 private:
  gl::VertexArray array_;
  gl::Buffer buffer_{GL_ARRAY_BUFFER};
  gl::Program program_{"line.vert", "line.frag"};
  GLsizei count_ = 0;
};

}  // namespace rubble::render
