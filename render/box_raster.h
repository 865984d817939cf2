#pragma once
/// Boxes by compute shaders. Small boxes by the million are slow as triangles: a GPU made for computing
/// (H100) runs vertex and fragment shaders on a few of its multiprocessors only, and compute on all of them.
#include <cstdint>

#include "render/camera.h"
#include "render/gl.h"

namespace rubble::render {

/// The rays through the centers of the pixels of a view, from the pixel at the lower left on, in the
/// renderer's frame.
struct Rays {
  Vec3f origin, originX, originY;  ///< and what one pixel to the right and one upwards add [m]
  Vec3f direction, directionX,
      directionY;             ///< to view depth 1, or for parallel rays to the far side: depth 1
  int width = 0, height = 0;  ///< pixels
};

/// Rays of an eye whose picture is shifted in normalised device coordinates.
Rays raysOf(const Eye& eye, float jitterX, float jitterY, int width, int height);

/// Needs gl::canCompute().
class BoxRaster {
 public:
  BoxRaster();
  /// Draws the boxes of the first `boxCount` slots into the framebuffer that is bound, with its depth test.
  /// Poses and looks must be bound to the texture units 0 and 1. `nearest`: of the view [m], or 0 for
  /// parallel rays. `named`: what is seen, and not depth alone.
  void draw(std::uint32_t boxCount, const Rays& rays, const Matrix& viewProjection, float nearest,
            bool named);

 private:
  void rasterize(gl::Program (&programs)[2], std::uint32_t boxCount, const Rays& rays,
                 const Matrix& viewProjection, float nearest, bool naming);

  gl::Buffer depths_{GL_SHADER_STORAGE_BUFFER}, slots_{GL_SHADER_STORAGE_BUFFER},
      lists_{GL_SHADER_STORAGE_BUFFER};
  gl::VertexArray nothing_;
  gl::Program clear_{gl::ComputeFile{"boxes_clear.comp"}};
  gl::Program seen_[2], lit_[2];  ///< of a thread a box, of many
  gl::Program putSeen_, putLit_;
};

}  // namespace rubble::render
