#pragma once
/// Slider (prismatic joint): anchor A lies on the x axis of B's joint frame (OnLineRows) and the relative
/// orientation is constant (OrientationRows). The travel along the axis has limits, a drive and friction
/// (TravelAxis).
#include "forces/angular_parts.h"
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

struct SliderJoint {
  static constexpr const char* kName = "slider";
  static constexpr bool kGrounded = false;
  using Parts = PartList<OnLineRows, OrientationRows, TravelAxis<0>>;
  using Memory = NoMemory;
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]
    Quat frameB;            ///< joint -> B; x is the axis of travel
    Quat aToB;              ///< rest orientation q_B^-1 q_A
    static Data of(const EngineJoint& j) {
      return {Vec3(j.anchorA), Vec3(j.anchorB), Quat(j.frameB), Quat(j.aToB)};
    }
  };
};

struct SliderKind {
  using Joint = SliderJoint;
  static constexpr JointType kType = JointType::Slider;
  static constexpr const char* kName = "slider";
  static constexpr const char* kDoc = "slider: A travels along the x axis of the joint and does not turn";
  static constexpr auto kFields = std::tuple_cat(kAnchorFields, kFrameFields, kOrientationField,
                                                 kStiffnessField, kAngularStiffnessField, kBreakFields);
  static void build(JointBuild& b) { b.joint.groups = {b.held(), b.heldRotations()}; }
};

}  // namespace rubble::RUBBLE_CORE
