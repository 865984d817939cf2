#include "render/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace rubble::render {
namespace {

/// Room left around the bodies.
constexpr double kMargin = 1.12;

struct Range {
  double low = 0, high = 0;
  double middle() const { return (low + high) / 2; }
  double half() const { return (high - low) / 2; }
};

/// The range of one or more values. The outermost half percent at each end is left out if it lies far out:
/// one brick that flew away must not shrink all the others.
Range coreRange(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 200;
  const Range all{values.front(), values.back()};
  const Range core{values[cut], values[values.size() - 1 - cut]};
  constexpr double kFar = 2.5;
  return all.half() <= kFar * core.half() ? all : core;
}

Range rangeAlong(std::span<const io::PictureBody> bodies, const Vec3& axis) {
  std::vector<double> lows, highs;
  for (const bool onlyMoving : {true, false}) {
    for (const io::PictureBody& body : bodies) {
      if (body.shape.type == ShapeType::Plane || (onlyMoving && body.motion == Motion::Static)) continue;
      const double at = dot(axis, body.position), extent = io::extentAlong(body, axis);
      if (!std::isfinite(at + extent)) continue;
      lows.push_back(at - extent);
      highs.push_back(at + extent);
    }
    if (!lows.empty()) break;
  }
  if (lows.empty()) return {-1, 1};
  return {coreRange(std::move(lows)).low, coreRange(std::move(highs)).high};
}

}  // namespace

Camera cameraShowing(std::span<const io::PictureBody> bodies, const Vec3& gravity, const Framing& framing) {
  const Vec3 up = normalize(-gravity, {0, 0, 1});
  Vec3 right = normalize(std::fabs(up.x) < .9 ? Vec3{1, 0, 0} - up * up.x : Vec3{0, 1, 0} - up * up.y);
  Vec3 away = cross(up, right);
  if (rangeAlong(bodies, away).half() > rangeAlong(bodies, right).half()) {
    // Look along the thin side.
    const Vec3 turned = away;
    away = -right;
    right = turned;
  }
  const std::array<Vec3, 3> axes{right, away, up};
  std::array<Range, 3> ranges;
  for (std::size_t i = 0; i < 3; ++i) ranges[i] = rangeAlong(bodies, axes[i]);
  for (std::size_t i = 0; i < 2; ++i) {
    const double room = 2 * framing.spread * ranges[2].half();
    ranges[i] = {ranges[i].low - room, ranges[i].high + room};
  }
  const Vec3 target = axes[0] * ranges[0].middle() + axes[1] * ranges[1].middle() +
                      axes[2] * ranges[2].middle();

  const Vec3 forward = normalize(framing.direction, normalize(away - right * .55 - up * .42));
  const Vec3 cameraRight = normalize(cross(forward, up), right);
  const Vec3 cameraUp = cross(cameraRight, forward);
  const double tall = std::tan(framing.fieldOfView / 2), wide = tall * framing.aspect;
  double distance = 1e-3;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p;
    for (std::size_t i = 0; i < 3; ++i)
      p += axes[i] * ((corner >> i & 1) ? ranges[i].half() : -ranges[i].half());
    const double behind = -dot(p, forward);
    const double across = kMargin * std::fabs(dot(p, cameraRight)) / wide;
    const double along = kMargin * std::fabs(dot(p, cameraUp)) / tall;
    distance = std::max({distance, across + behind, along + behind});
  }
  return {target - forward * (distance * framing.closer), target, up, framing.fieldOfView};
}

}  // namespace rubble::render
