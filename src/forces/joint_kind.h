#pragma once
/// Joint kinds without their types, for readers, writers, validation, listings and inspectors.
#include <string>
#include <vector>

#include "forces/joint_build.h"

namespace rubble {

using JointField = AnyField<JointDef>;

/// What is known about a joint type, without its types.
struct JointKind {
  JointType type;
  const char* name;
  const char* doc;
  int rows, axes;
  const char* axisUnit;               ///< "m" or "rad", or "m, rad" if there are both
  bool hasFrameBodies;                ///< may its axes lie in frame bodies?
  std::vector<JointField> fields;     ///< in the order of K::kFields
  std::vector<JointField> ownFields;  ///< those in JointDef::own
  EngineJoint (*build)(const JointDef&, const JointBodies&, const EngineJoint* before);
  void (*check)(const JointDef&, const Path& path);

  /// Is this one of its fields?
  bool has(const char* key) const { return hasField(fields, key); }
};

/// All joint kinds, by JointType; and one of them.
const std::vector<JointKind>& jointKinds();
const JointKind& kindOf(JointType type);
/// Members of JointDef that some kind has as fields, in their order there.
const std::vector<JointField>& sharedJointFields();
/// Number of joint types of the engine.
int engineJointTypes();

}  // namespace rubble
