#pragma once
/// Six degrees of freedom, each free, limited or locked, with its own drive and friction: travel along the
/// axes of B's joint frame (TravelAxis), twist about x (TwistAxis) and swing about y and z (DirectionAxis).
#include "forces/hinge.h"

namespace rubble::RUBBLE_CORE {

struct SixDofJoint {
  static constexpr const char* kName = "six_dof";
  static constexpr bool kGrounded = false;
  using Parts = PartList<TravelAxis<0>, TravelAxis<1>, TravelAxis<2>, TwistAxis, DirectionAxis<SwingY>,
                         DirectionAxis<SwingZ>>;
  using Data = FramedData;
  using Memory = TwistMemory;
};

/// If only one rotation is free, x must be its axis: only the twist continues beyond half a revolution.
struct SixDofKind {
  using Joint = SixDofJoint;
  static constexpr JointType kType = JointType::SixDof;
  static constexpr const char* kName = "six_dof";
  static constexpr const char*
      kDoc = "travel along and turn about three axes, each free, limited, locked or driven";
  static constexpr auto kFields = std::tuple_cat(kAnchorFields, kFrameFields, kBreakFields);

  static bool isLocked(const JointBuild& b, std::size_t axis) {
    return b.def.axes[axis].min == b.def.axes[axis].max;
  }
  static bool isRigid(const JointBuild& b) { return isLocked(b, 0) && isLocked(b, 1) && isLocked(b, 2); }
  /// If exactly one rotation is not locked, permutes the axes so that it is about x. Only that angle counts
  /// whole revolutions.
  static void build(JointBuild& b) {
    EngineJoint& j = b.joint;
    j.isRigid = isRigid(b);
    const bool x = isLocked(b, 3), y = isLocked(b, 4), z = isLocked(b, 5);
    j.turned = x && !y && z ? 1 : x && y && !z ? 2 : 0;
    for (std::size_t i = 0; i < 6; ++i)
      j.axes[i] = b.def.axes[i / 3 * 3 + (i + static_cast<std::size_t>(j.turned)) % 3];
    // cyclic permutation x -> y -> z: a rotation by 120 degrees about the diagonal
    const rubble::Quat third = j.turned == 0   ? rubble::Quat{}
                               : j.turned == 1 ? rubble::Quat{.5, .5, .5, .5}
                                               : rubble::Quat{-.5, .5, .5, .5};
    j.frameA = normalize(j.frameA * third);
    j.frameB = normalize(j.frameB * third);
  }
};

}  // namespace rubble::RUBBLE_CORE
