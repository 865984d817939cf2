#include "render/lines.h"

#include <cmath>
#include <cstddef>

namespace rubble::render {
namespace {

/// A line as the shader reads it.
struct Instance {
  Vec3f a, b;
  float width;
  std::uint32_t color;
};

bool finite(const Vec3f& p) { return std::isfinite(p.x + p.y + p.z); }

}  // namespace

void Lines::set(std::span<const Line> lines, const Vec3& origin) {
  std::vector<Instance> instances;
  for (const Line& line : lines) {
    const Vec3f a(line.a - origin), b(line.b - origin);
    const std::uint32_t rgba = (line.rgb >> 16 & 255u) | (line.rgb & 0xff00u) | (line.rgb & 255u) << 16 |
                               0xff000000u;
    if (finite(a) && finite(b)) instances.push_back({a, b, line.width, rgba});
  }
  count_ = static_cast<GLsizei>(instances.size());
  if (count_ == 0) return;
  glBindVertexArray(array_.id());
  buffer_.upload(instances.data(), instances.size() * sizeof(Instance));
  const auto attribute = [](GLuint index, GLint numbers, GLenum type, GLboolean normalized,
                            std::size_t offset) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, numbers, type, normalized, sizeof(Instance),
                          reinterpret_cast<const void*>(offset));
    glVertexAttribDivisor(index, 1);
  };
  attribute(0, 3, GL_FLOAT, GL_FALSE, offsetof(Instance, a));
  attribute(1, 3, GL_FLOAT, GL_FALSE, offsetof(Instance, b));
  attribute(2, 1, GL_FLOAT, GL_FALSE, offsetof(Instance, width));
  attribute(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Instance, color));
  glBindVertexArray(0);
}

void Lines::draw(const Eye& eye, const gl::Texture& depths) {
  if (count_ == 0) return;
  constexpr float kDesignHeight = 720;
  const auto width = static_cast<float>(depths.width()), height = static_cast<float>(depths.height());
  program_.use();
  const Matrix toClip = eye.viewProjection(0, 0);
  program_.setMatrices("viewProjection", toClip.columns.data());
  program_.set("nearest", eye.nearest);
  program_.set("pixels", width, height);
  program_.set("widthScale", std::max(.75f, height / kDesignHeight));
  depths.bind(0);
  program_.set("depths", 0);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
  glBindVertexArray(array_.id());
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count_);
  glBindVertexArray(0);
  glDisable(GL_BLEND);
}

}  // namespace rubble::render
