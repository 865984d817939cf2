#pragma once
/// The authored side of a joint. A joint type, as scenes name it, is a struct K beside the joint that it
/// becomes:
///
///   Joint    joint of the engine (forces/joint.h); several kinds may share one
///   kName    keyword in files
///   kDoc     one line
///   kFields  tuple of the fields that it reads (math/field.h): members of JointDef, or of its own struct,
///            which definitions then carry in JointDef::own
///   build    void (JointBuild&): groups, axes and constants of the joint
///   kType    its enumerator (optional; others are numbered after the last enumerator, in list order)
///   kRows    rows that act at a time, if not all of its joint (optional)
///   check    void (const JointDef&, const Path& path): rules beyond the ranges of fields (optional)
///   engineType<List>  int (const JointDef&): index of another joint of the list for some definitions
///            (optional)
///
/// Reader, writer, validation, listing and inspector follow from these.
#include <rubble/error.h>

#include "forces/joint_fields.h"
#include "forces/joint_record.h"
#include "math/type_list.h"

namespace rubble {

/// A number in errors.
std::string numberText(double a);

/// Input and output of K::build. `joint` has its placement, thresholds and authored axes already. Groups that
/// are not given are held and hard.
struct JointBuild {
  const JointDef& def;        ///< in the engine frames of its bodies
  const JointBodies& bodies;  ///< at present
  const EngineJoint* before;  ///< the joint before this edit: measured quantities are taken from it; or null
  EngineJoint joint;

  /// Reduced mass of the bodies [kg], and mean moment of inertia about the anchors [kg m2]. If one body is
  /// static they are those of the other.
  double mass() const;
  double moment() const;
  /// Damper of `stiffness`, as authored or by its ratio of critical damping [N s/m].
  double damping() const;
  EngineGroup anchors() const;
  EngineGroup orientation() const;
  /// Rows without damper and bound, with the linear and the angular stiffness.
  EngineGroup held() const { return {GroupMode::Hold, def.stiffness, 0, kHard}; }
  EngineGroup heldRotations() const { return {GroupMode::Hold, def.angularStiffness, 0, kHard}; }
  static EngineGroup off() { return {GroupMode::Off, kHard, 0, kHard}; }
  /// Friction against all rotations [N m].
  EngineGroup friction() const;
  /// The authored length, or the one measured when the joint was made: `now` for a new one [m].
  double lengthOr(double now) const;
};

}  // namespace rubble
