#include "render/shadow.h"

#include <algorithm>
#include <cmath>

namespace rubble::render {
namespace {

/// Between depths that grow by equal factors (1) and by equal steps (0).
constexpr float kSplitShape = .65f;

struct Frame {
  Vec3f x, y, z;
  Vec3f to(const Vec3f& p) const { return {dot(p, x), dot(p, y), dot(p, z)}; }
};

Frame sunFrame(const Vec3f& toSun) {
  const Vec3f spare = std::fabs(toSun.x) < .9f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0};
  const Vec3f x = normalize(cross(spare, toSun));
  return {x, cross(toSun, x), toSun};
}

Bounds inFrame(const Bounds& bounds, const Frame& frame) {
  Bounds out;
  for (int i = 0; i < 8; ++i) out.add(frame.to(bounds.corner(i)));
  return out;
}

/// Sizes in steps of a twelfth of an octave: a map that keeps its size keeps its texels in place when the
/// view moves.
float stepped(float size) { return std::exp2(std::ceil(12 * std::log2(size)) / 12); }

std::optional<ShadowMap> mapOver(const Frame& frame, const Bounds& slice, const Bounds& core, int size) {
  const float low[2] = {std::max(slice.low.x, core.low.x), std::max(slice.low.y, core.low.y)};
  const float high[2] = {std::min(slice.high.x, core.high.x), std::min(slice.high.y, core.high.y)};
  if (low[0] >= high[0] || low[1] >= high[1]) return std::nullopt;
  constexpr float kBorder = 8;  // texels, for the filter
  const float extent = stepped(std::max(high[0] - low[0], high[1] - low[1]));
  const float texel = extent / (static_cast<float>(size) - 2 * kBorder),
              half = .5f * texel * static_cast<float>(size);
  const float cx = texel * std::round(.5f * (low[0] + high[0]) / texel),
              cy = texel * std::round(.5f * (low[1] + high[1]) / texel);
  const float cz = .5f * (core.low.z + core.high.z),
              deep = std::max(.5f * (core.high.z - core.low.z), texel) * 1.01f;
  ShadowMap map;
  map.texel = texel;
  const Vec3f axes[3] = {frame.x * (1 / half), frame.y * (1 / half), frame.z * (-1 / deep)};
  const float offsets[3] = {-cx / half, -cy / half, cz / deep};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      map.toClip.columns[4 * axis + row] = axes[row][static_cast<int>(axis)];
    map.toClip.columns[12 + row] = offsets[row];
  }
  map.toClip.columns[15] = 1;
  map.rays.width = map.rays.height = size;
  map.rays.origin = frame.x * (cx - half + .5f * texel) + frame.y * (cy - half + .5f * texel) +
                    frame.z * (cz + deep);
  map.rays.originX = frame.x * texel;
  map.rays.originY = frame.y * texel;
  map.rays.direction = frame.z * (-2 * deep);
  map.toTexture = map.toClip;
  for (std::size_t axis = 0; axis < 4; ++axis)
    for (std::size_t row = 0; row < 3; ++row)
      map.toTexture.columns[4 * axis + row] = .5f *
                                              (map.toClip.columns[4 * axis + row] + (axis == 3 ? 1.f : 0.f));
  for (const auto& [direction, middle] : {std::pair{frame.x, cx}, std::pair{frame.y, cy}}) {
    map.halfSpaces.push_back({direction, half - middle});
    map.halfSpaces.push_back({-direction, half + middle});
  }
  return map;
}

}  // namespace

std::vector<ShadowMap> fitShadowMaps(const Eye& eye, const Bounds& core, const Vec3f& toSun, int size,
                                     int most) {
  std::vector<ShadowMap> maps;
  if (core.empty()) return maps;
  const Frame frame = sunFrame(toSun);
  const Bounds coreInSun = inFrame(core, frame);
  // What the bodies may throw a shadow on lies below them: as deep again as they are high.
  float nearDepth = 1e30f, farDepth = 0;
  for (int i = 0; i < 8; ++i) {
    nearDepth = std::min(nearDepth, eye.depthOf(core.corner(i)));
    farDepth = std::max(farDepth, eye.depthOf(core.corner(i)));
  }
  if (farDepth <= 0) return maps;
  farDepth *= 1.15f;
  nearDepth = std::max({nearDepth * .8f, eye.nearest, .002f * farDepth});
  const int count = std::clamp(static_cast<int>(std::ceil(std::log2(farDepth / nearDepth))) - 1, 1,
                               std::min(most, kMostShadowMaps));
  float from = nearDepth;
  for (int i = 1; i <= count; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(count);
    const float to = kSplitShape * nearDepth * std::pow(farDepth / nearDepth, t) +
                     (1 - kSplitShape) * (nearDepth + (farDepth - nearDepth) * t);
    Bounds slice;
    for (const float depth : {from, to})
      for (const float x : {-1.f, 1.f})
        for (const float y : {-1.f, 1.f}) slice.add(frame.to(eye.at(x, y, depth)));
    if (const auto map = mapOver(frame, slice, coreInSun, size)) maps.push_back(*map);
    from = to;
  }
  return maps;
}

}  // namespace rubble::render
