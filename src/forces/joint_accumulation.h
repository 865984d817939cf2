#pragma once
/// Contribution of the rows of a joint to the block of a body or of an aggregate, and the linearization of
/// its angular rows within an iteration.
///
/// Memory reads of joints dominate the cost of sweeps. The data of a joint about a point is therefore compact
/// and independent of its type: levers at x^t, anchor rows and the force laws of its angular rows. None of it
/// needs an orientation, because poses in a sweep are displacements and rotations since x^t.
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

/// Angular rows of one force law: a whole group of rows, or one row of an axis. They are linear until the
/// next iteration and invariant under rotation of the whole joint, so they are evaluated once for all sweeps.
/// C(d) = error + turn . d, where d is the rotation of A relative to B since the linearization (turnedSince).
struct alignas(4 * sizeof(Real)) AngularRows {
  static constexpr int kMost = 3;
  struct Row {
    Vec3 turn;   ///< Jacobian, in world axes at x^t; rotates with B
    Real error;  ///< C at the linearization; for a group less its shift
  };
  Row row[kMost];
  Real lambda[kMost], k, compliance, bound;
  Real lo, hi;  ///< interval of an axis row
  Vec3 bend;    ///< column norms of the second derivative, world axes
  int count;    ///< rows of a group; 0: a row of an axis; kWatchedRow: a watched limit
};
inline constexpr int kWatchedRow = -1;

/// Linearization point of angular rows: rotation of B since x^t relative to that of A.
struct alignas(4 * sizeof(Real)) AngularOrigin {
  Quat between;
};
/// Linearized angular rows of a joint.
template <class F> struct JointAngularRows {
  AngularOrigin from;
  AngularRows law[hasAngularRows<F>() ? firstAngularLaw<F>() : 1];
};

RUBBLE_HD inline AngularOrigin turnsFrom(const Quat& turnedA, const Quat& turnedB) {
  return {conjugate(turnedA) * turnedB};
}
/// Rotation of A relative to B since the linearization, in the axes of AngularRows::Row::turn [rad].
/// `turnedA`, `turnedB`: rotations since x^t.
RUBBLE_HD inline Vec3 turnedSince(const AngularOrigin& from, const Quat& turnedA, const Quat& turnedB) {
  return Real(2) * shortArc(conjugate(turnedB) * turnedA * from.between).v;
}

/// Linearizes force law `k` of a part at the present poses. Returns false if the law is inactive.
template <class F, int I, class P>
RUBBLE_HD bool linearizeAngularRow(const JointSpec<F>& spec, const Joint<F>& joint, const Pose& a,
                                   const Pose& b, const Quat& turnedB, int k, AngularRows& out) {
  static_assert(P::kRows <= AngularRows::kMost);
  if (!(joint.acting >> angularBit(firstAngularLaw<F, I>() + k) & 1)) return false;
  const auto& rows = loadVectorized(partOf<I>(joint.parts));
  Real error[P::kRows], force[P::kRows], hessian;
  partErrors<P>(spec, joint, rows, a, b, error);
  if constexpr (P::kAxis) {
    const RotorRow& rotor = rows.rotor;
    const AxisRow own = k == 0   ? rows.limit
                        : k == 1 ? rows.drive
                        : k == 2
                            ? rows.friction
                            : AxisRow{rotor.load, rotor.k, rotor.origin, rotor.origin, 0, kHardValue, 1, 0};
    axisForce(own, error[0], force[0], hessian);
    out.lambda[0] = own.lambda, out.lambda[1] = out.lambda[2] = 0;
    out.k = own.k, out.compliance = own.keepsMultiplier ? own.compliance : Real(0), out.bound = own.bound;
    out.lo = own.lo, out.hi = own.hi;
    out.count = own.active == kWatched ? kWatchedRow : 0;
  } else {
    forcesAt<P>(rows, error, force, hessian);
    for (int i = 0; i < AngularRows::kMost; ++i) out.lambda[i] = i < P::kRows ? rows.lambda[i] : Real(0);
    out.k = rows.state.k, out.compliance = rows.state.compliance, out.bound = rows.state.bound;
    out.lo = out.hi = 0;
    out.count = P::kRows;
  }
  Vec6 j[P::kRows];
  P::jacobian(spec.data, joint.memory, a, b, 0, j);
  for (int i = 0; i < AngularRows::kMost; ++i)
    out.row[i] = i < P::kRows ? AngularRows::Row{rotateInverse(turnedB, j[i].ang), error[i]}
                              : AngularRows::Row{{0, 0, 0}, 0};
  out.bend = P::curvature(spec.data, joint.memory, a, b, 0, force).ang;
  return true;
}
/// Linearizes all angular rows of a joint.
template <class F>
RUBBLE_HD void linearizeAngularRows(const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a,
                                    const SidePose<F>& b, const Quat& turnedA, const Quat& turnedB,
                                    JointAngularRows<F>& out) {
  out.from = turnsFrom(turnedA, turnedB);
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (isAngular<F, P>())
      for (int k = 0; k < angularLaws<F, P>(); ++k)
        linearizeAngularRow<F, I, P>(spec, joint, a, b, turnedB, k, out.law[firstAngularLaw<F, I>() + k]);
  });
}

/// Forces of angular rows after the relative rotation `turned` since the linearization. Returns false if
/// none.
RUBBLE_HD RUBBLE_NEAR bool turnForces(const AngularRows& rows, const Vec3& turned,
                                      Real (&force)[AngularRows::kMost], Real& hessian) {
  Real error[AngularRows::kMost];
  for (int i = 0; i < AngularRows::kMost; ++i) error[i] = rows.row[i].error + dot(rows.row[i].turn, turned);
  if (rows.count <= 0) {
    const int acts = rows.count == kWatchedRow ? kWatched : 1;
    axisForce({rows.lambda[0], rows.k, rows.lo, rows.hi, rows.compliance, rows.bound, acts, 1}, error[0],
              force[0], hessian);
    for (int i = 1; i < AngularRows::kMost; ++i) force[i] = Real(0);
    return force[0] != Real(0) || hessian > Real(0);
  }
  // rows beyond the last one are zero; a fixed number of them stays in registers
  cutForce<AngularRows::kMost, Real>({rows.k, rows.compliance, rows.bound}, error, rows.lambda, force,
                                     AngularRows::kMost, hessian);
  return true;
}

/// Streams the linearized angular rows of a joint in a sweep. `ahead`: prefetches the first force law, which
/// costs registers.
template <bool ahead> class AngularRowStream {
 public:
  /// `acting`: of the JointFrame. `from`, `laws`: may be null for joints without angular rows.
  RUBBLE_HD RUBBLE_NEAR AngularRowStream(int acting, const AngularOrigin* from, const AngularRows* laws)
      : from_(from), laws_(laws), left_(static_cast<unsigned>(acting) >> angularBit(0)) {
    if constexpr (ahead)
      if (left_ != 0) fetch();
  }
  /// Adds the rows to the block of the body on `side`.
  RUBBLE_HD RUBBLE_NEAR void accumulate(const Quat& turnedA, const Quat& turnedB, int side, Block6& block) {
    if (left_ == 0) return;
    const Vec3 turned = turnedSince(loadVectorized(*from_), turnedA, turnedB);
    const Real sign = side == 0 ? Real(1) : Real(-1);
    for (bool asked = ahead; left_ != 0; asked = false, left_ &= left_ - 1) {
      if (!asked) fetch();
      const AngularRows& rows = next_;
      Real force[AngularRows::kMost], hessian;
      if (!turnForces(rows, turned, force, hessian)) continue;
      RUBBLE_UNROLL
      for (int i = 0; i < AngularRows::kMost; ++i) {
        if (i >= max(rows.count, 1)) break;
        const Vec3 j = rotate(turnedB, rows.row[i].turn);
        block.fa -= (sign * force[i]) * j;
        block.aa += outer(j, hessian);
      }
      accumulateCurvature(block, {{0, 0, 0}, rows.bend});
    }
  }

 private:
  RUBBLE_HD RUBBLE_NEAR void fetch() { next_ = loadVectorized(laws_[lowestBit(left_)]); }

  const AngularOrigin* const from_;
  const AngularRows* const laws_;
  unsigned left_;
  AngularRows next_;
};

/// Errors of the anchors of a joint about a point. Poses are displacements and rotations since x^t.
RUBBLE_HD RUBBLE_NEAR void anchorErrors(const PivotFrame& frame, const GroupRows<AnchorRows::kRows>& rows,
                                        const Pose& a, const Pose& b, Real (&error)[AnchorRows::kRows]) {
  const Anchors<Real> levers{frame.end[0].lever, frame.end[1].lever};
  heldErrors<AnchorRows>(rows.shift, levers, NoMemory{}, Pose{frame.offset + a.p, a.q}, b, error);
}

/// Adds all rows of a joint about a point to the block of the body on `side`. The block may be about a point
/// other than the center of the body; the center then lies `shift` from it. Poses are displacements and
/// rotations since x^t.
template <class Turns>
RUBBLE_HD RUBBLE_NEAR void accumulatePivot(const PivotFrame& frame,
                                           const GroupRows<AnchorRows::kRows>& anchors, Turns& turns,
                                           const Pose& a, const Pose& b, int side, Block6& block,
                                           const Vec3& shift = {0, 0, 0}) {
  if (frame.acting & 1) {
    Real error[AnchorRows::kRows], force[AnchorRows::kRows], hessian;
    anchorErrors(frame, anchors, a, b, error);
    aggregateForce<AnchorRows::kRows>(anchors.state, error, anchors.lambda, force, AnchorRows::kRows,
                                      hessian);
    AnchorRows::accumulate(Anchors<Real>{frame.end[0].lever, frame.end[1].lever}, a, b, side == 0, shift,
                           force, hessian, block);
  }
  turns.accumulate(a.q, b.q, side, block);
}

/// Adds all rows of any other joint to the block of a body; `side`: the first side of this body.
template <class F>
RUBBLE_HD void accumulateJoint(const JointSpec<F>& spec, const Joint<F>& joint,
                               const JointAngularRows<F>* turns, const SidePose<F>& a, const SidePose<F>& b,
                               const Quat& turnedA, const Quat& turnedB, int side, Block6& block,
                               const Vec3& shift = {0, 0, 0}) {
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (!isAngular<F, P>()) {
      const auto& rows = loadVectorized(partOf<I>(joint.parts));
      if (!partActs<P>(partOf<I>(spec.parts), rows)) return;
      Real error[P::kRows], force[P::kRows], hessian;
      partErrors<P>(spec, joint, rows, a, b, error);
      if (!forcesAt<P>(rows, error, force, hessian)) return;
      Vec6 j[P::kRows];
      jacobianOf<P>(spec, joint, a, b, side, j);
      for (int i = 0; i < P::kRows; ++i)
        accumulateRow(block, {j[i].lin, j[i].ang + cross(shift, j[i].lin)}, force[i], hessian);
      accumulateCurvature(block, curvatureOf<P>(spec, joint, a, b, side, force), shift);
    }
  });
  if constexpr (hasAngularRows<F>())
    AngularRowStream<false>(joint.acting, &turns->from, turns->law).accumulate(turnedA, turnedB, side, block);
}

/// Adds all rows of a joint to the block of an aggregate that contains the sides in the bit mask `inside`.
/// Side i moves by (dp + dw x shift_i, dw), so a row has the Jacobian sum J_i T_i, T_i = [1, -[shift_i]; 0,
/// 1].
template <class F>
RUBBLE_HD void accumulateJointOfGroup(const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a,
                                      const SidePose<F>& b, unsigned inside, const Vec3 (&shift)[kSides<F>],
                                      Block6& block) {
  forEachPart<F>([&]<int I, class P>() {
    Real error[P::kRows], force[P::kRows], hessian;
    const auto& rows = loadVectorized(partOf<I>(joint.parts));
    if (!partActs<P>(partOf<I>(spec.parts), rows)) return;
    partErrors<P>(spec, joint, rows, a, b, error);
    if (!forcesAt<P>(rows, error, force, hessian)) return;
    Vec6 sum[P::kRows]{};
    for (int side = 0; side < kSides<F>; ++side) {
      if (!(inside >> side & 1u)) continue;
      Vec6 j[P::kRows];
      P::jacobian(spec.data, joint.memory, a, b, side, j);
      for (int i = 0; i < P::kRows; ++i)
        sum[i].lin += j[i].lin, sum[i].ang += j[i].ang + cross(shift[side], j[i].lin);
    }
    for (int i = 0; i < P::kRows; ++i) accumulateRow(block, sum[i], force[i], hessian);
  });
}

}  // namespace rubble::RUBBLE_CORE
