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
  using Data = Anchors<Real>;

  /// The length that the axis keeps by a single limit or a single spring; kNoLimit: none.
  RUBBLE_HD static Real keptLength(const AxisSpec& axis) {
    const bool driven = axis.driveStiffness > Real(0) || axis.driveDamping > Real(0),
               limited = axis.lo > -kNoLimit || axis.hi < kNoLimit;
    const bool turns = axis.armature > Real(0) || axis.damping > Real(0) || axis.force != Real(0);
    if (axis.friction > Real(0) || turns || driven == limited) return kNoLimit;
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

/// What distance, rope and spring share: the anchors keep a length, or a point if it is zero.
struct LengthKind {
  using Joint = DistanceJoint;
  static constexpr int kRows = DistanceAxis::kRows;
  static constexpr auto kFields = std::tuple_cat(kAnchorFields, kStiffnessField, kDampingFields, kLengthField,
                                                 kBreakForceField);

  /// The length of a joint that has one: the target of its axis, kept for later edits. Null if its anchors
  /// coincide.
  static JointAxis* axisOf(JointBuild& b) {
    JointAxis& axis = b.joint.axes[0];
    const rubble::Vec3 &a = b.def.anchorA, &c = b.def.anchorB;
    axis.targetPosition = b.lengthOr(length(b.bodies.a.point(a) - b.bodies.b.point(c)));
    b.joint.isRigid = false;
    // round-off relative to the lever arms and body sizes
    constexpr double kRoundOff = 1e-6;
    const auto size = [](const JointBodyState& body, const rubble::Vec3& anchor) {
      const rubble::Vec3& i = body.mass.inertia;
      return length(anchor) + (body.mass.mass > 0 ? std::sqrt((i.x + i.y + i.z) / (3 * body.mass.mass)) : 0);
    };
    const bool isPoint = axis.targetPosition <=
                         kRoundOff * std::max(size(b.bodies.a, a), size(b.bodies.b, c));
    b.joint.groups = {b.anchors()};
    if (!isPoint) b.joint.groups[0].mode = GroupMode::Point;
    return isPoint ? nullptr : &axis;
  }
  static void limit(JointBuild& b, JointAxis& axis) {
    axis.max = axis.targetPosition;
    axis.limitStiffness = b.def.stiffness;
    axis.limitDamping = b.damping();
  }
};
struct DistanceKind : LengthKind {
  static constexpr JointType kType = JointType::Distance;
  static constexpr const char* kName = "distance";
  static constexpr const char* kDoc = "the anchors keep a distance";
  static void build(JointBuild& b) {
    if (JointAxis* const axis = axisOf(b)) limit(b, *axis), axis->min = axis->max;
    b.joint.isRigid = b.def.stiffness == kHard;
  }
};
struct RopeKind : LengthKind {
  static constexpr JointType kType = JointType::Rope;
  static constexpr const char* kName = "rope";
  static constexpr const char* kDoc = "the anchors keep a largest distance";
  static void build(JointBuild& b) {
    if (JointAxis* const axis = axisOf(b)) limit(b, *axis);
  }
};
struct SpringKind : LengthKind {
  static constexpr JointType kType = JointType::Spring;
  static constexpr const char* kName = "spring";
  static constexpr const char* kDoc = "spring and damper between the anchors";
  static void build(JointBuild& b) {
    if (JointAxis* const axis = axisOf(b))
      axis->driveStiffness = b.def.stiffness, axis->driveDamping = b.damping();
  }
  static void check(const JointDef& def, const Path& path) {
    if (def.stiffness == kHard) throw Error(path + ".stiffness", "a finite stiffness for a spring", "hard");
  }
};

}  // namespace rubble::RUBBLE_CORE
