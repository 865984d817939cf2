#pragma once
/// The rows of a joint as the block of a whole tree of joints sees them (stages/trees.h).
///
/// In a tree that is solved exactly a hard row has the stiffness kTreeStiffness m_row / dt^2 in place of its own k, a row of finite stiffness its
/// own compliance beside it, and its multiplier is that of the solution: F + h J dx, the dual update [S 13] of a row so stiff. Limits are among
/// them while they push; one that would have to pull lets go. All other rows (friction, drives, forces cut at their bound) are as in the block of
/// a body.
#include "forces/joint.h"
#include "math/dense6.h"

namespace rubble::RUBBLE_CORE {

/// Stiffness of hard rows in an exact tree over m_row / dt^2 [1]: what is left of it in a multiplier's error after one solve of a chain of N
/// links under R times their mass is about N R / kTreeStiffness; the elimination, in double, keeps seven digits beside it.
inline constexpr double kTreeStiffness = 1e9;

template <int N>
struct TreeRows {
  double force[N], hessian;        ///< all that acts
  double solved[N], solvedHessian; ///< the share whose multiplier the tree finds
  Real own[N];                     ///< force by the rows' own stiffness, for the curvature
  bool exact;                      ///< is there such a share?
  int side;                        ///< of a limit: 1 it pushes down, -1 up; 0 both
};

/// Rows of part I at the present poses; false if the part does not act. `exact`: the tree is solved exactly.
template <class F, int I, class P>
RUBBLE_HD bool treeRows(const StepConstants& c, const JointSpec<F>& spec, const Joint<F>& joint, const Pose& a, const Pose& b, bool exact,
                        TreeRows<P::kRows>& out) {
  const auto& rows = partOf<I>(joint.parts);
  Real error[P::kRows];
  out.exact = false;
  const auto solve = [&](int i, double unit, double compliance, Real lambda) {
    const double k = kTreeStiffness * unit, s = 1 / (1 + k * compliance);
    out.solved[i] = s * (k * static_cast<double>(error[i]) + static_cast<double>(lambda));
    out.solvedHessian = s * k;
    out.exact = true;
  };
  if constexpr (P::kAxis) {
    if (!actsAtAll(rows)) return false;
    P::constraint(spec.data, joint.memory, a, b, error);
    Real hessian;
    axisForces(rows, error[0], out.own[0], hessian);
    if (!(hessian > Real(0))) return false;
    out.force[0] = static_cast<double>(out.own[0]), out.hessian = static_cast<double>(hessian);
    const AxisRow& limit = rows.limit;
    if (!exact || !limit.acts || !limit.keepsMultiplier) return true;
    Real force, stiffness;
    const Real beyond = axisForce(limit, error[0], force, stiffness);
    if (!(absOf(force) < limit.bound) || (force == Real(0) && limit.lo != limit.hi)) return true;
    error[0] = force == Real(0) ? error[0] - limit.hi : beyond;
    out.side = limit.lo == limit.hi ? 0 : force > Real(0) ? 1 : -1;
    solve(0, static_cast<double>(rows.start / c.startStiffness), static_cast<double>(limit.compliance), limit.lambda);
    out.force[0] += out.solved[0] - static_cast<double>(force);
    out.hessian += out.solvedHessian - static_cast<double>(stiffness);
  } else {
    const GroupSpec& own = partOf<I>(spec.parts);
    if (own.mode == GroupMode::Off) return false;
    P::constraint(spec.data, joint.memory, a, b, error);
    for (int i = 0; i < P::kRows; ++i) error[i] -= rows.shift[i];
    Real hessian;
    const bool inside = groupForce<P::kRows>(rows.state, error, rows.lambda, out.own, P::kRows, hessian);
    out.hessian = static_cast<double>(hessian);
    for (int i = 0; i < P::kRows; ++i) out.force[i] = static_cast<double>(out.own[i]);
    if (!exact || !inside || own.mode != GroupMode::Hold || !rows.state.keepsMultiplier) return true;
    for (int i = 0; i < P::kRows; ++i) {
      solve(i, static_cast<double>(rows.state.rule.start / c.startStiffness), static_cast<double>(rows.state.compliance), rows.lambda[i]);
      out.force[i] = out.solved[i];
    }
    out.hessian = out.solvedHessian;
  }
  return true;
}

/// Adds the rows of a joint to the block (h, f) of one of its bodies, and to the block (`side`, other side) if `across` is given.
template <class F>
RUBBLE_HD void stampJointOfTree(const StepConstants& c, const JointSpec<F>& spec, const Joint<F>& joint, const Pose& a, const Pose& b, int side,
                                bool exact, Dense6& h, Long6& f, Dense6* across) {
  forEachPart<F>([&]<int I, class P>() {
    TreeRows<P::kRows> rows;
    if (!treeRows<F, I, P>(c, spec, joint, a, b, exact, rows)) return;
    Vec6 j[P::kRows], other[P::kRows];
    P::jacobian(spec.data, joint.memory, a, b, side, j);
    if (across) P::jacobian(spec.data, joint.memory, a, b, 1 - side, other);
    for (int i = 0; i < P::kRows; ++i) {
      const Long6 own = longer(j[i]);
      addOuter(h, own, own, rows.hessian);
      for (int k = 0; k < 6; ++k) f.v[k] -= rows.force[i] * own.v[k];
      if (across) addOuter(*across, own, longer(other[i]), rows.hessian);
    }
    const Long6 bend = longer(P::curvature(spec.data, joint.memory, a, b, side, rows.own));
    for (int k = 0; k < 6; ++k) h.m[k][k] += bend.v[k];
  });
}

/// Multipliers after the tree has found that the bodies move by dxA, dxB, of which they make `share`. The poses are those before.
template <class F>
RUBBLE_HD void takeTreeForces(const StepConstants& c, const JointSpec<F>& spec, Joint<F>& joint, const Pose& a, const Pose& b, const Long6& dxA,
                              const Long6& dxB, double share) {
  forEachPart<F>([&]<int I, class P>() {
    TreeRows<P::kRows> rows;
    if (!treeRows<F, I, P>(c, spec, joint, a, b, true, rows) || !rows.exact) return;
    Vec6 ja[P::kRows], jb[P::kRows];
    P::jacobian(spec.data, joint.memory, a, b, 0, ja);
    P::jacobian(spec.data, joint.memory, a, b, 1, jb);
    double force[P::kRows], size2 = 0;
    for (int i = 0; i < P::kRows; ++i) {
      force[i] = rows.solved[i] + rows.solvedHessian * (dot(longer(ja[i]), dxA) + dot(longer(jb[i]), dxB));
      size2 += force[i] * force[i];
    }
    auto& own = partOf<I>(joint.parts);
    const auto take = [&](Real& lambda, double to, Real bound) {
      const double size = std::sqrt(size2), cut = size > static_cast<double>(bound) ? static_cast<double>(bound) / size : 1;
      lambda = static_cast<Real>(static_cast<double>(lambda) + share * (cut * to - static_cast<double>(lambda)));
    };
    if constexpr (P::kAxis) {
      // a limit that would have to pull lets go: the next solve is without it
      const double kept = rows.side > 0 ? max(force[0], 0.0) : rows.side < 0 ? min(force[0], 0.0) : force[0];
      take(own.limit.lambda, kept, own.limit.bound);
    } else {
      for (int i = 0; i < P::kRows; ++i) take(own.lambda[i], force[i], own.state.bound);
    }
  });
}

}  // namespace rubble::RUBBLE_CORE
