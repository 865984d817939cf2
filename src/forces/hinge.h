#pragma once
/// Hinge: the anchors coincide (AnchorRows) and the x axes of both frames are parallel (ParallelRows). The
/// rotation of A about this axis, continued over full revolutions, has limits, a drive and friction
/// (TwistAxis).
#include "forces/angular_parts.h"
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

/// Anchors and joint frames on both bodies.
struct FramedData {
  Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]
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
