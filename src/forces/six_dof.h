#pragma once
/// Six degrees of freedom, each free, limited or locked, with its own drive and friction: travel along the
/// axes of B's joint frame (TravelAxis), twist about x (TwistAxis) and swing about y and z (DirectionAxis).
/// If only one rotation is free, x must be its axis: only the twist continues beyond half a revolution.
#include "forces/hinge.h"

namespace rubble::RUBBLE_CORE {

struct SixDofJoint {
  static constexpr const char* kName = "six_dof";
  static constexpr bool kGrounded = false;
  using Parts = PartList<TravelAxis<0>, TravelAxis<1>, TravelAxis<2>, TwistAxis, DirectionAxis<SwingY>,
                         DirectionAxis<SwingZ>>;
  using Memory = TwistMemory;
  using Data = FramedData;
};

}  // namespace rubble::RUBBLE_CORE
