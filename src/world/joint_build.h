#pragma once
/// From what an author says of a joint to what the engine is given.
#include "backend/engine.h"

namespace rubble {

/// A body of a joint at the moment when the joint is made; the world is at the origin and has no mass.
struct JointBodyState {
  Vec3 position;
  Quat orientation;
  MassProperties mass;
};
struct JointBodies {
  JointBodyState a, b;
  JointBodyState carrierA = {}, carrierB = {};
};

/// Axes that a type has: JointDef::axes [0, axisCount).
int axisCount(JointType type);
bool hasLength(JointType type);
/// Throws Error unless such a joint may have that carrier for one of its bodies.
void checkCarrier(JointType type, int body, int carrier, const std::string& path);

/// `before`: the same joint until now; what was measured when it was made is taken from there.
EngineJoint engineJoint(const JointDef& def, const JointBodies& bodies, const EngineJoint* before = nullptr);

}  // namespace rubble
