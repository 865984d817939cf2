#pragma once
/// Converts authored joint definitions to engine joints.
#include "tables/records.h"

namespace rubble {

/// A body of a joint at the time when the joint is made. The world has the identity pose and no mass.
struct JointBodyState {
  Vec3 position;
  Quat orientation;
  MassProperties mass;
};
struct JointBodies {
  JointBodyState a, b;
  JointBodyState carrierA = {}, carrierB = {};
};

/// Number of entries of JointDef::axes that a type uses.
int axisCount(JointType type);
bool hasLength(JointType type);
/// Throws Error unless the joint type allows that frame body for one of its bodies.
void checkCarrier(JointType type, int body, int carrier, const std::string& path);

/// `before`: the present joint when it is redefined. Quantities measured when it was made are taken from it.
EngineJoint engineJoint(const JointDef& def, const JointBodies& bodies, const EngineJoint* before = nullptr);

}  // namespace rubble
