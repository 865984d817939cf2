#pragma once
/// Hinge: the anchors coincide (AnchorRows), the x axes of both frames are parallel (ParallelRows), and the
/// turn of A about that axis, counted over whole turns, has limits, a drive and friction (TwistAxis).
#include "forces/angular_parts.h"
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

/// Anchors and frames of a joint in its two bodies.
struct FramedData {
  Vec3 anchorA, anchorB;  ///< in the frame of their body [m]
  Quat frameA, frameB;    ///< joint -> body
};

struct HingeJoint {
  static constexpr const char* kName = "hinge";
  static constexpr bool kGrounded = false;
  using Parts = PartList<AnchorRows, ParallelRows, TwistAxis>;
  using Memory = TwistMemory;
  using Data = FramedData;
};

}  // namespace rubble::RUBBLE_CORE
