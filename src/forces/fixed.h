#pragma once
/// Fixed joint (weld): the anchors coincide (AnchorRows) and the relative orientation is constant
/// (OrientationRows). Without the anchors it is an angular spring.
#include "forces/angular_parts.h"
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

struct FixedJoint {
  static constexpr const char* kName = "fixed";
  static constexpr bool kGrounded = false;
  using Parts = PartList<AnchorRows, OrientationRows>;
  using Memory = NoMemory;
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]
    Quat aToB;              ///< rest orientation q_B^-1 q_A
    static Data of(const EngineJoint& j) { return {Vec3(j.anchorA), Vec3(j.anchorB), Quat(j.aToB)}; }
  };
};

struct FixedKind {
  using Joint = FixedJoint;
  static constexpr JointType kType = JointType::Fixed;
  static constexpr const char* kName = "fixed";
  static constexpr const char*
      kDoc = "fixed joint: two anchors coincide and the relative orientation is kept";
  static constexpr auto kFields = std::tuple_cat(
      kAnchorFields, kOrientationField, kStiffnessField, kDampingFields, kAngularStiffnessField,
      kAngularDampingFields, kMaxForceField, kMaxTorqueField, kBreakFields);
  static void build(JointBuild& b) { b.joint.groups = {b.anchors(), b.orientation()}; }
};
struct AngularSpringKind {
  using Joint = FixedJoint;
  static constexpr JointType kType = JointType::AngularSpring;
  static constexpr const char* kName = "angular_spring";
  static constexpr const char*
      kDoc = "spring and damper towards a relative orientation; the anchors are free";
  static constexpr int kRows = OrientationRows::kRows;
  static constexpr auto kFields = std::tuple_cat(kOrientationField, kAngularStiffnessField,
                                                 kAngularDampingFields, kMaxTorqueField, kBreakTorqueField);
  static void build(JointBuild& b) {
    b.joint.groups = {b.off(), b.orientation()};
    b.joint.isRigid = false;
  }
};

}  // namespace rubble::RUBBLE_CORE
