#pragma once
/// Fixed joint (weld): the anchors coincide (AnchorRows) and the relative orientation is kept
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
    Vec3 anchorA, anchorB;  ///< in the frame of their body [m]
    Quat aToB;              ///< wanted q_B^-1 q_A
  };
};

}  // namespace rubble::RUBBLE_CORE
