#pragma once
/// Distance of two anchors (DistanceAxis): rod (locked), rope (upper limit), strut (lower limit), spring with damper (a drive).
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

struct DistanceJoint {
  static constexpr const char* kName = "distance";
  static constexpr bool kGrounded = false;
  using Parts = PartList<DistanceAxis>;
  using Memory = NoMemory;
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frame of their body [m]
  };
};

}  // namespace rubble::RUBBLE_CORE
