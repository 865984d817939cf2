#include "apps/viewer/orbit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubble::viewer {
namespace {

/// Turn of a drag over the whole height of the picture [rad], and how near to a pole it may come [rad].
constexpr double kTurn = 3.5, kPole = .02;

}  // namespace

Orbit::Orbit(const render::Camera& camera)
    : target_(camera.target),
      up_(normalize(camera.up)),
      ahead_(normalize(camera.target - camera.eye)),
      distance_(length(camera.target - camera.eye)),
      fieldOfView_(camera.fieldOfView) {}

void Orbit::turn(double right, double up) {
  ahead_ = rotate(fromAxisAngle(up_, -kTurn * right), ahead_);
  const double pitch = std::asin(std::clamp(dot(ahead_, up_), -1., 1.));
  const double limit = std::numbers::pi / 2 - kPole;
  const double wanted = std::clamp(pitch + kTurn * up, -limit, limit);
  const Vec3 level = normalize(ahead_ - up_ * dot(ahead_, up_), cross(up_, {1, 0, 0}));
  ahead_ = level * std::cos(wanted) + up_ * std::sin(wanted);
}

void Orbit::pan(double right, double up) {
  const double metres = 2 * distance_ * std::tan(fieldOfView_ / 2);
  const Vec3 side = normalize(cross(ahead_, up_), {1, 0, 0});
  target_ += side * (-right * metres) + cross(side, ahead_) * (-up * metres);
}

void Orbit::zoom(double factor) { distance_ = std::clamp(distance_ / factor, 1e-3, 1e6); }

render::Camera Orbit::camera() const { return {target_ - ahead_ * distance_, target_, up_, fieldOfView_}; }

Vec3 Orbit::ray(double x, double y, double aspect) const {
  const Vec3 side = normalize(cross(ahead_, up_), {1, 0, 0});
  const double tall = std::tan(fieldOfView_ / 2);
  return normalize(ahead_ + side * ((2 * x - 1) * tall * aspect) +
                   cross(side, ahead_) * ((1 - 2 * y) * tall));
}

void Orbit::aim(const Vec3& target, double distance) {
  target_ = target;
  distance_ = std::max(1e-3, distance);
}

std::optional<std::array<double, 2>> Orbit::place(const Vec3& point, double aspect) const {
  const Vec3 there = point - (target_ - ahead_ * distance_), side = normalize(cross(ahead_, up_), {1, 0, 0});
  const double depth = dot(there, ahead_), tall = std::tan(fieldOfView_ / 2);
  if (depth <= 0) return std::nullopt;
  return std::array{.5 + dot(there, side) / (2 * depth * tall * aspect),
                    .5 - dot(there, cross(side, ahead_)) / (2 * depth * tall)};
}

}  // namespace rubble::viewer
