#pragma once
/// Passes over all pixels of a picture.
#include <initializer_list>
#include <string>
#include <vector>

#include "render/gl.h"

namespace rubble::render {

/// One of the shaders that end in pixels_end.glsl: as a fragment shader, or the same text as a compute
/// shader.
class ScreenPass {
 public:
  /// `added`: adds to its target, which is RGBA32F.
  ScreenPass(const std::string& file, bool computes, std::vector<std::string> defines = {},
             bool added = false);
  gl::Program& program() { return program_; }
  /// Writes every pixel of the targets. `framebuffer` has the same ones; textures must be bound and uniforms
  /// set.
  void run(const gl::Framebuffer& framebuffer, std::initializer_list<const gl::Texture*> targets);

 private:
  bool computes_, added_;
  gl::Program program_;
  gl::VertexArray nothing_;
};

}  // namespace rubble::render
