#pragma once
/// Joint definitions by their kinds.
#include "forces/joint_kind.h"

namespace rubble {

/// Number of entries of JointDef::axes that a type uses.
inline int axisCount(JointType type) { return kindOf(type).axes; }
inline bool hasLength(JointType type) { return kindOf(type).has("length"); }
/// Throws Error unless the joint type allows that frame body for one of its bodies.
void checkFrameBody(JointType type, int body, int frameBody, const Path& path);

/// `before`: the present joint when it is redefined. Quantities measured when it was made are taken from it.
inline EngineJoint engineJoint(const JointDef& def, const JointBodies& bodies,
                               const EngineJoint* before = nullptr) {
  return kindOf(def.type).build(def, bodies, before);
}

}  // namespace rubble
