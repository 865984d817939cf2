#pragma once
/// Depth of the scene as the sun sees it, in one to four maps: each covers a part of the view, the nearest
/// the most finely.
#include <optional>

#include "render/bodies.h"

namespace rubble::render {

constexpr int kMostShadowMaps = 4;

/// Where one map lies: parallel rays along the third axis.
struct ShadowMap {
  Matrix toClip;     ///< renderer's frame -> [-1, 1]
  Matrix toTexture;  ///< renderer's frame -> [0, 1]
  float texel = 1;   ///< [m]
  std::vector<HalfSpace> halfSpaces;
  Rays rays;
};

/// Maps of `size` texels that cover what the eye sees of `core`, at most `most` of them; none if it sees
/// nothing of it.
std::vector<ShadowMap> fitShadowMaps(const Eye& eye, const Bounds& core, const Vec3f& toSun, int size,
                                     int most);

}  // namespace rubble::render
