#pragma once
/// Contacts of vertices: a broad phase against the grid of the bodies and, for granular particles, against a grid of their own; rows; and
/// what is kept for the next step.
#include "collision/point_shape.h"
#include "stages/vertices.h"

namespace rubble::RUBBLE_CORE {

/// Box of a vertex swept over the step, with the detection margin.
struct VertexBounds {
  Vec3 centre, half;  ///< [m]
};
RUBBLE_HD inline VertexBounds vertexBounds(const View& s, int v) {
  const VertexParams& p = s.vertexParams[v];
  const Vec3 sweep = (s.step.dt / 2) * s.vertexVelocity[v], x(s.vertexPosition[v]);
  const Real roundOff = Real(2.4e-7) * (std::fabs(x.x) + std::fabs(x.y) + std::fabs(x.z));
  const Real grow = p.radius + s.step.contactMargin * p.length + roundOff;
  return {x + sweep, abs(sweep) + Vec3{grow, grow, grow}};
}
RUBBLE_HD inline bool meets(const VertexBounds& a, const Vec3& centre, const Vec3& half) {
  return std::fabs(a.centre.x - centre.x) <= a.half.x + half.x && std::fabs(a.centre.y - centre.y) <= a.half.y + half.y &&
         std::fabs(a.centre.z - centre.z) <= a.half.z + half.z;
}

RUBBLE_HD inline int grainBucket(const View& s, int x, int y, int z) {
  const std::uint32_t row = hash32(static_cast<std::uint32_t>(y) * 0x9e3779b1u ^ hash32(static_cast<std::uint32_t>(z)));
  return static_cast<int>((row + static_cast<std::uint32_t>(x)) & static_cast<std::uint32_t>(s.grainCells - 1));
}
RUBBLE_HD inline bool isGrain(const View& s, int v) {
  return s.vertexParams[v].kind != VertexKind::Removed && (s.vertexParams[v].collides & kCollidesWithGrains) != 0;
}

struct CountGrains {
  static constexpr const char* kName = "grid";
  RUBBLE_HD void operator()(const View& s, int v) const {
    if (!isGrain(s, v)) return;
    const VertexBounds b = vertexBounds(s, v);
    for (int k = 0; k < 3; ++k) {
      const int bits = floatBits(b.half[k] * Real(1.000001));
      if (bits > s.counters->grainHalf[k]) atomicRaise(&s.counters->grainHalf[k], bits);
    }
    const Real size = s.grainCell;
    atomicCount(&s.grainCount[grainBucket(s, cellOf(b.centre.x, size), cellOf(b.centre.y, size), cellOf(b.centre.z, size))], 1);
  }
};

/// In no fixed order; pairs are sorted later.
struct FillGrains {
  static constexpr const char* kName = "grid";
  RUBBLE_HD void operator()(const View& s, int v) const {
    if (!isGrain(s, v)) return;
    const VertexBounds b = vertexBounds(s, v);
    const Real size = s.grainCell;
    const int x = cellOf(b.centre.x, size), y = cellOf(b.centre.y, size), z = cellOf(b.centre.z, size);
    const int bucket = grainBucket(s, x, y, z);
    s.grain[s.grainOffset[bucket] + atomicCount(&s.grainCount[bucket], -1) - 1] = {b.centre, b.half, x, y, z, v};
  }
};

/// Is the vertex attached to that body? Then they do not collide.
RUBBLE_HD inline bool isAttached(const View& s, int v, int body) {
  for (int k = s.refOffset[v]; k < s.refOffset[v + 1]; ++k)
    if (pointType(s.ref[k]) == kAttachmentCode) {
      const Attachment& a = s.attachment[pointIndex(s.ref[k])];
      if (active(s, a) && a.seam == 0 && a.body == body) return true;
    }
  return false;
}

/// To filters of bodies a vertex is what a body is that has none.
RUBBLE_HD inline bool mayTouch(const View& s, int v, int body) {
  if (s.filtered != 0 && (isSensor(s, body) || !filtersMeet(s.filter[body], {1, ~0u, 0, 0}))) return false;
  return (isDynamicVertex(s, v) || s.params[body].kind == BodyKind::Dynamic) && !isAttached(s, v, body);
}

/// Cells that a search visits at most; beyond, looking at everything there is takes less.
inline constexpr Real kMostCells = 512;

/// visit(cell by cell: x, y, z) for the cells of edge `size` that something within `reach` of `centre` may have its centre in. Returns false,
/// and visits none, if they are too many: something that flies fast sweeps over many small cells.
template <class Visit>
RUBBLE_HD bool forEachCell(const Vec3& centre, const Vec3& reach, Real size, Visit&& visit) {
  if (!((2 * reach.x / size + 1) * (2 * reach.y / size + 1) * (2 * reach.z / size + 1) < kMostCells)) return false;
  const int x0 = cellOf(centre.x - reach.x, size), x1 = cellOf(centre.x + reach.x, size);
  const int y0 = cellOf(centre.y - reach.y, size), y1 = cellOf(centre.y + reach.y, size);
  const int z0 = cellOf(centre.z - reach.z, size), z1 = cellOf(centre.z + reach.z, size);
  for (int z = z0; z <= z1; ++z)
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) visit(x, y, z);
  return true;
}

/// found(other) for every partner whose pair vertex v owns.
template <class Found>
RUBBLE_HD void searchPoint(const View& s, int v, Found&& found) {
  const VertexParams& p = s.vertexParams[v];
  if (p.kind == VertexKind::Removed) return;
  const VertexBounds b = vertexBounds(s, v);
  if (p.collides & kCollidesWithBodies) {
    for (int level = 0; level < kGridLevels; ++level) {
      if (s.counters->levelUsed[level] == 0) continue;
      Vec3 reach;
      for (int k = 0; k < 3; ++k) reach[k] = b.half[k] + fromFloatBits(s.counters->levelHalf[level][k]);
      const auto look = [&](const GridEntry& e) {
        if (e.level == level && meets(b, e.centre, e.half) && mayTouch(s, v, e.body)) found(e.body);
      };
      const Real size = cellSize(s, level);
      const bool done = forEachCell(b.centre, reach, size, [&](int x, int y, int z) {
        const int bucket = bucketOf(s, level, x, y, z);
        for (int k = s.bucketOffset[bucket]; k < s.bucketOffset[bucket + 1]; ++k) {
          // another cell may share the bucket
          const GridEntry& e = s.grid[k];
          if (cellOf(e.centre.x, size) == x && cellOf(e.centre.y, size) == y && cellOf(e.centre.z, size) == z) look(e);
        }
      });
      for (int k = 0; !done && k < s.bucketOffset[s.cells]; ++k) look(s.grid[k]);
    }
    for (int k = 0; k < s.planes; ++k) {
      const int plane = s.planeBody[k];
      const Vec3 up = rotate(s.orientation[plane], Vec3{0, 0, 1});
      if (dot(up, b.centre - Vec3(s.position[plane])) <= dot(abs(up), b.half) && mayTouch(s, v, plane)) found(plane);
    }
  }
  if (!(p.collides & kCollidesWithGrains)) return;
  Vec3 reach;
  for (int k = 0; k < 3; ++k) reach[k] = b.half[k] + fromFloatBits(s.counters->grainHalf[k]);
  const auto look = [&](const GrainEntry& e) {
    if (e.vertex <= v || !meets(b, e.centre, e.half)) return;
    // vertices of one object with elements do not: they overlap at rest
    if (p.cluster >= 0 && p.cluster == s.vertexParams[e.vertex].cluster) return;
    if (isDynamicVertex(s, v) || isDynamicVertex(s, e.vertex)) found(kVertexNode + e.vertex);
  };
  const bool done = forEachCell(b.centre, reach, s.grainCell, [&](int x, int y, int z) {
    const int bucket = grainBucket(s, x, y, z);
    for (int k = s.grainOffset[bucket]; k < s.grainOffset[bucket + 1]; ++k) {
      const GrainEntry& e = s.grain[k];
      if (e.x == x && e.y == y && e.z == z) look(e);
    }
  });
  for (int k = 0; !done && k < s.grainOffset[s.grainCells]; ++k) look(s.grain[k]);
}

/// Partners of each vertex, the first kPointPairSlots of them kept.
struct FindPointPairs {
  static constexpr const char* kName = "pairs";
  RUBBLE_HD void operator()(const View& s, int v) const {
    int count = 0;
    int* const slots = s.pointPairSlot + v * kPointPairSlots;
    searchPoint(s, v, [&](int other) {
      if (count < kPointPairSlots) slots[count] = other;
      ++count;
    });
    s.pointPairCount[v] = count;
  }
};

/// Pairs sorted by vertex, then by partner.
struct WritePointPairs {
  static constexpr const char* kName = "pairs";
  RUBBLE_HD void operator()(const View& s, int v) const {
    const int begin = s.pointPairOffset[v], count = s.pointPairOffset[v + 1] - begin;
    int n = 0;
    const auto insert = [&](int other) {
      int k = begin + n++;
      for (; k > begin && s.pointPair[k - 1].other > other; --k) s.pointPair[k] = s.pointPair[k - 1];
      s.pointPair[k] = {v, other};
    };
    if (count <= kPointPairSlots)
      for (int k = 0; k < count; ++k) insert(s.pointPairSlot[v * kPointPairSlots + k]);
    else
      searchPoint(s, v, insert);
  }
};

RUBBLE_HD inline Real lighter(Real a, Real b) { return a > Real(0) && b > Real(0) ? min(a, b) : max(a, b); }

/// A vertex against a body at x^t, world axes. Surfaces are looked for up to `reach` from the vertex; `side` is the direction in which the body
/// held it last, or zero.
RUBBLE_HD inline PointDistance pointToBody(const View& s, int v, int body, Real reach, const Vec3& side) {
  const Quat q = s.orientation[body];
  const ShapeData& shape = s.params[body].shape;
  const Vec3 x = rotateInverse(q, Vec3(s.vertexPosition[v] - s.position[body]));
  PointDistance at;
  if (isPlain(shape.kind))
    at = pointToPlainShape(shape, x);
  else
    at = pointToRareShape(s.shapeTables(), shape, x, {reach, max(reach, kHeldFromBelow * s.vertexParams[v].length), rotateInverse(q, side)});
  at.n = rotate(q, at.n);
  return at;
}

/// How far the surface of the body of a contact moves in a step, besides the body. [m]
RUBBLE_HD inline Vec3 beltOf(const View& s, const PointContact& p) {
  if (s.surfaces == 0 || p.body < 0) return {0, 0, 0};
  return s.step.dt * rotate(s.orientation[p.body], surfaceOf(s, p.body, p.part).velocity);
}

/// A vertex (B) against a body (A) at x^t. Returns what the rows start from; fills the geometry.
RUBBLE_HD inline PointContactStart touchBody(const View& s, int v, int body, const PointContact* old, PointContact& p, Real& gap, Real& margin) {
  const VertexParams& point = s.vertexParams[v];
  const BodyParams& b = s.params[body];
  const Vec3 x(s.vertexPosition[v] - s.position[body]);
  const Real width = b.kind == BodyKind::Dynamic ? min(point.length, 2 * b.radius) : point.length;
  const Vec3 relative = s.vertexVelocity[v] - s.velocity[body];
  margin = max(s.step.contactMargin * width, s.step.dt * (length(relative) + length(s.spin[body]) * length(x)));
  const PointDistance at = pointToBody(s, v, body, point.radius + margin, old && old->active ? old->n : Vec3{0, 0, 0});
  gap = at.distance - point.radius;
  p.v[0] = v, p.v[1] = p.v[2] = p.v[3] = -1;
  p.weight[0] = -1;
  p.body = body;
  p.part = at.part;
  p.n = at.n;
  // in the middle of the gap
  p.lever = x - p.n * ((at.distance + point.radius) / 2);
  p.length = width;
  const SurfaceData surface = surfaceOf(s, body, at.part);
  const auto friction = [&](Real a, Real c) { return combined(surface.frictionCombine, point.frictionCombine, Combine::GeometricMean, a, c); };
  p.muStatic = friction(surface.muStatic, point.muStatic);
  p.muDynamic = friction(surface.muDynamic, point.muDynamic);
  const Real closing = -dot(p.n, relative) + dot(p.n, cross(s.spin[body], p.lever));
  return {lighter(point.mass, b.mass), -gap, closing,
          combined(surface.restitutionCombine, point.restitutionCombine, Combine::Maximum, surface.restitution, point.restitution)};
}

/// Granular particles a (A) and b (B).
RUBBLE_HD inline PointContactStart touchGrain(const View& s, int a, int b, PointContact& p, Real& gap, Real& margin) {
  const VertexParams &pa = s.vertexParams[a], &pb = s.vertexParams[b];
  const Vec3 d(s.vertexPosition[b] - s.vertexPosition[a]);
  gap = length(d) - pa.radius - pb.radius;
  const Vec3 relative = s.vertexVelocity[a] - s.vertexVelocity[b];
  p.length = min(pa.length, pb.length);
  margin = max(s.step.contactMargin * p.length, s.step.dt * length(relative));
  p.v[0] = a, p.v[1] = b, p.v[2] = p.v[3] = -1;
  p.weight[0] = 1, p.weight[1] = -1;
  p.body = -1;
  p.n = normalize(d);
  const auto friction = [&](Real x, Real y) { return combined(pa.frictionCombine, pb.frictionCombine, Combine::GeometricMean, x, y); };
  p.muStatic = friction(pa.muStatic, pb.muStatic);
  p.muDynamic = friction(pa.muDynamic, pb.muDynamic);
  return {lighter(pa.mass, pb.mass), -gap, dot(p.n, relative),
          combined(pa.restitutionCombine, pb.restitutionCombine, Combine::Maximum, pa.restitution, pb.restitution)};
}

/// Adds a share of the way of a belt to the drift of a contact. The rows correct the part driftCorrection of a drift: what the belt moves is
/// to be made good in full.
RUBBLE_HD inline void addBelt(const View& s, PointContact& p, Real share) {
  if (s.surfaces == 0 || p.body < 0) return;
  Vec3 t1, t2;
  tangentBasis(p.n, t1, t2);
  const Vec3 belt = share * beltOf(s, p);
  p.drift1 += dot(t1, belt), p.drift2 += dot(t2, belt);
}

/// Rows of a pair at x^t, matched with those of the step before.
struct UpdatePointContacts {
  static constexpr const char* kName = "rows";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const PointPair pair = s.pointPair[i];
    PointContact p;
    memset(static_cast<void*>(&p), 0, sizeof p);  // padding too: states are hashed
    Real gap, margin;
    const PointContact* old = nullptr;
    for (int k = s.oldPointPairOffset[pair.vertex]; k < s.oldPointPairOffset[pair.vertex + 1]; ++k)
      if (s.oldPointPair[k].other == pair.other) old = &s.oldPointContact[k];
    const bool isBody = pair.other < kVertexNode;
    const PointContactStart start = isBody ? touchBody(s, pair.vertex, pair.other, old, p, gap, margin)
                                           : touchGrain(s, pair.vertex, pair.other - kVertexNode, p, gap, margin);
    p.active = gap <= margin;
    if (p.active) {
      beginPointContact(s.step, p, start, old);
      addBelt(s, p, Real(1) / s.step.driftCorrection);
      atomicCount(&s.counters->pointContacts, 1);
    }
    s.pointContact[i] = p;
  }
};

/// Contacts without load that stay open at the inertial targets take no part in the step: k = 0.
struct MarkDormantPoints {
  static constexpr const char* kName = "dormant";
  RUBBLE_HD void operator()(const View& s, int i) const {
    PointContact& p = s.pointContact[i];
    if (!s.step.dormantRows || !p.active || p.lambdaN != Real(0)) return;
    Vec3 d{0, 0, 0};
    for (int k = 0; k < kPointCorners && p.v[k] >= 0; ++k) d += p.weight[k] * s.vertexTarget[p.v[k]];
    if (p.body >= 0) d = p.displacement(targetDisplacement(s, p.body), d);
    if (p.c0 + dot(p.n, d) < -kDormantGap * p.length) p.kN = p.kT = Real(0);
  }
};

struct UpdatePointDuals {
  static constexpr const char* kName = "dual";
  RUBBLE_HD void operator()(const View& s, int i) const {
    PointContact& p = s.pointContact[i];
    if (p.active) p.updateDual(s.step, pointDisplacement(s, p));
  }
};

struct FinishPoints {
  static constexpr const char* kName = "store";
  RUBBLE_HD void operator()(const View& s, int i) const {
    PointContact& p = s.pointContact[i];
    if (!p.active) return;
    Vec3 d = movedSum(s, p);
    // exact here: errors of the linear displacement would add up from step to step
    if (p.body >= 0) d += s.moved[p.body].dp + rotate(s.turned[p.body], p.lever) - p.lever;
    p.finish(s.step, d);
    // its way in this step instead of what stood for it in the row
    if (p.stick) addBelt(s, p, Real(1) - Real(1) / s.step.driftCorrection);
  }
};

}  // namespace rubble::RUBBLE_CORE
