#pragma once
/// Hinge: the anchors coincide (AnchorRows) and the x axes of both frames are parallel (ParallelRows). The
/// rotation of A about this axis, continued over full revolutions, has limits, a drive and friction
/// (TwistAxis).
#include "forces/angular_parts.h"
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

/// Anchors and joint frames on both bodies.
struct FramedData {
  Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]
  Quat frameA, frameB;    ///< joint -> body
  static FramedData of(const EngineJoint& j) {
    return {Vec3(j.anchorA), Vec3(j.anchorB), Quat(j.frameA), Quat(j.frameB)};
  }
};

struct HingeJoint {
  static constexpr const char* kName = "hinge";
  static constexpr bool kGrounded = false;
  using Parts = PartList<AnchorRows, ParallelRows, TwistAxis>;
  using Memory = TwistMemory;
  using Data = FramedData;
};

struct HingeKind {
  using Joint = HingeJoint;
  static constexpr JointType kType = JointType::Hinge;
  static constexpr const char* kName = "hinge";
  static constexpr const char*
      kDoc = "hinge: A turns about the x axis of the joint, counted over whole turns";
  static constexpr auto kFields = std::tuple_cat(kAnchorFields, kFrameFields, kStiffnessField,
                                                 kAngularStiffnessField, kBreakFields);
  static void build(JointBuild& b) { b.joint.groups = {b.held(), b.heldRotations()}; }
};

}  // namespace rubble::RUBBLE_CORE
