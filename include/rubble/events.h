#pragma once
/// What happened in a step: polled after it, in an order that is the same in every run.
#include <string>
#include <vector>

#include <rubble/ids.h>
#include <rubble/math.h>

namespace rubble {

/// A contact point of the last step. The force acts on B; its opposite acts on A.
struct ContactPoint {
  BodyId a, b;
  Vec3 position;  ///< world [m]
  Vec3 normal;    ///< from A to B, unit
  double depth;   ///< > 0: penetration [m]
  Vec3 force;     ///< on B [N]
};

enum class Phase { Begin, Stay, End };

/// Two bodies touch: a point of theirs carries a force, or is less than a thousandth of the smaller one's
/// size from the other's surface.
struct ContactEvent {
  Phase phase = Phase::Begin;
  BodyId a, b;          ///< in rising order of their slots; after End one of them may not be alive any more
  bool sensor = false;  ///< one of them is a sensor: no force
  Vec3 impulse;  ///< on B, over the step (with substeps: the last one's force for the whole step) [N s]
  std::vector<ContactPoint> points;  ///< none for sensors and at the End
};

/// A joint that broke in this step.
struct JointEvent {
  JointId joint;
  BodyId a, b;  ///< index -1: the world
  Vec3 force;   ///< on B when it broke [N]
  Vec3 torque;  ///< [N m]
};

/// A body that fell asleep or woke.
struct SleepEvent {
  BodyId body;
  bool asleep = false;
};

/// Of the last step; contacts by the slots of their bodies, joints by slot, bodies by slot.
struct Events {
  std::vector<ContactEvent> contacts;
  std::vector<JointEvent> joints;
  std::vector<SleepEvent> sleeps;
};

}  // namespace rubble
