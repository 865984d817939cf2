#pragma once
/// Contacts of vertices and edges. Broad phase: vertices against the grid of the bodies, granular particles
/// against a grid of their own, surfaces against that of features.h. Then rows, and the state kept for the
/// next step.
#include "collision/point_shape.h"
#include "stages/contacts/arcs.h"
#include "stages/soft/body_corners.h"

namespace rubble::RUBBLE_CORE {

/// Box of a vertex swept over the step, with the detection margin.
RUBBLE_HD inline SweptBox vertexBounds(const SolverData& s, int v) {
  const VertexParams& p = s.vertexParams[v];
  const Vec3 sweep = (s.step->dt / 2) * s.vertexVelocity[v], x(s.vertexPosition[v]);
  const Real roundOff = Real(2.4e-7) * (std::fabs(x.x) + std::fabs(x.y) + std::fabs(x.z));
  const Real grow = p.radius + s.step->contactMargin * p.length + fallInStep(s.stepOfPoint(v)) + roundOff;
  return {x + sweep, abs(sweep) + Vec3{grow, grow, grow}};
}

RUBBLE_HD inline bool isParticle(const SolverData& s, int v) {
  return s.vertexParams[v].kind != VertexKind::Removed &&
         (s.vertexParams[v].collides & kCollidesWithParticles) != 0 && !isPausedPoint(s, v);
}
RUBBLE_HD inline BoxEntry placeParticle(const SolverData& s, int v, int& bucket) {
  return particleGrid(s).place(s.worldOfPoint(v), kParticleKind, vertexBounds(s, v), v, bucket);
}

struct CountParticles {
  static constexpr const char* kStage = "grid";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    if (!isParticle(s, v)) return;
    int bucket;
    noteBox(s, placeParticle(s, v, bucket));
    atomicCount(&s.particleCount[bucket], 1);
  }
};

/// In no fixed order; pairs are sorted later.
struct FillParticles {
  static constexpr const char* kStage = "grid";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    if (!isParticle(s, v)) return;
    int bucket;
    const BoxEntry e = placeParticle(s, v, bucket);
    s.particle[s.particleOffset[bucket] + atomicCount(&s.particleCount[bucket], -1) - 1] = e;
  }
};

/// found(body) for the bodies whose boxes touch that of a vertex.
template <class Found>
RUBBLE_HD void searchBodies(const SolverData& s, int v, const SweptBox& box, Found&& found, int lane,
                            int lanes) {
  // largest number of cells of a search; beyond, scanning all bodies is cheaper
  constexpr Real kMostCells = 512;
  const int world = s.worldOfPoint(v);
  const auto scan = [&](int body, const Bounds& b) {
    if (meets(box, b.center, b.half) && mayTouch(s, v, body)) found(body);
  };
  const bool scanned = scanWorld(s, world, scan, lane, lanes, kScannedByVertices);
  for (int level = 0; !scanned && level < kGridLevels; ++level) {
    const int layer = layerOf(world, level);
    const auto look = [&](const GridEntry& e) {
      if (e.layer == layer && meets(box, e.center, e.half) && mayTouch(s, v, e.body)) found(e.body);
    };
    if (visitListed(s, layer, look, lane, lanes)) continue;
    Vec3 reach;
    for (int k = 0; k < 3; ++k) reach[k] = box.half[k] + fromFloatBits(s.counters->levelHalf[level][k]);
    const Real size = cellSize(level);
    const bool done = forEachCell(box.center, reach, size, kMostCells, lane, lanes, [&](int x, int y, int z) {
      const int bucket = bucketOf(s, layer, x, y, z);
      for (int k = s.bucketOffset[bucket]; k < s.bucketOffset[bucket + 1]; ++k) {
        // another cell may share the bucket
        const GridEntry& e = s.grid[k];
        if (cellOf(e.center.x, size) == x && cellOf(e.center.y, size) == y && cellOf(e.center.z, size) == z)
          look(e);
      }
    });
    for (int k = lane; !done && k < s.bucketOffset[s.cells]; k += lanes) look(s.grid[k]);
  }
  const auto foundPlane = [&](int plane) {
    if (mayTouch(s, v, plane)) found(plane);
  };
  searchPlanes(s, world, box, foundPlane, lane, lanes);
}

/// found(other) for every partner in the pairs that a vertex, an edge or a corner of a body owns; share of
/// worker `lane` of `lanes`. A partner may be found several times.
template <class Found>
RUBBLE_HD void searchPoint(const SolverData& s, int owner, Found&& found, int lane = 0, int lanes = 1) {
  if (owner >= s.vertices + s.edges) return searchCorners(s, owner, found, lane, lanes);
  if (s.features > 0) searchFeatures(s, owner, found, lane, lanes);
  if (owner >= s.vertices) return;
  const int v = owner;
  const VertexParams& p = s.vertexParams[v];
  if (p.kind == VertexKind::Removed || isPausedPoint(s, v)) return;
  const SweptBox box = vertexBounds(s, v);
  if (p.collides & kCollidesWithBodies) searchBodies(s, v, box, found, lane, lanes);
  if (!(p.collides & kCollidesWithParticles)) return;
  const auto look = [&](int other) {
    if (other <= v) return;
    // vertices of one object with elements do not collide: they overlap at rest
    if (p.cluster >= 0 && p.cluster == s.vertexParams[other].cluster) return;
    // vertices of two surfaces do not collide; their triangles and edges do
    if (p.cluster >= 0 && s.vertexParams[other].cluster >= 0 &&
        (p.collides & s.vertexParams[other].collides & kCollidesWithSurfaces))
      return;
    if (isDynamicVertex(s, v) || isDynamicVertex(s, other)) found(kVertexNode + other);
  };
  seekBoxes(s, particleGrid(s), s.worldOfPoint(v), kParticleKind, box, look, lane, lanes);
}

/// The partners of an owner: each once, if they are few and found a few times. Otherwise all finds count,
/// which are as many in every order of the search.
struct PartnerList {
  int* slots;
  int stored = 0, finds = 0;
  bool isWhole = true;
  RUBBLE_HD void add(int other) {
    isWhole = isWhole && finds < kPointPairFinds;
    ++finds;
    if (isWhole) store(other);
  }
  RUBBLE_HD int count() const { return isWhole ? stored : finds; }

 private:
  RUBBLE_HD void store(int other) {
    for (int k = 0; k < stored; ++k)
      if (slots[k] == other) return;
    isWhole = stored < kPointPairSlots;
    if (isWhole) slots[stored++] = other;
  }
};

/// Finds the partners of each owner.
struct FindPointPairs {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int owner) const {
    PartnerList list{s.pointPairSlot + owner * kPointPairSlots};
    searchPoint(s, owner, [&](int other) { list.add(other); });
    finish(s, owner, list);
  }
  RUBBLE_HD static void finish(const SolverData& s, int owner, const PartnerList& list) {
    const bool drops = s.features > 0 && list.isWhole;
    const int parts = drops ? dropSides(s, owner, list.stored, list.slots, 1) : list.count();
    s.pointPairCount[owner] = parts > 0 ? parts * rowsWithPart(s, owner) : 0;
  }
};

/// Pairs sorted by owner, then by partner. Empty pairs (other = -1) follow for partners that were counted
/// several times.
struct WritePointPairs {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int owner) const {
    const int begin = s.pointPairOffset[owner], end = s.pointPairOffset[owner + 1];
    if (begin == end) return;
    const int rows = rowsWithPart(s, owner), count = (end - begin) / rows;
    int n = begin;
    const auto insert = [&](int other) {
      int place = n;
      while (place > begin && s.pointPair[place - 1].other > other) --place;
      if (place > begin && s.pointPair[place - 1].other == other) return;
      for (int k = n++; k > place; --k) s.pointPair[k] = s.pointPair[k - 1];
      s.pointPair[place] = {owner, other};
    };
    if (count <= kPointPairSlots) {
      for (int k = 0; k < count; ++k) insert(s.pointPairSlot[owner * kPointPairSlots + k]);
    } else {
      searchPoint(s, owner, insert);
      static_assert(sizeof(PointPair) == 2 * sizeof(int));
      if (s.features > 0) n = begin + dropSides(s, owner, n - begin, &s.pointPair[begin].other, 2);
    }
    if (rows == 2) {
      const int parts = n - begin;
      for (int k = parts - 1; k >= 0; --k)
        s.pointPair[begin + 2 * k + 1] = s.pointPair[begin + 2 * k] = s.pointPair[begin + k];
      n += parts;
    }
    for (; n < end; ++n) s.pointPair[n] = {owner, -1};
  }
};

RUBBLE_HD inline Real lighter(Real a, Real b) { return a > Real(0) && b > Real(0) ? min(a, b) : max(a, b); }

/// Distance of a vertex from a body at x^t, world axes. Surfaces are searched up to `reach` from the vertex.
/// `side`: the contact normal of the previous step, or zero.
RUBBLE_HD inline PointDistance pointToBody(const SolverData& s, int v, int body, Real reach,
                                           const Vec3& side) {
  const Quat q = s.orientation[body];
  const ShapeData& shape = s.params[body].shape;
  const Vec3 x = rotateInverse(q, Vec3(s.vertexPosition[v] - s.position[body]));
  PointDistance at;
  if (isPrimitive(shape.kind))
    at = pointToPrimitive(shape, x);
  else
    at = pointToGeneralShape(
        s.shapeTables(), shape, x,
        {reach, max(reach, kHeldFromBelow * s.vertexParams[v].length), rotateInverse(q, side)});
  at.n = rotate(q, at.n);
  return at;
}

/// Displacement of the surface of the body in a step by surface velocity [m].
RUBBLE_HD inline Vec3 surfaceShiftOf(const SolverData& s, const PointContact& p) {
  if (s.surfaces == 0 || p.body < 0) return {0, 0, 0};
  return s.step->dt * rotate(s.orientation[p.body], surfaceOf(s, p.body, p.part).velocity);
}

/// A vertex (B) against a body (A) at x^t. Fills the geometry and returns the initial values.
RUBBLE_HD inline PointContactStart touchBody(const SolverData& s, int v, int body, const PointContact* old,
                                             PointContact& p, Real& gap, Real& margin) {
  const VertexParams& point = s.vertexParams[v];
  const BodyParams& b = s.params[body];
  const Vec3 x(s.vertexPosition[v] - s.position[body]);
  const Real width = b.kind == BodyKind::Dynamic ? min(point.length, 2 * b.radius) : point.length;
  const Vec3 relative = s.vertexVelocity[v] - s.velocity[body];
  margin = max(s.step->contactMargin * width,
               s.step->dt * (length(relative) + length(s.angularVelocity[body]) * length(x)));
  // an open mesh has two sides and no inside
  if (b.shape.kind == ShapeKind::Mesh) margin += fallInStep(s.stepOfPoint(v));
  const PointDistance at = pointToBody(s, v, body, point.radius + margin,
                                       old && old->active ? old->n : Vec3{0, 0, 0});
  gap = at.distance - point.radius;
  p.v[0] = v, p.v[1] = p.v[2] = p.v[3] = -1;
  p.weight[0] = -1;
  p.body = body;
  p.part = at.part;
  p.n = at.n;
  // at the middle of the gap
  p.lever = x - p.n * ((at.distance + point.radius) / 2);
  p.length = width;
  const Real restitution = setMaterial(s, p, surfaceOf(s, body, at.part), surfaceOf(point));
  const Real closing = -dot(p.n, relative) + dot(p.n, cross(s.angularVelocity[body], p.lever));
  return {lighter(point.mass, b.mass), -gap, closing, restitution};
}

/// Granular particles a (A) and b (B).
RUBBLE_HD inline PointContactStart touchParticle(const SolverData& s, int a, int b, PointContact& p,
                                                 Real& gap, Real& margin) {
  const VertexParams &pa = s.vertexParams[a], &pb = s.vertexParams[b];
  const Vec3 d(s.vertexPosition[b] - s.vertexPosition[a]);
  gap = length(d) - pa.radius - pb.radius;
  const Vec3 relative = s.vertexVelocity[a] - s.vertexVelocity[b];
  p.length = min(pa.length, pb.length);
  margin = max(s.step->contactMargin * p.length, s.step->dt * length(relative));
  p.v[0] = a, p.v[1] = b, p.v[2] = p.v[3] = -1;
  p.weight[0] = 1, p.weight[1] = -1;
  p.body = -1;
  p.n = normalize(d);
  return {lighter(pa.mass, pb.mass), -gap, dot(p.n, relative),
          setMaterial(s, p, surfaceOf(pa), surfaceOf(pb))};
}

/// Adds shares of what the body of a contact moves by beside its linear displacement to the errors of the
/// rows: by surface velocity, and on its arc. Rows correct only the share driftCorrection of a drift; these
/// displacements are to be corrected in full.
RUBBLE_HD inline void addShifts(const SolverData& s, PointContact& p, Real ofSurface, Real ofArc) {
  const bool arcs = p.body >= 0 && goesOnArcs(s, p.body);
  if (p.body < 0 || (s.surfaces == 0 && !arcs)) return;
  Vec3 t1, t2, shift{0, 0, 0};
  tangentBasis(p.n, t1, t2);
  if (s.surfaces > 0) shift = ofSurface * surfaceShiftOf(s, p);
  if (arcs) {
    const Vec3 arc = arcShift(s, p.body, p.part, p.lever, p.n);
    // the normal row ends with its step
    if (ofArc > Real(0)) p.c0 += dot(p.n, arc);
    shift += ofArc * arc;
  }
  p.drift1 += dot(t1, shift), p.drift2 += dot(t2, shift);
}

/// The contact of pair i in the previous step, or null.
RUBBLE_HD inline const PointContact* oldPointContactOf(const SolverData& s, int i) {
  const int owner = s.pointPair[i].vertex, row = rowOfPair(s.pointPair, i);
  for (int k = s.oldPointPairOffset[owner]; k < s.oldPointPairOffset[owner + 1]; ++k)
    if (s.oldPointPair[k].other == s.pointPair[i].other && rowOfPair(s.oldPointPair, k) == row)
      return &s.oldPointContact[k];
  return nullptr;
}
/// The contact that a corner of a body had before it slid to feature i, or null. The corner keeps its load;
/// otherwise it would fall freely for a step at each edge that it passes. New features inherit from the left
/// ones in order.
RUBBLE_HD inline const PointContact* contactLeftFor(const SolverData& s, int i) {
  const int owner = s.pointPair[i].vertex, begin = s.pointPairOffset[owner],
            end = s.pointPairOffset[owner + 1];
  int turn = 0;
  for (int k = begin; k < i; ++k) turn += s.pointPair[k].other >= 0 && !oldPointContactOf(s, k) ? 1 : 0;
  for (int k = s.oldPointPairOffset[owner]; k < s.oldPointPairOffset[owner + 1]; ++k) {
    const int part = s.oldPointPair[k].other;
    bool left = part >= 0 && s.oldPointContact[k].active;
    for (int j = begin; j < end && left; ++j) left = s.pointPair[j].other != part;
    if (left && turn-- == 0) return &s.oldPointContact[k];
  }
  return nullptr;
}

/// Does the vertex of a contact with a body pass its one-way surface?
RUBBLE_HD inline bool passesOneWay(const SolverData& s, const PointContact& p, const PointContact* old,
                                   Real gap, Real closing) {
  const OneWays ways{oneWayOf(s, p.body, p.part), {0, 0, 0}};
  if (!ways.any()) return false;
  const Real touch = kTouchGap * p.length;
  OneWayState state;
  state.touches = gap < touch;
  state.inFront = ways.hold(p.n);
  // at a normal in front a body that comes from behind moves away
  state.behind = gap < -touch && closing < Real(0);
  state.known = old != nullptr, state.passed = old && old->passes;
  return state.passes();
}

/// Rows of a pair at x^t, warm-started from those of the previous step.
struct UpdatePointContacts {
  static constexpr const char* kStage = "rows";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const PointPair pair = s.pointPair[i];
    PointContact p;
    memset(static_cast<void*>(&p), 0, sizeof p);  // padding too, because states are hashed
    Real gap, margin;
    if (pair.other < 0) {
      s.pointContact[i] = p;
      return;
    }
    const bool corner = pair.vertex >= s.vertices + s.edges;
    const PointContact* old = oldPointContactOf(s, i);
    if (!old && corner) old = contactLeftFor(s, i);
    const PointContactStart start = corner ? touchCorner(s, pair.vertex, pair.other,
                                                         rowOfPair(s.pointPair, i), p, gap, margin)
                                    : pair.other < kVertexNode
                                        ? touchBody(s, pair.vertex, pair.other, old, p, gap, margin)
                                    : pair.other < kCornerNode
                                        ? touchParticle(s, pair.vertex, pair.other - kVertexNode, p, gap,
                                                        margin)
                                        : touchFeature(s, pair.vertex, pair.other, p, gap, margin);
    if (s.oneWay && p.body >= 0) p.passes = passesOneWay(s, p, old, gap, start.closing);
    p.active = gap <= margin && !p.passes;
    if (p.active) {
      beginPointContact(s.stepOfPoint(p.v[0]), p, start, old);
      const Real inFull = Real(1) / s.step->driftCorrection;
      addShifts(s, p, inFull, inFull);
      atomicCount(&s.counters->pointContacts, 1);
    }
    s.pointContact[i] = p;
  }
};

/// Deactivates contacts without load that stay open at the inertial targets: k = 0.
struct MarkInactivePoints {
  static constexpr const char* kStage = "inactive";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    PointContact& p = s.pointContact[i];
    if (!s.step->inactiveRows || !p.active || p.lambdaN != Real(0)) return;
    const bool surfaces = s.pointPair[i].other >= kCornerNode;
    Vec3 d{0, 0, 0};
    Real nearer[2] = {0, 0};
    for (int k = 0; k < kPointCorners && p.v[k] >= 0; ++k) {
      const Vec3 own = p.weight[k] * s.vertexTarget[p.v[k]];
      d += own;
      nearer[p.weight[k] > Real(0) ? 0 : 1] += dot(p.n, own);
    }
    if (p.body >= 0) {
      const Displacement target = targetDisplacement(s, p.body);
      d = p.displacement(target, d);
      nearer[0] += dot(p.n, p.displacement(target, {0, 0, 0}));
    }
    // Falling layers come together when the lowest one is stopped. A contact therefore counts as open only if
    // it stays open with either side at rest.
    const Real closes = surfaces ? max(dot(p.n, d), max(nearer[0], nearer[1])) : dot(p.n, d);
    if (p.c0 + closes < -kInactiveGap * p.length) p.kN = p.kT = Real(0);
  }
};

struct UpdatePointDuals {
  static constexpr const char* kStage = "dual";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    PointContact& p = s.pointContact[i];
    if (p.active) p.updateDual(s.stepOfPoint(p.v[0]), pointDisplacement(s, p));
  }
};

struct FinishPoints {
  static constexpr const char* kStage = "store";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    PointContact& p = s.pointContact[i];
    if (!p.active) return;
    Vec3 d = movedSum(s, p);
    // exact here: errors of the linear displacement would accumulate from step to step
    if (p.body >= 0) d += s.dx[p.body].dp + rotate(s.dq[p.body], p.lever) - p.lever;
    p.finish(s.stepOfPoint(p.v[0]), d);
    // replaces the offsets in the row by the displacement of this step, which has the arc
    const Real inFull = Real(1) / s.step->driftCorrection;
    if (p.stick) addShifts(s, p, Real(1) - inFull, -inFull);
  }
};

}  // namespace rubble::RUBBLE_CORE
