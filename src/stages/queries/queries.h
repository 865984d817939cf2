#pragma once
/// Queries over the grid of the broad phase, filled at the present poses. One functor call per query.
#include "collision/probe.h"
#include "stages/pairs/grid_walk.h"

namespace rubble::RUBBLE_CORE {

enum class QueryKind : int { Ray, Cast, Overlap, Closest };

struct QueryData {
  QueryKind kind;
  ShapeData shape;  ///< of a cast and an overlap: convex or a compound, in the queries' own shape tables
  Vec3d position;   ///< center of the shape; of a ray and of a closest-point query: the point [m]
  Quatd orientation;
  Vec3d move;    ///< [m]
  double reach;  ///< closest point: largest distance [m]
  double size;   ///< diameter of the shape [m]
  std::uint32_t layers, mask;
  int sensors, ignore;
  int world;  ///< whose bodies are found
};

struct QueryHit {
  int body;         ///< -1: none
  double fraction;  ///< fraction of `move`; closest point: distance [m]
  Vec3d position, n;
};

/// Half extents of the box about the center of a query's shape [m].
RUBBLE_HD inline Vec3d extent(const QueryData& q) {
  const Vec3d half(q.shape.half);
  const Vec3d x = abs(rotate(q.orientation, Vec3d{half.x, 0, 0})),
              y = abs(rotate(q.orientation, Vec3d{0, half.y, 0}));
  const double radius = static_cast<double>(q.shape.radius);
  return x + y + abs(rotate(q.orientation, Vec3d{0, 0, half.z})) + Vec3d{radius, radius, radius};
}

RUBBLE_HD inline bool looksAt(const SolverData& s, const QueryData& q, int body) {
  if (body == q.ignore) return false;
  const BodyFilter& f = s.filter[body];
  return (q.sensors != 0 || f.sensor == 0) && (f.layers & q.mask) != 0 && (q.layers & f.mask) != 0;
}

/// visit(part) for the parts of a body relative to the query's position, which keeps precision far from the
/// origin.
template <class Visit>
RUBBLE_HD void visitParts(const SolverData& s, int body, const Vec3d& origin, Visit&& visit) {
  const ShapeData& shape = s.params[body].shape;
  const int count = parts::count(s, shape);
  for (int k = 0; k < count; ++k)
    visit(placedAny(s.shapeTables(), shape, s.position[body] - origin, s.orientation[body], k));
}

/// visit(own) for the parts of a query's shape.
template <class Visit> RUBBLE_HD void visitOwn(const ShapeTables& tables, const QueryData& q, Visit&& visit) {
  if (q.shape.kind != ShapeKind::Compound) {
    visit(PlacedAny{tables, q.shape, {}, q.orientation});
    return;
  }
  const int count = tables.index[q.shape.data + 3];
  for (int k = 0; k < count; ++k) visit(placedAny(tables, q.shape, {}, Quat(q.orientation), k));
}

/// Contact tolerance of a cast over the size of its shape [1].
inline constexpr double kCastGap = 1e-4;

/// Is a the better answer to a query? Ties go to the body of the lowest id.
RUBBLE_HD inline bool comesBefore(const SolverData& s, const QueryHit& a, const QueryHit& b) {
  if (a.body < 0 || b.body < 0) return a.body >= 0;
  return a.fraction < b.fraction || (a.fraction == b.fraction && s.idOf[a.body] < s.idOf[b.body]);
}

/// The first hit, or the nearest body, among those that lane `lane` of `lanes` visits. One function for each
/// kind, because each needs other registers.
template <QueryKind kKind>
RUBBLE_HD QueryHit answer(const SolverData& s, const QueryData& q, const ShapeTables& own, int lane = 0,
                          int lanes = 1) {
  QueryHit best{-1, 0, {}, {}};
  double limit = 1, bestDistance = q.reach;
  constexpr bool closest = kKind == QueryKind::Closest;
  const Vec3d half = closest ? Vec3d{q.reach, q.reach, q.reach} : extent(q);
  const auto take = [&](const QueryHit& hit) {
    if (!comesBefore(s, hit, best)) return;
    best = hit;
    (closest ? bestDistance : limit) = hit.fraction;
  };
  visitAlong(
      s, q.world, q.position, q.move, half, limit,
      [&](int body) {
        if (!looksAt(s, q, body)) return;
        visitParts(s, body, q.position, [&](const PlacedAny& target) {
          if constexpr (kKind == QueryKind::Ray) {
            const RayImpact m = castRay(target, q.move);
            if (m.fraction <= 1) take({body, m.fraction, q.move * m.fraction, m.n});
          } else if constexpr (closest) {
            const Separation at = nearestPoint(target, bestDistance);
            const bool inside = !(at.distance > 0);
            const double distance = inside ? 0 : at.distance;
            if (distance <= bestDistance) take({body, distance, inside ? Vec3d{} : at.onB, {}});
          } else {
            visitOwn(own, q, [&](const PlacedAny& part) {
              const TimeOfImpact m = castShape(part, q.move, target, kCastGap * q.size);
              if (m.fraction <= 1) take({body, m.fraction, m.at.n == Vec3d{} ? Vec3d{} : m.at.onA, m.at.n});
            });
          }
        });
      },
      lane, lanes);
  best.position += q.position;
  return best;
}

struct RunQuery {
  static constexpr const char* kStage = "queries";
  const QueryData* queries;
  ShapeTables own;
  QueryHit* hits;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const QueryData& q = queries[i];
    hits[i] = q.kind == QueryKind::Ray       ? answer<QueryKind::Ray>(s, q, own)
              : q.kind == QueryKind::Closest ? answer<QueryKind::Closest>(s, q, own)
                                             : answer<QueryKind::Cast>(s, q, own);
  }
};

/// found(body) for the bodies that a shape overlaps, in no fixed order.
template <class Found>
RUBBLE_HD void searchOverlaps(const SolverData& s, const ShapeTables& tables, const QueryData& q,
                              Found&& found) {
  double limit = 1;
  visitAlong(s, q.world, q.position, {}, extent(q), limit, [&](int body) {
    if (!looksAt(s, q, body)) return;
    bool meets = false;
    visitParts(s, body, q.position, [&](const PlacedAny& target) {
      visitOwn(tables, q, [&](const PlacedAny& part) { meets = meets || overlaps(part, target); });
    });
    if (meets) found(body);
  });
}

struct CountOverlaps {
  static constexpr const char* kStage = "queries";
  const QueryData* queries;
  ShapeTables own;
  int* counts;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    int n = 0;
    searchOverlaps(s, own, queries[i], [&](int) { ++n; });
    counts[i] = n;
  }
};

/// Writes to [offsets[i], offsets[i + 1]), ascending.
struct FillOverlaps {
  static constexpr const char* kStage = "queries";
  const QueryData* queries;
  ShapeTables own;
  const int* offsets;
  int* bodies;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    int n = 0;
    int* const to = bodies + offsets[i];
    searchOverlaps(s, own, queries[i], [&](int body) {
      int k = n++;
      for (; k > 0 && to[k - 1] > body; --k) to[k] = to[k - 1];
      to[k] = body;
    });
  }
};

}  // namespace rubble::RUBBLE_CORE
