#pragma once
/// Mouse interaction with a running scene. All of it goes through Player::apply and so into the history.
#include <memory>
#include <optional>

#include "apps/viewer/player.h"

namespace rubble::viewer {

/// Holds a point of a body by a drag joint, or a vertex of a deformable object by an attachment to a small
/// kinematic ball.
class Dragger {
 public:
  /// False for bodies and vertices that do not move.
  bool take(Player& player, BodyId body, const Vec3& point);
  bool take(Player& player, DeformableId object, int vertex);
  /// The held point is drawn here.
  void pull(Player& player, const Vec3& point);
  void release(Player& player);
  /// Releases without an input: the worlds were replaced or rewound.
  void forget() { held_.reset(); }
  bool holds() const { return held_.has_value(); }

 private:
  /// Ids of the objects that a grip created. Repeating the inputs gives the same ids.
  struct Grip {
    JointId joint;
    BodyId ball;
  };
  struct Held {
    std::shared_ptr<Grip> grip;
    std::optional<BodyId> body;
  };
  std::optional<Held> held_;
};

/// A ball from a point along a unit direction, larger and denser than the bodies of the scene.
BodyId shoot(Player& player, const Vec3& from, const Vec3& direction, double bodySize);
/// A box that falls onto a point.
BodyId dropBox(Player& player, const Vec3& onto, double bodySize);

}  // namespace rubble::viewer
