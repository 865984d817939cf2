#pragma once
/// Direct solve of columns: one more block of the same descent, whose unknowns are bodies stacked on one
/// another.
///
/// A body-by-body sweep propagates a correction by one body, and aggregates move rigidly, while a tall column
/// is compressed and sways. Even an exact solve corrects little of the slowest mode of N bodies in an
/// iteration, because contacts in series are soft: a share of 1 / N if it compresses them, and of 1 / N^2 if
/// it bends them. So their stiffness is (N / kStiffColumn)^2 times that of other contacts (columnGain). What
/// sweeps could not follow is solved directly: bodies touch their neighbors only, so the Hessian is block
/// tridiagonal.
///
/// Columns share their rows, and so the objective of the descent, with sweeps and aggregates. A contact
/// between bodies of two columns is not coupled in this block; its Hessian counts twice (coarse.h).
#include "stages/bodies/incidence.h"

namespace rubble::RUBBLE_CORE {

/// Does a contact touch, or stop an approach in this step?
RUBBLE_HD inline bool touches(const SolverData& s, std::uint32_t code) {
  return s.joinLevel[constraintIndex(code)] != kNoTouch;
}

/// Finds the touching contacts of bodies that touch at most two others.
struct FindColumnLinks {
  static constexpr const char* kStage = "columns";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    ColumnLinks links{{-1, -1}, {kNoLink, kNoLink}, 0};
    links.member = find(s, i, links);
    s.columnLinks[i] = links;
    s.columnCount[i] = s.columnLength[i] = 0;
  }
  RUBBLE_HD static bool find(const SolverData& s, int i, ColumnLinks& links) {
    const int begin = s.incidenceOffset[i], end = s.incidenceOffset[i + 1];
    // incidences are sorted by type, contacts first
    if (begin == end || !isDynamic(s, i) || s.target[i].locks != 0 ||
        constraintType(s.incidence[end - 1].code) != kContactType)
      return false;
    int touching = 0, count = 0;
    for (int k = begin; k < end; ++k) {
      const Incidence& incidence = s.incidence[k];
      if (!touches(s, incidence.code)) continue;
      if (++touching > 2) return false;
      if (incidence.other < 0) continue;
      if (incidence.other == links.other[0]) return false;
      links.other[count] = incidence.other, links.code[count] = incidence.code;
      ++count;
    }
    return true;
  }
};

/// A way along a column.
struct ColumnWalk {
  int body, side;  ///< `side`: of the link by which it goes on
  /// The next body, -1 at the end of the column.
  RUBBLE_HD int next(const SolverData& s) const {
    const int to = s.columnLinks[body].other[side];
    return to >= 0 && s.columnLinks[to].member ? to : -1;
  }
  RUBBLE_HD bool step(const SolverData& s) {
    const int to = next(s);
    if (to < 0) return false;
    *this = {to, s.columnLinks[to].other[0] == body ? 1 : 0};
    return true;
  }
};

/// Counts the bodies of a column at its end of lower id.
struct MeasureColumns {
  static constexpr const char* kStage = "columns";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!s.columnLinks[i].member) return;
    const bool first = ColumnWalk{i, 0}.next(s) >= 0;
    if (first == (ColumnWalk{i, 1}.next(s) >= 0)) return;
    ColumnWalk walk{i, first ? 0 : 1};
    int length = 1;
    while (walk.step(s)) ++length;
    if (length > kStiffColumn && s.idOf[i] < s.idOf[walk.body]) s.columnCount[i] = length;
  }
};

struct FillColumns {
  static constexpr const char* kStage = "columns";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int length = s.columnCount[i];
    if (length == 0) return;
    ColumnWalk walk{i, ColumnWalk{i, 0}.next(s) >= 0 ? 0 : 1};
    const int begin = s.columnOffset[i];
    for (int n = begin; n < begin + length; ++n, walk.step(s)) {
      const ColumnLinks& links = s.columnLinks[walk.body];
      const bool last = n + 1 == begin + length;
      s.columnNode[n] = {walk.body, begin, begin + length, n == begin ? kNoLink : links.code[1 - walk.side],
                         last ? kNoLink : links.code[walk.side]};
      s.columnLength[walk.body] = length;
    }
  }
};

/// Does its column move a body? Its contacts are as stiff as those of a column if it belonged to one in the
/// last step.
RUBBLE_HD inline bool movesInColumn(const SolverData& s, int body) {
  return s.columnLength[body] != 0 && columnBefore(s, body) != 0;
}

/// Rows of a point in the Hessian: along the normal, along both tangents, and what the friction cone adds.
inline constexpr int kLinkRows = 4;
/// visit(row, own, other, force, k) for the rows of a point of a contact: Jacobians of the body of the
/// incidence and of the other one, force, and stiffness in the Hessian. The signs of both Jacobians are those
/// of the former body.
template <class Visit>
RUBBLE_HD void visitLinkRows(const SolverData& s, std::uint32_t code, int point, Visit&& visit) {
  const ContactRows& r = s.contact[constraintIndex(code)];
  const bool onA = constraintSide(code) == 0;
  const ContactFrame<Real> f = contactFrame<Real>(r, point);
  const ContactForces<Real> o = contactForces(s.plan.coneHessian, f, s.dx[r.a], s.dx[r.b]);
  const Vec3 &own = onA ? f.rA : f.rB, &other = onA ? f.rB : f.rA, e = o.t.e1 * f.t1 + o.t.e2 * f.t2;
  const Real sign = onA ? Real(-1) : Real(1);
  const auto row = [&](int number, const Vec3& axis, Real force, Real k) {
    if (force == Real(0) && k == Real(0)) return;
    visit(number, Vec6{axis, cross(own, axis)}, Vec6{axis, cross(other, axis)}, sign * force, k);
  };
  row(0, f.n, o.fN, f.load.w);
  row(1, f.t1, o.t.f1, o.t.across);
  row(2, f.t2, o.t.f2, o.t.across);
  row(3, e, Real(0), o.t.excess);
}
/// The contact of a node with the previous (`way` -1) or the next one (1), if the column moves both.
RUBBLE_HD inline std::uint32_t linkTo(const SolverData& s, int n, int way) {
  const std::uint32_t code = way < 0 ? s.columnNode[n].previous : s.columnNode[n].next;
  return code != kNoLink && movesInColumn(s, s.columnNode[n + way].body) ? code : kNoLink;
}
/// Adds to the block of a body that its column moves all but the contacts with such neighbors (linkTo()).
template <class L> RUBBLE_HD void addOtherRows(const SolverData& s, const ColumnNode& node, ColumnWork& w) {
  Block6 block;
  PointSums<L> points;
  startBlock(s, node.body, block);
  for (int k = s.incidenceOffset[node.body]; k < s.incidenceOffset[node.body + 1]; ++k) {
    const Incidence& incidence = s.incidence[k];
    // a contact between bodies of columns counts twice (coarse.h)
    const bool within = incidence.other >= 0 && movesInColumn(s, incidence.other);
    const Real weight = within ? Real(2) : Real(1);
    if (s.rolls) addRolling(s, incidence.code, block, weight);
    if (!within || (incidence.code != node.previous && incidence.code != node.next))
      points.add(s, incidence.code, weight);
  }
  points.addTo(block);
  addBlock(w.h, w.x, block);
}

/// The block of each body of a column, and its coupling with the next one.
template <class L> struct AssembleColumns {
  static constexpr const char* kStage = "columns";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const ColumnNode node = s.columnNode[n];
    ColumnWork& w = s.columnWork[n];
    clear(w.h), clear(w.e), clear(w.x);
    if (!movesInColumn(s, node.body)) {
      for (int k = 0; k < 6; ++k) w.h.m[k][k] = 1;
      return;
    }
    for (int way = -1; way <= 1; way += 2) {
      const std::uint32_t code = linkTo(s, n, way);
      for (int point = 0; code != kNoLink && point < kLanes; ++point)
        visitLinkRows(s, code, point, [&](int, const Vec6& ownRow, const Vec6& otherRow, Real force, Real k) {
          const Long6 own = longer(ownRow);
          addSquare(w.h, own, static_cast<double>(k));
          if (way > 0) addOuter(w.e, own, longer(otherRow), -static_cast<double>(k));
          for (int j = 0; j < 6; ++j) w.x.v[j] += static_cast<double>(force) * own.v[j];
        });
    }
    addOtherRows<L>(s, node, w);
  }
};

/// Solves a column from one end to the other, and moves its bodies. One thread per column.
struct SolveColumns {
  static constexpr const char* kStage = "columns";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const int begin = s.columnNode[n].begin, end = s.columnNode[n].end;
    if (begin != n) return;
    Dense6 e;
    for (int k = begin; k < end; ++k) {
      ColumnWork& w = s.columnWork[k];
      if (k > begin) {
        subtractProduct(w.h, e, s.columnWork[k - 1].e);
        subtractProduct(w.x, e, s.columnWork[k - 1].x);
      }
      e = w.e;
      factor(w.h);
      solveFactored(w.h, w.x);
      solveFactored(w.h, w.e);
    }
    Real turn = 0;
    for (int k = end - 1; k >= begin; --k) {
      ColumnWork& w = s.columnWork[k];
      if (k + 1 < end)
        for (int i = 0; i < 6; ++i)
          for (int j = 0; j < 6; ++j) w.x.v[i] -= w.e.m[i][j] * s.columnWork[k + 1].x.v[j];
      const Vec6 dx = shorter(w.x, 1);
      if (!isFinite(dx.lin) || !isFinite(dx.ang)) return;
      turn = max(turn, length(dx.ang));
    }
    for (int k = begin; k < end; ++k) move(s, k, shareOf(turn));
  }
  /// Share of a Newton step whose largest rotation is `turn` [1].
  RUBBLE_HD static double shareOf(Real turn) {
    return turn > kLargestRotation ? static_cast<double>(kLargestRotation / turn) : 1;
  }
  RUBBLE_HD static void move(const SolverData& s, int n, double share) {
    const int i = s.columnNode[n].body;
    if (!movesInColumn(s, i)) return;
    const Pose x = retract({s.dx[i].dp, s.dq[i]}, shorter(s.columnWork[n].x, share));
    s.dq[i] = x.q;
    s.dx[i] = {x.p, 0, logRotation(x.q), 0};
  }
};

}  // namespace rubble::RUBBLE_CORE
