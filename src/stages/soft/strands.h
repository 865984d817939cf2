#pragma once
/// Direct solve of strands: one more block of the same descent, whose unknowns are all vertices of a rope or
/// rod.
///
/// Sweeps propagate a correction by one vertex and converge slowly on long, stiff strands; clusters move
/// rigidly and do not bend. In a strand, springs connect each vertex only to the next, and bends reach to the
/// next but one. The Newton step [S 3] in the unknowns of all vertices is then one elimination of a banded
/// matrix, at the cost of a few sweeps. Strands share their rows, and so the objective of the descent, with
/// sweeps, clusters and aggregates.
///
/// Contacts, attachments and loads enter as in a vertex's own block. Several corners of a row may move here
/// without being coupled, so the bound of clusters.h holds: |c_i| instead of c_i^2. A row between two points
/// of one strand counts twice (coarse.h).
#include "stages/soft/clusters.h"

namespace rubble::RUBBLE_CORE {

template <class F> RUBBLE_HD int cornerOf(const F& element, int v) {
  int corner = 0;
  while (element.v[corner] != v) ++corner;
  return corner;
}

/// Adds an element to the block of a vertex and returns its Hessian there; 0 if `element` is null.
template <class F>
RUBBLE_HD Sym3 addLineElement(const SolverData& s, const F* element, int v, Block3& block) {
  if (!element || !element->alive) return {};
  Vec3 x[F::kCorners];
  gatherCorners(s, *element, x);
  Block3 own;
  if constexpr (std::is_same_v<F, Spring>)
    element->accumulate(x, cornerOf(*element, v), element->converged(s.stepOfPoint(v), x), own);
  else
    element->accumulate(s.stepOfPoint(v), x, cornerOf(*element, v), own);
  block += own;
  return own.h;
}
/// Coupling of two vertices of a bend, equal in all axes.
RUBBLE_HD inline Real bendCoupling(const LineBend* bend, int a, int b) {
  return bend && bend->alive
             ? bend->stiffness * bend->weight[cornerOf(*bend, a)] * bend->weight[cornerOf(*bend, b)]
             : Real(0);
}

/// The rows of each vertex of a strand: its own block, and its couplings with the next two vertices.
template <bool surfaces> struct AssembleStrands {
  static constexpr const char* kStage = "strands";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const StrandVertex& at = s.strandVertex[k];
    const int v = at.v, last = s.strand[at.strand].end - 1;
    Block3 own, self;
    Sym3 next;
    Real afterNext = 0;
    if (isDynamicVertex(s, v)) {
      addFromOutside<surfaces>(s, v, 0, 1, kNoLevel, own, self);
      own += {2 * self.h, self.f};
      const LineBend* const bend = bendAt(s, k);
      addLineElement(s, bend, v, own);
      if (k > s.strand[at.strand].begin) {
        addLineElement(s, springAfter(s, k - 1), v, own);
        addLineElement(s, bendAt(s, k - 1), v, own);
      }
      if (k < last) {
        const int w = s.strandVertex[k + 1].v;
        const LineBend* const nextBend = bendAt(s, k + 1);
        const Sym3 spring = addLineElement(s, springAfter(s, k), v, own);
        addLineElement(s, nextBend, v, own);
        if (isDynamicVertex(s, w)) {
          const Real both = bendCoupling(bend, v, w) + bendCoupling(nextBend, v, w);
          next = {both - spring.xx, -spring.xy, -spring.xz, both - spring.yy, -spring.yz, both - spring.zz};
        }
        if (k + 1 < last && isDynamicVertex(s, s.strandVertex[k + 2].v))
          afterNext = bendCoupling(nextBend, v, s.strandVertex[k + 2].v);
      }
    } else {
      own.addDiagonal(1);
    }
    write(s.strandWork[k], own, next, afterNext);
  }

  RUBBLE_HD static const Spring* springAfter(const SolverData& s, int k) {
    return s.elementsOf<Spring>() + s.strandVertex[k].spring;
  }
  /// The bend whose middle is vertex k.
  RUBBLE_HD static const LineBend* bendAt(const SolverData& s, int k) {
    return s.strandVertex[k].bend >= 0 ? s.elementsOf<LineBend>() + s.strandVertex[k].bend : nullptr;
  }
  RUBBLE_HD static void write(StrandWork& w, const Block3& own, const Sym3& next, Real afterNext) {
    for (int i = 0; i < 3; ++i) {
      const Vec3 o = own.h.column(i), n = next.column(i);
      for (int d = 0; i + d < 3; ++d) w.row[i][d] = static_cast<double>(o[i + d]);
      for (int j = 0; j < 3; ++j) w.row[i][3 + j - i] = static_cast<double>(n[j]);
      for (int d = 6 - i; d < kStrandBand; ++d) w.row[i][d] = 0;
      w.row[i][kStrandBand] = static_cast<double>(afterNext);
      w.x[i] = static_cast<double>(own.f[i]);
    }
  }
};

/// The scalar rows of a strand as a banded matrix L D L^T, and its unknowns.
struct StrandRows {
  StrandWork* work;
  int count;
  RUBBLE_HD StrandRows(StrandWork* rows, int all) : work(rows), count(all) {}
  RUBBLE_HD StrandRows(const SolverData& s, const Strand& strand)
      : StrandRows(s.strandWork + strand.begin, 3 * (strand.end - strand.begin)) {}
  /// Element (j, j + d).
  RUBBLE_HD double& at(int j, int d) const { return work[j / 3].row[j % 3][d]; }
  RUBBLE_HD double& x(int j) const { return work[j / 3].x[j % 3]; }
  RUBBLE_HD static Vec3 stepOf(const StrandWork& w) {
    return {static_cast<Real>(w.x[0]), static_cast<Real>(w.x[1]), static_cast<Real>(w.x[2])};
  }
  /// Number of rows after row j that it is coupled with.
  RUBBLE_HD int reach(int j) const { return min(kStrandBand, count - 1 - j); }
};

/// Largest relative motion of neighbors per step, over the distance of vertices [1]. Beyond it the linearized
/// directions are no longer valid.
inline constexpr Real kMaxStrandRotation = Real(.5);
inline constexpr Real kNoStrandRotation = Real(1e30);
/// Relative motion of a vertex and the previous one, over that limit [1]; kNoStrandRotation if it is not
/// finite.
RUBBLE_HD inline Real strandRotation(const StrandRows& rows, int k, Real reach) {
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    const double d = rows.work[k].x[i] - rows.work[k - 1].x[i];
    square += d * d;
  }
  const double turn = std::sqrt(square) / static_cast<double>(kMaxStrandRotation * reach);
  return turn < static_cast<double>(kNoStrandRotation) ? static_cast<Real>(turn) : kNoStrandRotation;
}
/// Share of its step that a strand takes [1].
RUBBLE_HD inline Real strandShare(Real turn) {
  return turn < kNoStrandRotation ? 1 / max(Real(1), turn) : Real(0);
}

/// The step of a strand: banded factorization and substitution.
struct SolveStrand {
  static constexpr const char* kStage = "strands";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Strand& strand = s.strand[i];
    const StrandRows rows(s, strand);
    for (int j = 0; j < rows.count; ++j) {
      const double inverse = 1 / rows.at(j, 0), x = rows.x(j);
      double scaled[kStrandBand + 1];
      const int reach = rows.reach(j);
      for (int a = 1; a <= reach; ++a) scaled[a] = rows.at(j, a) * inverse;
      for (int a = 1; a <= reach; ++a) {
        for (int b = a; b <= reach; ++b) rows.at(j + a, b - a) -= scaled[a] * rows.at(j, b);
        rows.x(j + a) -= scaled[a] * x;
      }
      for (int a = 1; a <= reach; ++a) rows.at(j, a) = scaled[a];
      rows.x(j) = x * inverse;
    }
    for (int j = rows.count - 1; j > 0; --j)
      for (int a = 1; a <= min(kStrandBand, j); ++a) rows.x(j - a) -= rows.at(j - a, a) * rows.x(j);
    Real turn = 0;
    for (int k = strand.begin + 1; k < strand.end; ++k)
      turn = max(turn, strandRotation(rows, k - strand.begin, s.vertexParams[s.strandVertex[k].v].length));
    s.strandShare[i] = strandShare(turn);
  }
};

/// Updates the multipliers of the springs whose rows the strand has solved.
struct TakeStrandForces {
  static constexpr const char* kStage = "strands";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const StrandVertex& at = s.strandVertex[k];
    const Real share = s.strandShare[at.strand];
    if (at.spring < 0 || !s.step->compliantRows || !(share > Real(0))) return;
    Spring& spring = s.elementsOf<Spring>()[at.spring];
    Vec3 x[Spring::kCorners];
    gatherCorners(s, spring, x);
    const Vec3 d = x[0] - x[1],
               step = StrandRows::stepOf(s.strandWork[k]) - StrandRows::stepOf(s.strandWork[k + 1]);
    const Real l = length(d);
    if (!spring.alive || !(l > Real(0))) return;
    const Real sign = spring.v[0] == at.v ? Real(1) : Real(-1);
    const Real solved = spring.row.stiffness * (spring.error(x) + sign * dot(d, step) / l);
    spring.lambda += share * (solved - spring.lambda);
  }
};

struct MoveStrands {
  static constexpr const char* kStage = "strands";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const StrandVertex& at = s.strandVertex[k];
    const Real share = s.strandShare[at.strand];
    if (!isDynamicVertex(s, at.v) || !(share > Real(0))) return;
    const Vec3 move = share * StrandRows::stepOf(s.strandWork[k]);
    s.vertexMoved[at.v] += move;
    s.vertexPlace[at.v] += move;
  }
};

}  // namespace rubble::RUBBLE_CORE
