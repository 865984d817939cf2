#pragma once
/// Begin and end of the step of vertices and their elements, and the primal update of a vertex.
#include "forces/plasticity.h"
#include "stages/joints/joints.h"

namespace rubble::RUBBLE_CORE {

/// Positions of vertices at x^t relative to the first vertex of their object.
struct PlaceVertices {
  static constexpr const char* kStage = "elements";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    s.vertexPlace[v] = Vec3(s.vertexPosition[v] - s.vertexPosition[s.vertexParams[v].first]);
  }
};

/// visit(attachment) for the attachments of a vertex, which are last in its list.
template <class Visit> RUBBLE_HD void visitAttachments(const SolverData& s, int v, Visit&& visit) {
  for (int k = s.refOffset[v + 1] - 1; k >= s.refOffset[v] && pointType(s.ref[k]) == kAttachmentCode; --k)
    visit(s.attachment[pointIndex(s.ref[k])]);
}

template <class F>
RUBBLE_HD void gatherCorners(const SolverData& s, const F& element, Vec3 (&x)[F::kCorners]) {
  for (int k = 0; k < F::kCorners; ++k) x[k] = load(s.vertexPlace[element.v[k]]);
}

/// Computes the quantities of an element at x^t.
template <class F> struct BeginElements {
  static constexpr const char* kStage = "elements";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    F& element = s.elementsOf<F>()[i];
    if (!element.alive) return;
    Vec3 x[F::kCorners];
    gatherCorners(s, element, x);
    element.begin(s.stepOfPoint(element.v[0]), x);
  }
};

/// Copies the quantities of tetrahedra at x^t to their corners in the lists of the vertices.
struct BeginTetraCorners {
  static constexpr const char* kStage = "elements";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    for (int k = s.tetraCornerOffset[v]; k < s.tetraCornerOffset[v + 1]; ++k) begin(s, k);
  }
  RUBBLE_HD static void begin(const SolverData& s, int k) {
    TetraCorner& corner = s.tetraCorner[k];
    s.cornerStart[k] = corner.damper > Real(0) ? s.elementsOf<Tetrahedron>()[corner.element].strainStart
                                               : Sym3{0, 0, 0, 0, 0, 0};
    if (s.yielding > 0) corner.takeShape(s.elementsOf<Tetrahedron>()[corner.element]);
  }
};

template <class F> struct UpdateElementDuals {
  static constexpr const char* kStage = "element dual";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    F& element = s.elementsOf<F>()[i];
    if (!element.alive) return;
    Vec3 x[F::kCorners];
    gatherCorners(s, element, x);
    element.updateDual(s.stepOfPoint(element.v[0]), x);
  }
};

/// Removes elements whose load exceeds their strength.
template <class F> struct FinishElements {
  static constexpr const char* kStage = "element end";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    F& element = s.elementsOf<F>()[i];
    if (!element.alive) return;
    Vec3 x[F::kCorners];
    gatherCorners(s, element, x);
    if (!element.finish(s.stepOfPoint(element.v[0]), x)) return;
    element.alive = 0;
    atomicCount(&s.counters->broken, 1);
  }
};

/// Plastic flow of tetrahedra by their stress at the end of the step.
struct FlowTetrahedra {
  static constexpr const char* kStage = "element end";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Tetrahedron& element = s.elementsOf<Tetrahedron>()[i];
    Vec3 x[Tetrahedron::kCorners];
    gatherCorners(s, element, x);
    flow(element, x);
  }
};

struct UpdateAttachmentDuals {
  static constexpr const char* kStage = "element dual";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Attachment& a = s.attachment[i];
    if (active(s, a)) a.updateDual(bodyMove(s, a), movedSum(s, a));
  }
};
struct FinishAttachments {
  static constexpr const char* kStage = "element end";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Attachment& a = s.attachment[i];
    if (active(s, a) && a.finish()) atomicCount(&s.counters->broken, 1);
  }
};

/// Is the vertex a corner of tetrahedra?
RUBBLE_HD inline bool inSolid(const SolverData& s, int v) {
  return s.tetraCornerOffset[v] != s.tetraCornerOffset[v + 1];
}

/// Inertial target y [S 2] and initial guess of every vertex.
struct PredictVertices {
  static constexpr const char* kStage = "predict";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    const StepConstants& c = s.stepOfPoint(v);
    const VertexParams& p = s.vertexParams[v];
    if (p.kind != VertexKind::Dynamic) {
      s.vertexTarget[v] = s.vertexMoved[v] = {0, 0, 0};
      return;
    }
    const Vec3 velocity = s.vertexVelocity[v];
    const Vec3 acceleration = p.gravityScale * c.gravity + s.vertexForce[v] / p.mass;
    s.vertexTarget[v] = inertialDisplacement(velocity, acceleration, c.dt);
    // The guess for vertices of a solid is their velocity alone. Loads enter through the local problems,
    // where a few sweeps leave the same part of the load and of its elastic reaction undone. A load in the
    // guess would act in full and do work that no element absorbs.
    const Real share = inSolid(s, v) ? Real(0)
                                     : followedShare(velocity, s.vertexOldVelocity[v], acceleration, c.dt);
    Vec3 guess = inertialDisplacement(velocity, share * acceleration, c.dt);
    if (p.cluster >= 0) {
      // The guess deviates from the rigid motion of the object by at most one edge length. Beyond, the
      // elastic energy of the distorted elements would exceed what a few sweeps can reduce.
      const Vec3 rigid = inertialDisplacement(s.clusterMotion[p.cluster].velocity, share * acceleration,
                                              c.dt),
                 own = guess - rigid;
      const Real size = length(own);
      if (size > p.reach) guess = rigid + own * (p.reach / size);
    }
    s.vertexMoved[v] = guess;
    s.vertexPlace[v] += guess;
  }
};

/// Adds an element (other than a tetrahedron) or attachment to the block of a vertex.
RUBBLE_HD inline void addElement(const SolverData& s, std::uint32_t code, Block3& block) {
  const int type = pointType(code), index = pointIndex(code), corner = pointCorner(code);
  forEachType(ElementTypes{}, [&]<class F>() {
    if (std::is_same_v<F, Tetrahedron> || type != typeIndex<F>(ElementTypes{})) return;
    const F element = s.elementsOf<F>()[index];  // a copy: issues all loads at once
    if (!element.alive) return;
    Vec3 x[F::kCorners];
    gatherCorners(s, element, x);
    element.accumulate(s.stepOfPoint(element.v[0]), x, corner, block);
  });
  if (type != kAttachmentCode) return;
  const Attachment& a = s.attachment[index];
  if (active(s, a)) a.accumulateVertex(bodyMove(s, a), movedSum(s, a), corner, block);
}

/// Adds a tetrahedron of the list of a vertex. `start`: its Green strain E^t at x^t.
RUBBLE_HD inline void addTetraCorner(const SolverData& s, const TetraCorner& corner, const Sym3& start,
                                     const Vec3& own, Block3& block) {
  Vec3 x[TetraCorner::kCorners] = {own, {}, {}, {}};
  for (int i = 0; i < 3; ++i) x[i + 1] = load(s.vertexPlace[corner.other[i]]);
  corner.accumulate(*s.step, x, start, 0, block);
}

/// Initial multiplier of an attachment. A compliant attachment starts with its own load K C. A hard one
/// starts with the force that holds its vertices against their elements, sum c_i f_i / sum c_i^2. A
/// pre-stretched object therefore pulls from the first step on.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Vec3 newLoad(const SolverData& s, const Attachment& a, const Vec3& gap) {
  if (a.compliance > Real(0)) return gap / a.compliance;
  Vec3 force{0, 0, 0};
  Real weight = 0;
  for (int k = 0; k < kPointCorners && a.v[k] >= 0; ++k) {
    const int v = a.v[k];
    Block3 block;
    for (int i = s.tetraCornerOffset[v]; i < s.tetraCornerOffset[v + 1]; ++i)
      addTetraCorner(s, s.tetraCorner[i], s.cornerStart[i], s.vertexPlace[v], block);
    for (int i = s.refOffset[v]; i < s.refOffset[v + 1] && pointType(s.ref[i]) != kAttachmentCode; ++i)
      addElement(s, s.ref[i], block);
    force += a.weight[k] * block.f;
    weight += a.weight[k] * a.weight[k];
  }
  return weight > Real(0) && isFinite(force) ? force / weight : Vec3{0, 0, 0};
}

struct BeginAttachments {
  static constexpr const char* kStage = "elements";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Attachment& a = s.attachment[i];
    if (!active(s, a)) return;
    // relative to the first vertex, in double: weights may add up to -1, or to 0 in a vertex-vertex
    // attachment
    const Vec3d origin = s.vertexPosition[a.v[0]];
    Vec3 gap{0, 0, 0}, lever{0, 0, 0};
    for (int k = 0; k < kPointCorners && a.v[k] >= 0; ++k)
      gap += a.weight[k] * Vec3(s.vertexPosition[a.v[k]] - origin);
    Real bodyMass = 0;
    if (a.isVertexVertex == 0) {
      if (a.body == kWorldBody) {
        gap += Vec3(a.worldPoint - origin);
      } else {
        lever = rotate(s.orientation[a.body], a.anchor);
        gap += Vec3(s.position[a.body] - origin) + lever;
        bodyMass = s.params[a.body].mass;
      }
    }
    a.begin(s.stepOfPoint(a.v[0]), gap, lever, bodyMass, a.isNew() ? newLoad(s, a, gap) : Vec3{0, 0, 0});
  }
};
/// `whole`: read the contact with vector loads, which takes more registers.
template <bool whole = false>
RUBBLE_HD inline void addPointContact(const SolverData& s, std::uint32_t code, Block3& block) {
  const auto add = [&](const PointContact& p) {
    p.accumulateVertex(*s.step, s.plan.coneHessian, pointDisplacement(s, p), pointCorner(code), block);
  };
  if constexpr (whole)
    add(loadVectorized(s.pointContact[pointIndex(code)]));
  else
    add(s.pointContact[pointIndex(code)]);
}

/// Is a motion finite, and its length too? A vertex with another one does not move.
RUBBLE_HD inline bool hasLength(const Vec3& moved) { return isFinite(lengthSquared(moved)); }

/// The inertial part of the local problem of a vertex.
RUBBLE_HD inline Block3 startVertexBlock(const SolverData& s, int v) {
  const Real m = s.vertexParams[v].mass * s.step->inverseDt * s.step->inverseDt;
  Block3 block;
  block.addDiagonal(m);
  block.f = m * (s.vertexTarget[v] - s.vertexMoved[v]);
  return block;
}

/// Solves the local problem of a vertex and applies its step. A step that is not finite is rejected.
RUBBLE_HD inline void finishVertexBlock(const SolverData& s, int v, const Block3& block) {
  const Vec3 dx = solve(block);
  if (!isFinite(dx)) {
    atomicCount(&s.counters->quarantined, 1);
    return;
  }
  s.vertexMoved[v] += dx;
  s.vertexPlace[v] += dx;
}

/// The primal update of one vertex: force [S 5] and Hessian [S 6] of its inertia, elements and contacts; one
/// Newton step [S 3].
struct SolveVertex {
  static constexpr const char* kStage = "primal";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    Block3 block = startVertexBlock(s, v);
    const Vec3 own = s.vertexPlace[v];
    for (int k = s.tetraCornerOffset[v]; k < s.tetraCornerOffset[v + 1]; ++k)
      addTetraCorner(s, s.tetraCorner[k], s.cornerStart[k], own, block);
    for (int k = s.refOffset[v]; k < s.refOffset[v + 1]; ++k) addElement(s, s.ref[k], block);
    for (int k = s.pointIncidenceOffset[v]; k < s.pointIncidenceOffset[v + 1]; ++k)
      addPointContact(s, s.pointIncidence[k], block);
    finishVertexBlock(s, v, block);
  }
};

}  // namespace rubble::RUBBLE_CORE
