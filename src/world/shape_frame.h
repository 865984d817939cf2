#pragma once
/// Between the frame that a shape is authored in and that of the engine, which is at the centre of mass and
/// along the principal axes.
#include <memory>

#include <rubble/world.h>

#include "collision/cooked_shape.h"

namespace rubble {

/// Where the engine's frame lies in the author's.
struct ShapeFrame {
  Vec3 centre;
  Quat axes;

  bool same() const { return centre == Vec3{} && axes == Quat{}; }
  Vec3 pointToEngine(const Vec3& p) const { return rotateInverse(axes, p - centre); }
  /// The pose of the engine's frame for a pose of the author's, and back.
  BodyState toEngine(BodyState s) const {
    if (same()) return s;
    s.orientation = normalize(s.orientation);
    s.position += rotate(s.orientation, centre);
    s.orientation = normalize(s.orientation * axes);
    return s;
  }
  BodyState toAuthor(BodyState s) const {
    if (same()) return s;
    s.orientation = normalize(s.orientation * conjugate(axes));
    s.position -= rotate(s.orientation, centre);
    return s;
  }
};

/// A shape that the engine has tables of.
struct CookedEntry {
  Shape key;
  std::shared_ptr<const CookedShape> cooked;
  int indexBase;  ///< where its indices begin
};

}  // namespace rubble
