#pragma once
/// What the mouse does to a running scene. All of it goes through Player::apply and so into its history.
#include <memory>
#include <optional>

#include "apps/viewer/player.h"

namespace rubble::viewer {

/// Holds a point of a body by a grab joint, or a vertex of a deformable object by an attachment to a small
/// kinematic ball.
class Hand {
 public:
  /// False for bodies and vertices that do not move.
  bool take(Player& player, BodyId body, const Vec3& point);
  bool take(Player& player, SoftId object, int vertex);
  /// The held point is drawn here.
  void pull(Player& player, const Vec3& point);
  void release(Player& player);
  /// The worlds are others, or at another time.
  void forget() { held_.reset(); }
  bool holds() const { return held_.has_value(); }

 private:
  /// Ids that a grip made: the same again when its inputs are repeated, since ids follow from what was done
  /// before.
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

/// A ball from a point along a unit direction, larger and denser than what the scene is made of.
BodyId shoot(Player& player, const Vec3& from, const Vec3& direction, double bodySize);
/// A box that falls onto a point.
BodyId dropBox(Player& player, const Vec3& onto, double bodySize);

}  // namespace rubble::viewer
