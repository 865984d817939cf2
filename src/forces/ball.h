#pragma once
/// Ball joint: two anchors coincide (AnchorRows). With a finite stiffness, a damper and a largest force it is
/// a grab: a soft drag.
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

struct BallJoint {
  static constexpr const char* kName = "ball";
  static constexpr bool kGrounded = false;
  using Parts = PartList<AnchorRows>;
  using Memory = NoMemory;
  using Data = Anchors<Real>;
};

}  // namespace rubble::RUBBLE_CORE
