#pragma once
/// Slider (prismatic joint): anchor A stays on the x axis of B's frame (OnLineRows), the orientation is kept
/// (OrientationRows), and the travel along that axis has limits, a drive and friction (TravelAxis).
#include "forces/angular_parts.h"
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

struct SliderJoint {
  static constexpr const char* kName = "slider";
  static constexpr bool kGrounded = false;
  using Parts = PartList<OnLineRows, OrientationRows, TravelAxis<0>>;
  using Memory = NoMemory;
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frame of their body [m]
    Quat frameB;            ///< joint -> B: x is the way
    Quat aToB;              ///< wanted q_B^-1 q_A
  };
};

}  // namespace rubble::RUBBLE_CORE
