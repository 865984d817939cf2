#include "render/screen_pass.h"

namespace rubble::render {
namespace {

constexpr int kGroupWidth = 16, kGroupHeight = 8;  ///< threads, as in pixels.glsl

std::vector<std::string> with(std::vector<std::string> defines, bool wanted, const char* define) {
  if (wanted) defines.emplace_back(define);
  return defines;
}

}  // namespace

ScreenPass::ScreenPass(const std::string& file, bool computes, std::vector<std::string> defines, bool added)
    : computes_(computes),
      added_(added),
      program_(computes ? gl::Program(gl::ComputeFile{file},
                                      with(with(std::move(defines), added, "ADDED"), true, "COMPUTE"))
                        : gl::Program("screen.vert", file, defines)) {}

void ScreenPass::run(const gl::Framebuffer& framebuffer, std::initializer_list<const gl::Texture*> targets) {
  program_.use();
  if (!computes_) {
    framebuffer.bind();
    if (added_) {
      glEnable(GL_BLEND);
      glBlendFunc(GL_ONE, GL_ONE);
    }
    glBindVertexArray(nothing_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
    return;
  }
  GLuint image = 0;
  for (const gl::Texture* target : targets)
    glBindImageTexture(image++, target->id(), 0, GL_FALSE, 0, added_ ? GL_READ_WRITE : GL_WRITE_ONLY,
                       target->format());
  const gl::Texture& first = **targets.begin();
  program_.setPixels("targetSize", first.width(), first.height());
  glDispatchCompute(static_cast<GLuint>((first.width() + kGroupWidth - 1) / kGroupWidth),
                    static_cast<GLuint>((first.height() + kGroupHeight - 1) / kGroupHeight), 1);
  // It is read by shaders, copied to the host or the window, drawn over and added to.
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                  GL_FRAMEBUFFER_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
}

}  // namespace rubble::render
