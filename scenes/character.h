#pragma once
/// Sample over the API: a character that walks, climbs steps, jumps, is carried by what it stands on and
/// pushes what is in its way. It is a kinematic capsule that is moved by shape casts, as in most games.
#include <rubble/world.h>

namespace rubble::scenes {

struct CharacterSettings {
  double stepHeight = .35;  ///< highest step that it climbs [m]
  double maxSlope = .87;    ///< steepest slope that it stands on [rad]
  double skin = .02;        ///< distance that it keeps [m]
  double pushForce = 300;   ///< largest force on bodies in its way [N]
};

class Character {
 public:
  /// `body`: a kinematic capsule whose local z axis is against gravity.
  Character(BodyId body, const CharacterSettings& settings = {}) : body_(body), settings_(settings) {}

  /// Moves it by one step: call before each World::step(). `walk`: velocity over the ground [m/s].
  /// `jumpSpeed`: upward speed of a jump, if it stands on something; 0: none [m/s].
  void move(World& world, const Vec3& walk, double jumpSpeed = 0) const;
  /// Does it stand on something?
  bool stands(World& world) const;

 private:
  struct Moving;
  BodyId body_;
  CharacterSettings settings_;
};

}  // namespace rubble::scenes
