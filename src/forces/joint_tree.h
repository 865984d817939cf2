#pragma once
/// The rows of a joint as the block of a whole tree of joints sees them (stages/trees/trees.h).
///
/// In a tree that is solved exactly a hard row has the stiffness kTreeStiffness m_row / dt^2 in place of its
/// own k, a row of finite stiffness its own compliance beside it, and its multiplier is that of the solution:
/// F + h J dx, the dual update [S 13] of a row so stiff. Limits are among them while they push; one that
/// would have to pull lets go. All other rows (friction, drives, forces cut at their bound) are as in the
/// block of a body.
#include "forces/joint.h"
#include "solver/dense6.h"

namespace rubble::RUBBLE_CORE {

/// Stiffness of hard rows in an exact tree over m_row / dt^2 [1]: what is left of it in a multiplier's error
/// after one solve of a chain of N links under R times their mass is about N R / kTreeStiffness; the
/// elimination, in double, keeps seven digits beside it.
inline constexpr double kTreeStiffness = 1e9;

/// Rows whose force is this near to their bound, as a share of it, are at it: a tree that held them would
/// move bodies by a force that they must not have. A margin, so that round-off does not decide.
inline constexpr Real kAtBound = Real(1e-4);

/// How a tree has its rows: with their own stiffness, solved exactly, or exactly once more, when limits that
/// it has come to still hold.
enum class TreeSolve { Own, Exact, Again };
/// A limit is reached within this share of L (of 1 rad): exact solves leave it off by round-off, on either
/// side, which must not decide.
inline constexpr Real kReached = Real(1e-5);

/// Whose multiplier the force of a row becomes.
enum class TreeTake { Nothing, Held, Limit, UpperLimit, LowerLimit, Drive };

/// A row of a joint as its tree has it: the force F and stiffness h at the present poses.
template <int kSides> struct TreeRow {
  double force, hessian;
  Vec6 j[kSides];  ///< dC/dx of the bodies of its first sides
  TreeTake take;
};
/// Rows of a part at most: those of three axes in space, or limit, drive and the rest of one coordinate.
inline constexpr int kMostTreeRows = 3;
/// The rows of a part that act: those of a group, or of an axis its limit, its drive, and what else acts on
/// it. Blocks are summed of these, and multipliers found: F + h J dx with h = kTreeStiffness m_row / dt^2 is
/// a small difference of large numbers, and has no correct digit unless both have the same bits of C and J.
template <int kSides> struct alignas(2 * sizeof(double)) TreePart {
  int count;
  Vec6 bend[kSides];  ///< column norms of the second derivatives by the forces of the rows' own stiffness
  TreeRow<kSides> row[kMostTreeRows];

  RUBBLE_HD void add(double force, double hessian, TreeTake take) {
    TreeRow<kSides>& next = row[count++];
    next.force = force, next.hessian = hessian, next.take = take;
  }
};
template <class F> struct TreeRows {
  TreePart<kSides<F>> part[F::Parts::kCount];
  Vec3 gap;  ///< of its anchors at the end of the step, beyond what it inherited [m]
};

/// A row with the stiffness of a tree, or its own compliance.
template <int kSides>
RUBBLE_HD void addSolvedRow(const StepConstants& c, TreePart<kSides>& out, Real start, Real compliance,
                            Real value, Real lambda, TreeTake take) {
  const double k = kTreeStiffness * static_cast<double>(start / c.startStiffness),
               s = 1 / (1 + k * static_cast<double>(compliance));
  out.add(s * (k * static_cast<double>(value) + static_cast<double>(lambda)), s * k, take);
}

/// Adds the rows of an axis at c; `own`: its force by its own stiffness.
template <int kSides>
RUBBLE_HD void addTreeAxis(const StepConstants& c, const AxisRows& rows, Real value, TreeSolve how,
                           TreePart<kSides>& out, Real& own) {
  own = 0;
  Real force = 0, hessian = 0;
  // 1: c is at the upper end, -1: at the lower one, 0: not known to be at one
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
  if (force != Real(0) || hessian > Real(0))
    out.add(static_cast<double>(force), static_cast<double>(hessian), TreeTake::Nothing);
}

/// Adds rows that are held together; `own`: their force by their own stiffness.
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

/// The rows of part I of a joint at the present poses.
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

/// Which sides of a joint are the neighbours that a body is coupled to when it is eliminated; -1: none.
struct TreeCoupling {
  int side[2];
};

/// Adds the rows of a joint to the block (h, f) of the body of a side (the lower triangle of h), and to its
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

/// The multipliers of a part after the tree has found that the bodies move by dxA, dxB, of which they make
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
    // a limit that would have to pull lets go: the next solve is without it
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
