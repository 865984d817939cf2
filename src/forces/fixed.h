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
  };
};

}  // namespace rubble::RUBBLE_CORE
