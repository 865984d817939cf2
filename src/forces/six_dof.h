#pragma once
/// Six degrees of freedom, each free, limited or locked, with a drive and friction of its own: travel along
/// the axes of B's frame (TravelAxis), twist about x (TwistAxis) and swing about y and z (DirectionAxis).
/// Where one rotation only is free, x is its axis: the twist alone has no end.
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
