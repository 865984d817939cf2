#pragma once
/// Ball joint: two anchors coincide (AnchorRows). With a finite stiffness, a damper and a largest force it is
/// a drag joint: a soft spring.
#include "forces/linear_parts.h"
#include "forces/swing_twist.h"

namespace rubble::RUBBLE_CORE {

struct BallJoint {
  static constexpr const char* kName = "ball";
  static constexpr bool kGrounded = false;
  using Parts = PartList<AnchorRows>;
  using Memory = NoMemory;
  using Data = Anchors<Real>;
};

struct BallKind {
  using Joint = BallJoint;
  static constexpr JointType kType = JointType::Ball;
  static constexpr const char* kName = "ball";
  static constexpr const char* kDoc = "ball joint: two anchors coincide";
  static constexpr auto kFields = std::tuple_cat(kAnchorFields, kStiffnessField, kDampingFields,
                                                 kMaxForceField, kFrictionField, kBreakForceField);
  /// With friction it is a swing-twist joint without limits.
  template <class List> static int engineType(const JointDef& def) {
    return def.friction > 0 ? typeIndex<SwingTwistJoint>(List{}) : typeIndex<BallJoint>(List{});
  }
  static void build(JointBuild& b) {
    b.joint.groups = {b.anchors(), b.off(), b.friction()};
    b.joint.constants.set(SwingTwistJoint::Constants{normalize(b.def.driveOrientation)});
  }
};
struct DragKind {
  using Joint = BallJoint;
  static constexpr JointType kType = JointType::Drag;
  static constexpr const char* kName = "drag";
  static constexpr const char* kDoc = "soft drag of A's anchor to B's, with a largest force";
  static constexpr auto kFields = std::tuple_cat(kAnchorFields, kStiffnessField, kDampingFields,
                                                 kMaxForceField);
  static void build(JointBuild& b) {
    b.joint.groups = {b.anchors()};
    b.joint.isRigid = false;
  }
  static void check(const JointDef& def, const Path& path) {
    if (def.stiffness == kHard)
      throw Error(path + ".stiffness", "a finite stiffness for a drag joint", "hard");
  }
};

}  // namespace rubble::RUBBLE_CORE
