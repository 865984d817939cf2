#pragma once
/// How the rows of a joint act on the block of a body or of a group, and those of its parts that turn, which are linear during an iteration.
#include "forces/joint.h"

namespace rubble::RUBBLE_CORE {

/// A part whose rows depend on the rotation of A relative to B alone. Until the next iteration they are linear in it: a rotation of the
/// joint as a whole changes nothing, and what they cost is found once for all sweeps.
template <class F, class P>
constexpr bool isTurn() {
  return P::kUnit == RowUnit::Angular && !isCarried<F>();
}
template <class F>
constexpr bool hasTurns() {
  return []<class... P>(PartList<P...>) { return (isTurn<F, P>() || ...); }(typename F::Parts{});
}
/// C(d) = error + turn . d, where A has turned by d against B since then (turnedSince).
template <int N>
struct alignas(4 * sizeof(Real)) TurnRows {
  Real error[N];  ///< as forcesAt wants it
  Vec3 turn[N];
  Vec3 bend;      ///< column norms of the second derivatives, in the world's axes
};
struct NoTurn {};
template <class P>
using TurnsOf = std::conditional_t<P::kUnit == RowUnit::Angular, TurnRows<P::kRows>, NoTurn>;
template <class F>
struct JointTurns {
  Quat from;  ///< A seen from B
  PartStore<TurnsOf, typename F::Parts> parts;
};

RUBBLE_HD inline Quat turnFromB(const Pose& a, const Pose& b) { return conjugate(b.q) * a.q; }
/// What A has turned by against B since then, in the axes of B [rad].
RUBBLE_HD inline Vec3 turnedSince(const Quat& from, const Pose& a, const Pose& b) {
  return Real(2) * shortArc(turnFromB(a, b) * conjugate(from)).v;
}

/// False, and nothing is found: it does not act.
template <class F, int I, class P>
RUBBLE_HD bool linearizeTurn(const JointSpec<F>& spec, const Joint<F>& joint, const Pose& a, const Pose& b, TurnRows<P::kRows>& out) {
  const auto& rows = readWhole(partOf<I>(joint.parts));
  if (!partActs<P>(partOf<I>(spec.parts), rows)) return false;
  Real force[P::kRows], hessian;
  Vec6 j[P::kRows];
  partErrors<P>(spec, joint, rows, a, b, out.error);
  forcesAt<P>(rows, out.error, force, hessian);
  P::jacobian(spec.data, joint.memory, a, b, 0, j);
  for (int i = 0; i < P::kRows; ++i) out.turn[i] = rotateInverse(b.q, j[i].ang);
  out.bend = P::curvature(spec.data, joint.memory, a, b, 0, force).ang;
  return true;
}
/// All parts of a joint.
template <class F>
RUBBLE_HD void linearizeTurns(const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a, const SidePose<F>& b, JointTurns<F>& out) {
  out.from = turnFromB(a, b);
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (isTurn<F, P>()) linearizeTurn<F, I, P>(spec, joint, a, b, partOf<I>(out.parts));
  });
}

/// Adds a part that turns: `turned` as of turnedSince().
template <class P>
RUBBLE_HD RUBBLE_NEAR void stampTurn(const PartRows<P>& own, const TurnRows<P::kRows>& rows, const Vec3& turned, const Quat& frameB, int side,
                                     Block6& block) {
  Real error[P::kRows], force[P::kRows], hessian;
  for (int i = 0; i < P::kRows; ++i) error[i] = rows.error[i] + dot(rows.turn[i], turned);
  if (!forcesAt<P>(own, error, force, hessian)) return;
  const Real sign = side == 0 ? Real(1) : Real(-1);
  for (int i = 0; i < P::kRows; ++i) {
    const Vec3 j = rotate(frameB, rows.turn[i]);
    block.fa -= (sign * force[i]) * j;
    block.aa += outer(j, hessian);
  }
  stampCurvature(block, {{0, 0, 0}, rows.bend});
}

/// Adds all rows of a joint to the block of one of its bodies, by the first side that it has. The block may be about another point than the
/// centre of the body, which then lies `shift` from that point. `turns`: of a type that has parts that turn.
template <class F>
RUBBLE_HD void stampJoint(const JointSpec<F>& spec, const Joint<F>& joint, const JointTurns<F>* turns, const SidePose<F>& a,
                          const SidePose<F>& b, int side, Block6& block, const Vec3& shift = {0, 0, 0}) {
  Vec3 turned{0, 0, 0};
  if constexpr (hasTurns<F>()) turned = turnedSince(turns->from, a, b);
  forEachPart<F>([&]<int I, class P>() {
    const auto& rows = readWhole(partOf<I>(joint.parts));
    if (!partActs<P>(partOf<I>(spec.parts), rows)) return;
    if constexpr (isTurn<F, P>()) {
      stampTurn<P>(rows, readWhole(partOf<I>(turns->parts)), turned, b.q, side, block);
    } else {
      Real error[P::kRows], force[P::kRows], hessian;
      partErrors<P>(spec, joint, rows, a, b, error);
      if (!forcesAt<P>(rows, error, force, hessian)) return;
      if constexpr (requires { P::stamp(spec.data, a, b, side == 0, shift, force, hessian, block); }) {
        P::stamp(spec.data, a, b, side == 0, shift, force, hessian, block);
      } else {
        Vec6 j[P::kRows];
        jacobianOf<P>(spec, joint, a, b, side, j);
        for (int i = 0; i < P::kRows; ++i) stampRow(block, {j[i].lin, j[i].ang + cross(shift, j[i].lin)}, force[i], hessian);
        stampCurvature(block, curvatureOf<P>(spec, joint, a, b, side, force), shift);
      }
    }
  });
}

/// Adds all rows of a joint to the block of a group that several of its sides move with, and others do not (bits of `inside`): by
/// (dp + dw x shift_i, dw). A row changes by sum J_i T_i, T_i = [1, -[shift_i]; 0, 1].
template <class F>
RUBBLE_HD void stampJointOfGroup(const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a, const SidePose<F>& b, unsigned inside,
                                 const Vec3 (&shift)[kSides<F>], Block6& block) {
  forEachPart<F>([&]<int I, class P>() {
    Real error[P::kRows], force[P::kRows], hessian;
    const auto& rows = readWhole(partOf<I>(joint.parts));
    if (!partActs<P>(partOf<I>(spec.parts), rows)) return;
    partErrors<P>(spec, joint, rows, a, b, error);
    if (!forcesAt<P>(rows, error, force, hessian)) return;
    Vec6 sum[P::kRows]{};
    for (int side = 0; side < kSides<F>; ++side) {
      if (!(inside >> side & 1u)) continue;
      Vec6 j[P::kRows];
      P::jacobian(spec.data, joint.memory, a, b, side, j);
      for (int i = 0; i < P::kRows; ++i) sum[i].lin += j[i].lin, sum[i].ang += j[i].ang + cross(shift[side], j[i].lin);
    }
    for (int i = 0; i < P::kRows; ++i) stampRow(block, sum[i], force[i], hessian);
  });
}

}  // namespace rubble::RUBBLE_CORE
