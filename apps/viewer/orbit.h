#pragma once
/// A camera on a sphere about its target.
#include <array>
#include <optional>

#include "render/camera.h"

namespace rubble::viewer {

class Orbit {
 public:
  Orbit() = default;
  explicit Orbit(const render::Camera& camera);

  /// Turns about the target by a drag of so many pictures' heights; up and down end short of the poles.
  void turn(double right, double up);
  /// Moves with what lies at the target's depth under the mouse.
  void pan(double right, double up);
  /// Nearer (above 1) or farther by a factor.
  void zoom(double factor);
  /// Looks at another point from a distance, in the same direction [m].
  void aim(const Vec3& target, double distance);
  render::Camera camera() const;
  /// Direction of the ray through a point of the picture: 0,0 is the upper left, 1,1 the lower right; aspect
  /// is width over height.
  Vec3 ray(double x, double y, double aspect) const;
  /// Where a point of the world is seen, in the same coordinates; nothing for one behind the eye.
  std::optional<std::array<double, 2>> place(const Vec3& point, double aspect) const;

 private:
  Vec3 target_, up_{0, 0, 1}, ahead_{0, 1, 0};  ///< ahead_ is unit, from the eye to the target
  double distance_ = 10, fieldOfView_ = .5;
};

}  // namespace rubble::viewer
