#pragma once
/// The rows of a joint in the block system of a joint tree (stages/trees/trees.h).
///
/// In an exactly solved tree, hard rows have the stiffness kTreeStiffness m_row / dt^2 instead of k; rows of
/// finite stiffness have their own compliance in addition. Their multiplier becomes that of the solution, F +
/// h J dx, which is the dual update [S 13] of so stiff a row. Limits are included while they push and
/// released when they would pull. All other rows (friction, drives, forces cut at their bound) are as in the
/// block of a body.
#include "forces/joint.h"
#include "solver/dense6.h"

namespace rubble::RUBBLE_CORE {

/// Stiffness of hard rows in an exact tree over m_row / dt^2 [1]. After one solve of a chain of N links under
/// R times their mass, the relative error of a multiplier is about N R / kTreeStiffness. The elimination in
/// double precision retains seven digits besides.
inline constexpr double kTreeStiffness = 1e9;

/// A force within this share of its bound counts as at the bound. A tree that solved such a row exactly would
/// apply a larger force. The margin keeps the decision independent of round-off.
inline constexpr Real kAtBound = Real(1e-4);

/// How a tree treats its rows: with their own stiffness; solved exactly; or solved exactly again, with
/// reached limits kept.
enum class TreeSolve { Own, Exact, Again };
/// A limit within this share of L (of 1 rad) counts as reached. After an exact solve it is violated only by
/// round-off, whose sign is random.
inline constexpr Real kReached = Real(1e-5);

/// Which multiplier takes the force of a row.
enum class TreeTake { Nothing, Held, Limit, UpperLimit, LowerLimit, Drive };

/// A row of a joint in its tree: force F and stiffness h at the present poses.
template <int kSides> struct TreeRow {
  double force, hessian;
  Vec6 j[kSides];  ///< dC/dx, at the first side of each body
  TreeTake take;
};
/// Most rows of a part: three of a group, or limit, drive and the remainder of one axis.
inline constexpr int kMostTreeRows = 3;
/// The active rows of a part: those of a group, or limit, drive and the remainder of an axis. Both the block
/// system and the multipliers use these records. F + h J dx with h = kTreeStiffness m_row / dt^2 is a small
/// difference of large numbers, which has no correct digit unless C and J are bitwise the same in both.
template <int kSides> struct alignas(2 * sizeof(double)) TreePart {
  int count;
  Vec6 bend[kSides];  ///< column norms of the second derivatives, weighted by the forces at the rows' own
                      ///< stiffness
  TreeRow<kSides> row[kMostTreeRows];

  RUBBLE_HD void add(double force, double hessian, TreeTake take) {
    TreeRow<kSides>& next = row[count++];
    next.force = force, next.hessian = hessian, next.take = take;
  }
  /// Of what is used: all before the rows, and `count` rows.
  RUBBLE_HD std::size_t bytes() const {
    return count == 0 ? 0 : sizeof *this - static_cast<std::size_t>(kMostTreeRows - count) * sizeof row[0];
  }
};
template <class F> struct TreeRows {
  TreePart<kSides<F>> part[F::Parts::kCount];
  Vec3 gap;  ///< gap of its anchors at the end of the step, beyond the inherited gap [m]
};

/// Adds a row with the stiffness of the tree, in series with its own compliance.
template <int kSides>
RUBBLE_HD void addSolvedRow(const StepConstants& c, TreePart<kSides>& out, Real start, Real compliance,
                            Real value, Real lambda, TreeTake take) {
  const double k = kTreeStiffness * static_cast<double>(start / c.startStiffness),
               s = 1 / (1 + k * static_cast<double>(compliance));
  out.add(s * (k * static_cast<double>(value) + static_cast<double>(lambda)), s * k, take);
}

/// Adds the rows of an axis at c. `own`: force at the rows' own stiffness.
template <int kSides>
RUBBLE_HD void addTreeAxis(const StepConstants& c, const AxisRows& rows, Real value, TreeSolve how,
                           TreePart<kSides>& out, Real& own) {
  own = 0;
  Real force = 0, hessian = 0;
  // 1: c is at the upper end, -1: at the lower end, 0: unknown
  const auto reached = [&](const AxisRow& row) {
    if (how != TreeSolve::Again || row.lo == row.hi) return 0;
    return value - row.hi > -kReached * rows.length ? 1 : row.lo - value > -kReached * rows.length ? -1 : 0;
  };
  const auto add = [&](const AxisRow& row, bool solved, TreeTake take) {
    if (!row.active) return;
    Real f, k;
    const Real beyond = axisForce(row, value, f, k);
    own += f;
    if (solved && how != TreeSolve::Own && row.keepsMultiplier &&
        absOf(f) < row.bound * (Real(1) - kAtBound)) {
      const bool both = row.lo == row.hi;
      const int end = both ? 0 : f > Real(0) ? 1 : f < Real(0) ? -1 : reached(row);
      if (both || end != 0) {
        const Real off = f != Real(0) && !both ? beyond : value - (end < 0 ? row.lo : row.hi);
        addSolvedRow(c, out, rows.start, row.compliance, off, row.lambda,
                     end > 0   ? TreeTake::UpperLimit
                     : end < 0 ? TreeTake::LowerLimit
                               : take);
        return;
      }
    }
    force += f;
    hessian += k;
  };
  add(rows.limit, true, TreeTake::Limit);
  add(rows.drive, true, TreeTake::Drive);
  add(rows.friction, false, TreeTake::Nothing);
  if (rows.rotor.active) {
    const Real f = rotorForce(rows.rotor, value);
    own += f, force += f, hessian += rows.rotor.k;
  }
  if (force != Real(0) || hessian > Real(0))
    out.add(static_cast<double>(force), static_cast<double>(hessian), TreeTake::Nothing);
}

/// Adds a group of rows. `own`: forces at their own stiffness.
template <int N, int kSides>
RUBBLE_HD void addTreeGroup(const StepConstants& c, const GroupSpec& spec, const GroupRows<N>& rows,
                            const Real (&error)[N], TreeSolve how, TreePart<kSides>& out, Real (&own)[N]) {
  Real hessian, size2 = 0;
  const bool inside = aggregateForce<N>(rows.state, error, rows.lambda, own, N, hessian);
  for (int i = 0; i < N; ++i) size2 += own[i] * own[i];
  const bool free = inside && std::sqrt(size2) < rows.state.bound * (Real(1) - kAtBound);
  const bool solved = how != TreeSolve::Own && free && spec.mode != GroupMode::Friction &&
                      rows.state.keepsMultiplier;
  for (int i = 0; i < N; ++i) {
    if (solved)
      addSolvedRow(c, out, rows.state.rule.start, rows.state.compliance, error[i], rows.lambda[i],
                   TreeTake::Held);
    else
      out.add(static_cast<double>(own[i]), static_cast<double>(hessian), TreeTake::Nothing);
  }
}

/// Evaluates the rows of part I of a joint at the present poses.
template <class F, int I, class P>
RUBBLE_HD void findTreePart(const StepConstants& c, const JointSpec<F>& spec, const Joint<F>& joint,
                            const SidePose<F>& a, const SidePose<F>& b, TreeSolve how,
                            TreePart<kSides<F>>& out) {
  static_assert(P::kRows <= kMostTreeRows);
  out.count = 0;
  const auto& rows = loadVectorized(partOf<I>(joint.parts));
  if (!partActs<P>(partOf<I>(spec.parts), rows)) return;
  Real error[P::kRows], own[P::kRows];
  if constexpr (P::kAxis) {
    P::constraint(spec.data, joint.memory, a, b, error);
    addTreeAxis(c, rows, error[0], how, out, own[0]);
  } else {
    heldErrors<P>(rows.shift, spec.data, joint.memory, a, b, error);
    addTreeGroup<P::kRows>(c, partOf<I>(spec.parts), rows, error, how, out, own);
  }
  if (out.count == 0) return;
  for (int side = 0; side < kSides<F>; ++side) {
    if (!isFirstSide(spec, side)) continue;
    Vec6 j[P::kRows];
    jacobianOf<P>(spec, joint, a, b, side, j);
    for (int k = 0; k < out.count; ++k) out.row[k].j[side] = j[P::kAxis ? 0 : k];
    out.bend[side] = curvatureOf<P>(spec, joint, a, b, side, own);
  }
}

/// Sides of a joint that hold the parents of an eliminated body; -1: none.
struct TreeCoupling {
  int side[2];
};

/// Adds the rows of a joint to the block (h, f) of the body on `side` (lower triangle of h) and to its
/// couplings e.
template <class F>
RUBBLE_HD void accumulateTreeRows(const TreeRows<F>& rows, int side, const TreeCoupling& to, Dense6& h,
                                  Long6& f, Dense6 (&e)[2]) {
  for (const TreePart<kSides<F>>& part : rows.part) {
    for (int k = 0; k < part.count; ++k) {
      const TreeRow<kSides<F>>& row = part.row[k];
      const Long6 own = longer(row.j[side]);
      for (int i = 0; i < 6; ++i) f.v[i] -= row.force * own.v[i];
      addSquare(h, own, row.hessian);
      for (int t = 0; t < 2; ++t)
        if (to.side[t] >= 0) addOuter(e[t], own, longer(row.j[to.side[t]]), row.hessian);
    }
    if (part.count == 0) continue;
    const Long6 bend = longer(part.bend[side]);
    for (int i = 0; i < 6; ++i) h.m[i][i] += bend.v[i];
  }
}

/// Updates the multipliers of a part from the solution dxA, dxB of the tree, of which the bodies take
/// `share`.
template <class P, int kSides>
RUBBLE_HD void takeTreeForces(const TreePart<kSides>& part, PartRows<P>& own, const Long6& dxA,
                              const Long6& dxB, double share) {
  const auto take = [&](Real& lambda, double force, double size, Real bound) {
    if (size > static_cast<double>(bound)) force *= static_cast<double>(bound) / size;
    lambda = static_cast<Real>(static_cast<double>(lambda) + share * (force - static_cast<double>(lambda)));
  };
  const auto forceOf = [&](const TreeRow<kSides>& row) {
    const double force = row.force + row.hessian * (dot(longer(row.j[0]), dxA) + dot(longer(row.j[1]), dxB));
    // a limit that would pull is released: the next solve omits it
    return row.take == TreeTake::UpperLimit   ? max(force, 0.0)
           : row.take == TreeTake::LowerLimit ? min(force, 0.0)
                                              : force;
  };
  if constexpr (P::kAxis) {
    for (int k = 0; k < part.count; ++k) {
      const TreeRow<kSides>& row = part.row[k];
      if (row.take == TreeTake::Nothing) continue;
      AxisRow& to = row.take == TreeTake::Drive ? own.drive : own.limit;
      const double force = forceOf(row);
      take(to.lambda, force, std::fabs(force), to.bound);
    }
  } else {
    if (part.count == 0 || part.row[0].take != TreeTake::Held) return;
    double force[P::kRows], size2 = 0;
    for (int i = 0; i < P::kRows; ++i) {
      force[i] = forceOf(part.row[i]);
      size2 += force[i] * force[i];
    }
    for (int i = 0; i < P::kRows; ++i) take(own.lambda[i], force[i], std::sqrt(size2), own.state.bound);
  }
}

}  // namespace rubble::RUBBLE_CORE
