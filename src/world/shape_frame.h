#pragma once
/// Conversion between the authored frame of a shape and the engine frame, which has its origin at the center
/// of mass and its axes along the principal axes.
#include <rubble/world.h>

namespace rubble {

/// Pose of the engine frame in the authored frame.
struct ShapeFrame {
  Vec3 center;
  Quat axes;

  bool same() const { return center == Vec3{} && axes == Quat{}; }
  Vec3 pointToEngine(const Vec3& p) const { return rotateInverse(axes, p - center); }
  /// Converts the state of the authored frame to that of the engine frame, and back.
  BodyState toEngine(BodyState s) const {
    if (same()) return s;
    s.orientation = normalize(s.orientation);
    s.position += rotate(s.orientation, center);
    s.orientation = normalize(s.orientation * axes);
    return s;
  }
  BodyState toAuthor(BodyState s) const {
    if (same()) return s;
    s.orientation = normalize(s.orientation * conjugate(axes));
    s.position -= rotate(s.orientation, center);
    return s;
  }
};

}  // namespace rubble
