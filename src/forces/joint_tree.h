#pragma once
/// The rows of a joint as the block of a whole tree of joints sees them (stages/trees.h).
///
/// In a tree that is solved exactly a hard row has the stiffness kTreeStiffness m_row / dt^2 in place of its own k, a row of finite stiffness its
/// own compliance beside it, and its multiplier is that of the solution: F + h J dx, the dual update [S 13] of a row so stiff. Limits are among
/// them while they push; one that would have to pull lets go. All other rows (friction, drives, forces cut at their bound) are as in the block of
/// a body.
#include "forces/joint.h"
#include "solver/dense6.h"

namespace rubble::RUBBLE_CORE {

/// Stiffness of hard rows in an exact tree over m_row / dt^2 [1]: what is left of it in a multiplier's error after one solve of a chain of N
/// links under R times their mass is about N R / kTreeStiffness; the elimination, in double, keeps seven digits beside it.
inline constexpr double kTreeStiffness = 1e9;

/// Rows whose force is this near to their bound, as a share of it, are at it: a tree that held them would move bodies by a force that they must
/// not have. A margin, so that round-off does not decide.
inline constexpr Real kAtBound = Real(1e-4);

/// How a tree has its rows: with their own stiffness, solved exactly, or exactly once more, when limits that it has come to still hold.
enum class TreeSolve { Own, Exact, Again };
/// A limit is reached within this share of L (of 1 rad): exact solves leave it off by round-off, on either side, which must not decide.
inline constexpr Real kReached = Real(1e-5);

/// A row whose multiplier the tree finds.
struct SolvedRow {
  double force = 0, hessian = 0;
  int side = 0;        ///< of a limit: 1 it pushes down, -1 up; 0 both
  bool there = false;
};

template <int N>
struct TreeRows {
  double force[N], hessian;  ///< all that acts
  Real own[N];               ///< force by the rows' own stiffness, for the curvature
  SolvedRow solved[N];       ///< rows that are held together, or the limit of an axis
  SolvedRow drive;           ///< of an axis
};

/// dC/dx of the body of that side. Apart, as treeRows is: F + h J dx with h = kTreeStiffness m_row / dt^2 is a small difference of large numbers,
/// and has no correct digit unless the blocks were summed with the same bits of C and J. On a device one expression has other bits in each kernel
/// that it is inlined in, by the products that are contracted there.
template <class P, class F>
RUBBLE_HD RUBBLE_APART void treeJacobian(const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a, const SidePose<F>& b, int side,
                                         Vec6 (&j)[P::kRows]) {
  jacobianOf<P>(spec, joint, a, b, side, j);
}

/// Rows of part I at the present poses; false if the part does not act.
template <class F, int I, class P>
RUBBLE_HD RUBBLE_APART bool treeRows(const StepConstants& c, const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a,
                                     const SidePose<F>& b, TreeSolve how, TreeRows<P::kRows>& out) {
  const auto& rows = partOf<I>(joint.parts);
  Real error[P::kRows];
  const auto solve = [&](SolvedRow& row, Real start, Real compliance, Real value, Real lambda) {
    const double k = kTreeStiffness * static_cast<double>(start / c.startStiffness), s = 1 / (1 + k * static_cast<double>(compliance));
    row.force = s * (k * static_cast<double>(value) + static_cast<double>(lambda));
    row.hessian = s * k;
    row.there = true;
  };
  if constexpr (P::kAxis) {
    if (!actsAtAll(rows)) return false;
    P::constraint(spec.data, joint.memory, a, b, error);
    Real hessian;
    axisForces(rows, error[0], out.own[0], hessian);
    // 1: c is at the upper end, -1: at the lower one, 0: not known to be at one
    const auto reached = [&](const AxisRow& row) {
      if (how != TreeSolve::Again || !row.acts || row.lo == row.hi) return 0;
      return error[0] - row.hi > -kReached * rows.length ? 1 : row.lo - error[0] > -kReached * rows.length ? -1 : 0;
    };
    if (out.own[0] == Real(0) && !(hessian > Real(0)) && reached(rows.limit) == 0) return false;
    out.force[0] = static_cast<double>(out.own[0]), out.hessian = static_cast<double>(hessian);
    const auto take = [&](const AxisRow& row, SolvedRow& solved) {
      if (how == TreeSolve::Own || !row.acts || !row.keepsMultiplier) return;
      const bool both = row.lo == row.hi;
      Real force, stiffness;
      const Real beyond = axisForce(row, error[0], force, stiffness);
      const int end = both ? 0 : force > Real(0) ? 1 : force < Real(0) ? -1 : reached(row);
      if (!(absOf(force) < row.bound * (Real(1) - kAtBound)) || (end == 0 && !both)) return;
      const Real off = force != Real(0) && !both ? beyond : error[0] - (end < 0 ? row.lo : row.hi);
      solve(solved, rows.start, row.compliance, off, row.lambda);
      solved.side = end;
      out.force[0] += solved.force - static_cast<double>(force);
      out.hessian += solved.hessian - static_cast<double>(stiffness);
    };
    take(rows.limit, out.solved[0]);
    take(rows.drive, out.drive);
  } else {
    const GroupSpec& own = partOf<I>(spec.parts);
    if (own.mode == GroupMode::Off) return false;
    P::constraint(spec.data, joint.memory, a, b, error);
    for (int i = 0; i < P::kRows; ++i) error[i] -= rows.shift[i];
    Real hessian;
    const bool inside = groupForce<P::kRows>(rows.state, error, rows.lambda, out.own, P::kRows, hessian);
    out.hessian = static_cast<double>(hessian);
    for (int i = 0; i < P::kRows; ++i) out.force[i] = static_cast<double>(out.own[i]);
    Real size2 = 0;
    for (int i = 0; i < P::kRows; ++i) size2 += out.own[i] * out.own[i];
    const bool free = inside && std::sqrt(size2) < rows.state.bound * (Real(1) - kAtBound);
    if (how == TreeSolve::Own || !free || own.mode != GroupMode::Hold || !rows.state.keepsMultiplier) return true;
    for (int i = 0; i < P::kRows; ++i) {
      solve(out.solved[i], rows.state.rule.start, rows.state.compliance, error[i], rows.lambda[i]);
      out.force[i] = out.solved[i].force;
    }
    out.hessian = out.solved[0].hessian;
  }
  return true;
}

/// Where the coupling of a body to another one of its joint is summed: by a side of that one.
struct TreeCoupling {
  int side;
  Dense6* block;  ///< null: none
};

/// Adds the rows of a joint to the block (h, f) of one of its bodies (the lower triangle of h), by its first side, and to its couplings (`side`, other side).
template <class F>
RUBBLE_HD void stampJointOfTree(const StepConstants& c, const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a, const SidePose<F>& b,
                                int side, TreeSolve how, Dense6& h, Long6& f, TreeCoupling first, TreeCoupling second) {
  forEachPart<F>([&]<int I, class P>() {
    TreeRows<P::kRows> rows;
    if (!treeRows<F, I, P>(c, spec, joint, a, b, how, rows)) return;
    Vec6 j[P::kRows];
    Long6 own[P::kRows];
    treeJacobian<P>(spec, joint, a, b, side, j);
    for (int i = 0; i < P::kRows; ++i) {
      own[i] = longer(j[i]);
      for (int k = 0; k < 6; ++k) f.v[k] -= rows.force[i] * own[i].v[k];
    }
    addSquare(h, own, rows.hessian);
    const auto couple = [&](const TreeCoupling& to) {
      if (!to.block) return;
      Long6 other[P::kRows];
      treeJacobian<P>(spec, joint, a, b, to.side, j);
      for (int i = 0; i < P::kRows; ++i) other[i] = longer(j[i]);
      addOuter(*to.block, own, other, rows.hessian);
    };
    couple(first), couple(second);
    const Long6 bend = longer(curvatureOf<P>(spec, joint, a, b, side, rows.own));
    for (int k = 0; k < 6; ++k) h.m[k][k] += bend.v[k];
  });
}

/// Multipliers after the tree has found that the bodies move by dxA, dxB, of which they make `share`. The poses are those before.
template <class F>
RUBBLE_HD void takeTreeForces(const StepConstants& c, const JointSpec<F>& spec, Joint<F>& joint, const SidePose<F>& a, const SidePose<F>& b,
                              const Long6& dxA, const Long6& dxB, TreeSolve how, double share) {
  forEachPart<F>([&]<int I, class P>() {
    TreeRows<P::kRows> rows;
    if (!treeRows<F, I, P>(c, spec, joint, a, b, how, rows) || !(rows.solved[0].there || rows.drive.there)) return;
    Vec6 ja[P::kRows], jb[P::kRows];
    treeJacobian<P>(spec, joint, a, b, 0, ja);
    treeJacobian<P>(spec, joint, a, b, 1, jb);
    const auto forceOf = [&](const SolvedRow& row, int i) {
      const double force = row.force + row.hessian * (dot(longer(ja[i]), dxA) + dot(longer(jb[i]), dxB));
      // a limit that would have to pull lets go: the next solve is without it
      return row.side > 0 ? max(force, 0.0) : row.side < 0 ? min(force, 0.0) : force;
    };
    const auto take = [&](Real& lambda, double force, double size, Real bound) {
      if (size > static_cast<double>(bound)) force *= static_cast<double>(bound) / size;
      lambda = static_cast<Real>(static_cast<double>(lambda) + share * (force - static_cast<double>(lambda)));
    };
    auto& own = partOf<I>(joint.parts);
    if constexpr (P::kAxis) {
      const auto takeRow = [&](AxisRow& row, const SolvedRow& solved) {
        if (!solved.there) return;
        const double force = forceOf(solved, 0);
        take(row.lambda, force, std::fabs(force), row.bound);
      };
      takeRow(own.limit, rows.solved[0]);
      takeRow(own.drive, rows.drive);
    } else {
      double force[P::kRows], size2 = 0;
      for (int i = 0; i < P::kRows; ++i) {
        force[i] = forceOf(rows.solved[i], i);
        size2 += force[i] * force[i];
      }
      for (int i = 0; i < P::kRows; ++i) take(own.lambda[i], force[i], std::sqrt(size2), own.state.bound);
    }
  });
}

}  // namespace rubble::RUBBLE_CORE
