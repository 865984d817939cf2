#pragma once
/// Shadow of the sun and occlusion of the sky.
#include <span>
#include <vector>

#include "io/picture_raster.h"

namespace rubble::io::draw {

/// The sun's view of the scene.
class Shadow {
 public:
  /// `toSun` is a unit vector of the world. The map covers what moves within the camera's view.
  Shadow(const View& camera, std::span<const PictureBody> bodies, const Vec3& toSun);

  /// How much of the sun a point sees, 0 to 1. `pattern` turns the sampling pattern: neighbours take different ones.
  float sunlight(const Vec& pointInCamera, const Vec& normalInCamera, std::uint32_t pattern) const;

 private:
  Vec toMap(const Vec& pointInCamera) const;
  float nearnessAt(float x, float y) const;

  View view_;
  Surfaces map_;
  Mat3T<float> turn_;  ///< camera -> sun
  Vec shift_;
  float texel_ = 1;  ///< [m]
  bool empty_ = false;
};

/// How much of the sky each pixel sees, 0 to 1, from the depths of every second sample. `radius` is how far occluders count [m].
std::vector<float> skyVisibility(const View& camera, const Surfaces& seen, std::span<const ViewBody> bodies, float radius);

}  // namespace rubble::io::draw
