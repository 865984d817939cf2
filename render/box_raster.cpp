#include "render/box_raster.h"

#include <algorithm>

namespace rubble::render {
namespace {

/// What a shadow is set back by against its own surface, in what depth changes by from texel to texel: as
/// glPolygonOffset has it for others.
constexpr float kSlopeOffset = 1.5f;
constexpr GLuint kGroup = 64;          ///< threads, as in the shader
constexpr GLuint kMostGroups = 32768;  ///< along one axis; at least 65535 are allowed
constexpr GLuint kClearGroups = 1024;
constexpr GLuint kMiddlingGroups = 4096;  ///< one a box at a time
constexpr GLuint kLargeGroups = 64,
                 kLargeParts = 64;  ///< boxes at a time; groups that share the pixels of one

const gl::ComputeFile kFile{"boxes.comp"};

void set(gl::Program& program, const char* name, const Vec3f& v) { program.set(name, v.x, v.y, v.z); }

}  // namespace

Rays raysOf(const Eye& eye, float jitterX, float jitterY, int width, int height) {
  Rays rays;
  rays.width = width;
  rays.height = height;
  const auto x = 2 / static_cast<float>(width), y = 2 / static_cast<float>(height);
  rays.origin = eye.position;
  rays.direction = eye.at(.5f * x - 1 - jitterX, .5f * y - 1 - jitterY, 1) - eye.position;
  rays.directionX = eye.right * (eye.spanX * x);
  rays.directionY = eye.up * (eye.spanY * y);
  return rays;
}

BoxRaster::BoxRaster()
    : seen_{gl::Program(kFile), gl::Program(kFile, {"LISTED"})},
      lit_{gl::Program(kFile, {"PARALLEL"}), gl::Program(kFile, {"PARALLEL", "LISTED"})},
      putSeen_("screen.vert", "boxes.frag", {"NAMED"}, gl::kComputeVersion),
      putLit_("screen.vert", "boxes.frag", {}, gl::kComputeVersion) {}

void BoxRaster::rasterize(gl::Program (&programs)[2], std::uint32_t boxCount, const Rays& rays,
                          const Matrix& viewProjection, float nearest, bool naming) {
  for (gl::Program& program : programs) {
    program.use();
    program.set("poses", 0);
    program.set("looks", 1);
    program.set("boxCount", static_cast<int>(boxCount));
    program.set("naming", naming ? 1 : 0);
    program.setMatrices("viewProjection", viewProjection.columns.data());
    program.setPixels("pixels", rays.width, rays.height);
    set(program, "rayOrigin", rays.origin);
    set(program, "rayOriginX", rays.originX);
    set(program, "rayOriginY", rays.originY);
    set(program, "rayDirection", rays.direction);
    set(program, "rayDirectionX", rays.directionX);
    set(program, "rayDirectionY", rays.directionY);
    program.set("nearest", nearest);
    program.set("slopeOffset", kSlopeOffset);
  }
  programs[0].use();
  const GLuint groups = (boxCount + kGroup - 1) / kGroup, across = std::min(groups, kMostGroups);
  glDispatchCompute(across, (groups + across - 1) / across, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  programs[1].use();
  programs[1].set("listIndex", 0);
  programs[1].set("listOffset", 0);
  glDispatchCompute(std::min(boxCount, kMiddlingGroups), 1, 1);
  programs[1].set("listIndex", 1);
  programs[1].set("listOffset", static_cast<int>(boxCount));
  glDispatchCompute(std::min(boxCount, kLargeGroups), kLargeParts, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void BoxRaster::draw(std::uint32_t boxCount, const Rays& rays, const Matrix& viewProjection, float nearest,
                     bool named) {
  if (boxCount == 0) return;
  const std::size_t pixels = static_cast<std::size_t>(rays.width) * static_cast<std::size_t>(rays.height);
  depths_.reserve(pixels * sizeof(std::uint32_t));
  slots_.reserve(named ? pixels * sizeof(std::uint32_t) : 0);
  lists_.reserve((2 + 2 * static_cast<std::size_t>(boxCount)) * sizeof(std::uint32_t));
  depths_.bindStorage(0);
  slots_.bindStorage(1);
  lists_.bindStorage(2);
  // What the last view read of them must be read.
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  clear_.use();
  clear_.set("pixelCount", static_cast<int>(pixels));
  clear_.set("named", named ? 1 : 0);
  glDispatchCompute(kClearGroups, 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  gl::Program(&programs)[2] = nearest > 0 ? seen_ : lit_;
  rasterize(programs, boxCount, rays, viewProjection, nearest, false);
  if (named) rasterize(programs, boxCount, rays, viewProjection, nearest, true);
  gl::Program& into = named ? putSeen_ : putLit_;
  into.use();
  into.set("across", rays.width);
  glBindVertexArray(nothing_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace rubble::render
