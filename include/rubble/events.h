#pragma once
/// Events of a step: polled after it, in an order that is the same in every run.
#include <cstdint>
#include <string>
#include <vector>

#include <rubble/ids.h>
#include <rubble/math.h>

namespace rubble {

/// A contact point of the last step. The force acts on B, its opposite on A.
struct ContactPoint {
  BodyId a, b;
  Vec3 position;             ///< world [m]
  Vec3 normal;               ///< from A to B, unit
  double depth;              ///< > 0: penetration [m]
  Vec3 force;                ///< on B [N]
  int partA = 0, partB = 0;  ///< of compounds: indices into their parts
};

enum class Phase { Begin, Stay, End };

/// Contact between two bodies. They touch if a contact point carries force, or if its gap is below a
/// thousandth of the size of the smaller body.
struct ContactEvent {
  Phase phase = Phase::Begin;
  BodyId a, b;  ///< in ascending order of slots; after End one of them may have been removed
  /// BodyDef::userData of the two bodies, of a removed one too.
  std::uint64_t userDataA = 0, userDataB = 0;
  /// Shape::userData of their shapes. World::shapeUserData() has that of a part.
  std::uint64_t shapeUserDataA = 0, shapeUserDataB = 0;
  bool sensor = false;  ///< one of them is a sensor: no contact force
  /// On B, over the step [N s]. With substeps: the force of the last substep times the whole step.
  Vec3 impulse;
  std::vector<ContactPoint> points;  ///< empty for sensors and for Phase::End
};

/// A joint that broke in this step.
struct JointEvent {
  JointId joint;
  std::uint64_t userData = 0;  ///< JointDef::userData
  BodyId a, b;                 ///< index -1: the static world
  Vec3 force;                  ///< on B, in the step that broke it [N]
  Vec3 torque;                 ///< on B [N m]
};

/// A body fell asleep or woke.
struct SleepEvent {
  BodyId body;
  bool asleep = false;
  std::uint64_t userData = 0;  ///< BodyDef::userData
};

/// Events of the last step. Contacts are sorted by the slots of their bodies, the others by slot.
struct Events {
  std::vector<ContactEvent> contacts;
  std::vector<JointEvent> joints;
  std::vector<SleepEvent> sleeps;
};

}  // namespace rubble
