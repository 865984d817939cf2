#pragma once
/// Distance joint between two anchors (DistanceAxis): rod (locked), rope (upper limit), strut (lower limit),
/// or spring with damper (drive).
///
/// The rows of a distance are linear as long as its direction rotates little. If the relative displacement of
/// the anchors in a step exceeds the length L to keep, the direction is arbitrary, and a multiplier may push
/// instead of pull. In such a step the joint becomes a point joint (AnchorRows): its anchors keep the offset
/// o = L n in all axes, n being the direction at x^t. Since |d - L n| >= ||d| - L|, with equality at x^t, the
/// energy of these rows bounds that of the distance from above, and the switch adds no energy. A slack rope
/// keeps its present offset. A distance of zero length is always a point joint.
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

/// Relative displacement of the anchors per step, over their length, beyond which the joint becomes a point
/// joint [1].
inline constexpr Real kMostSpanWay = 1;

struct SpanMemory {
  Vec3 offset;  ///< o, world axes [m]
  int isPoint;  ///< 0, 1: point joint in this step
  template <class D> RUBBLE_HD void remember(const D&, const Pose&, const Pose&, const Vec3d&) {}
  RUBBLE_HD bool takesPart(int part) const { return (part == 1) == (isPoint != 0); }
};

struct DistanceJoint {
  static constexpr const char* kName = "distance";
  static constexpr bool kGrounded = false;
  static constexpr bool kChooses = true;
  using Parts = PartList<DistanceAxis, AnchorRows>;
  using Memory = SpanMemory;
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]
  };

  /// The length that the axis keeps by a single limit or a single spring; kNoLimit: none.
  RUBBLE_HD static Real keptLength(const AxisSpec& axis) {
    const bool driven = axis.driveStiffness > Real(0) || axis.driveDamping > Real(0),
               limited = axis.lo > -kNoLimit || axis.hi < kNoLimit;
    if (axis.friction > Real(0) || driven == limited) return kNoLimit;
    if (limited) return axis.lo > -kNoLimit && axis.lo != axis.hi ? kNoLimit : axis.hi;
    return axis.driveStiffness > Real(0) && axis.speed == Real(0) ? axis.target : kNoLimit;
  }
  /// Selects distance or point joint for this step, and converts the multiplier.
  template <class Spec, class State>
  RUBBLE_HD static void choose(const Spec& spec, State& joint, const Pose& a, const Pose& b,
                               const JointBody (&bodies)[2]) {
    const GroupMode mode = partOf<1>(spec.parts).mode;
    AxisRows& axis = partOf<0>(joint.parts);
    GroupRows<AnchorRows::kRows>& point = partOf<1>(joint.parts);
    SpanMemory& memory = joint.memory;
    const bool was = memory.isPoint != 0;
    Vec3 n;
    const Real size = direction(DistanceAxis::span(spec.data, a, b), n);
    Real kept = 0;
    memory.isPoint = mode == GroupMode::Hold;
    if (mode == GroupMode::Point) {
      kept = keptLength(partOf<0>(spec.parts));
      const auto way = [&](int side) {
        const Vec6& change = bodies[side].change;
        return change.lin + cross(change.ang, anchorLever(spec.data, side == 0 ? a : b, side));
      };
      memory.isPoint = length(way(0) - way(1)) > kMostSpanWay * kept;
      const bool isRope = partOf<0>(spec.parts).lo <= -kNoLimit && partOf<0>(spec.parts).hi < kNoLimit;
      if (isRope) kept = min(kept, size);
    }
    memory.offset = memory.isPoint ? kept * n : Vec3{0, 0, 0};
    if (mode != GroupMode::Point || was == (memory.isPoint != 0)) return;
    AxisRow& row = partOf<0>(spec.parts).driveStiffness > Real(0) ? axis.drive : axis.limit;
    if (memory.isPoint) {
      const Vec3 load = (row.active ? row.lambda : Real(0)) * n;
      point.lambda[0] = load.x, point.lambda[1] = load.y, point.lambda[2] = load.z;
      point.state.k = row.active ? row.k : Real(0);
    } else {
      row.lambda = point.lambda[0] * n.x + point.lambda[1] * n.y + point.lambda[2] * n.z;
      row.k = point.state.k;
    }
  }
};

}  // namespace rubble::RUBBLE_CORE
