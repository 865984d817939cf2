#pragma once
/// Distance of two anchors (DistanceAxis): rod (locked), rope (upper limit), strut (lower limit), spring with damper (a drive). One of no length holds
/// them together along every axis (AnchorRows) in place of that: a distance of zero has no direction, and a multiplier along the one that it had
/// before pushes where it should pull.
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

struct DistanceJoint {
  static constexpr const char* kName = "distance";
  static constexpr bool kGrounded = false;
  using Parts = PartList<DistanceAxis, AnchorRows>;
  using Memory = NoMemory;
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frame of their body [m]
  };
};

}  // namespace rubble::RUBBLE_CORE
