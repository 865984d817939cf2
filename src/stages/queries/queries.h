#pragma once
/// Queries at the present poses. One functor call per query.
#include "collision/probe.h"
#include "collision/query_record.h"
#include "stages/pairs/grid_walk.h"

namespace rubble::RUBBLE_CORE {

/// Shapes of casts and overlaps, by EngineQuery::shape, and the tables of these shapes.
struct QueryShapes {
  const ShapeData* shapes;
  ShapeTables tables;
};

/// A point for queries without a shape.
RUBBLE_HD inline ShapeData shapeOf(const QueryShapes& own, const EngineQuery& q) {
  return q.shape < 0 ? ShapeData{{0, 0, 0}, 0, ShapeKind::Sphere, -1} : own.shapes[q.shape];
}

/// Half extents of the box about the center of a query's shape [m].
RUBBLE_HD inline Vec3d extent(const ShapeData& shape, const Quatd& orientation) {
  const Vec3d half(shape.half);
  const Vec3d x = abs(rotate(orientation, Vec3d{half.x, 0, 0})),
              y = abs(rotate(orientation, Vec3d{0, half.y, 0}));
  const double radius = static_cast<double>(shape.radius);
  return x + y + abs(rotate(orientation, Vec3d{0, 0, half.z})) + Vec3d{radius, radius, radius};
}

RUBBLE_HD inline bool looksAt(const SolverData& s, const EngineQuery& q, int body) {
  if (q.ignore >= 0 && s.idOf[body] == q.ignore) return false;
  const BodyFilter& f = s.filter[body];
  return (q.sensors != 0 || f.sensor == 0) && (f.layers & q.mask) != 0 && (q.layers & f.mask) != 0;
}

/// The bodies that a query may meet. ByGrid: those of the cells along its way. OneByOne: all, each by its
/// bounding sphere, which needs no grid.
enum class Search { ByGrid, OneByOne };
/// So few queries cost less one by one than the grid that they would need.
inline constexpr int kFewQueries = 8;

/// visit(body) for the bodies that a query may meet; share() as in visitAlong().
template <Search kSearch, class Visit, class Share, class Lanes>
RUBBLE_HD void visitNear(const SolverData& s, const EngineQuery& q, const PathSearch& p, Visit&& visit,
                         Share&& share, const Lanes& lanes) {
  const auto look = [&](int body) {
    if (looksAt(s, q, body)) visit(body);
  };
  if constexpr (kSearch == Search::ByGrid) {
    visitAlong(s, q.world, p, look, share, lanes);
  } else {
    const Vec3d inverse = inverseOf(p.d);
    for (int body = lanes.lane; body < s.bodies; body += lanes.count) {
      const BodyParams& params = s.params[body];
      if (params.kind == BodyKind::Removed || s.worldOf(body) != q.world) continue;
      const double radius = static_cast<double>(params.radius);
      const Vec3d away = p.x - Vec3d(s.position[body]), reach = p.half + Vec3d{radius, radius, radius};
      if (params.shape.kind == ShapeKind::Plane || passes(away, inverse, reach, p.limit)) look(body);
    }
  }
}

/// visit(part, its index) for the parts of a body relative to the query's position, which keeps precision far
/// from the origin.
template <class Visit>
RUBBLE_HD void visitParts(const SolverData& s, int body, const Vec3d& origin, Visit&& visit) {
  const ShapeData& shape = s.params[body].shape;
  const int count = parts::count(s, shape);
  for (int k = 0; k < count; ++k)
    visit(placedAny(s.shapeTables(), shape, s.position[body] - origin, s.orientation[body], k), k);
}

/// visit(own) for the parts of a query's shape.
template <class Visit>
RUBBLE_HD void visitOwn(const ShapeTables& tables, const ShapeData& shape, const Quatd& orientation,
                        Visit&& visit) {
  if (shape.kind != ShapeKind::Compound) {
    visit(PlacedAny{tables, shape, {}, orientation});
    return;
  }
  const int count = tables.index[shape.data + 3];
  for (int k = 0; k < count; ++k) visit(placedAny(tables, shape, {}, Quat(orientation), k));
}

/// Contact tolerance of a cast over the size of its shape [1].
inline constexpr double kCastGap = 1e-4;

/// Is a the better answer to a query? Ties go to the body of the lowest id.
RUBBLE_HD inline bool comesBefore(const EngineHit& a, const EngineHit& b) {
  if (a.body < 0 || b.body < 0) return a.body >= 0;
  return a.fraction < b.fraction || (a.fraction == b.fraction && a.body < b.body);
}

/// The first hit, or the nearest body, among those that this one of several workers visits. One function for
/// each kind, because each needs other registers.
template <QueryKind kKind, Search kSearch, class Lanes = OneLane>
RUBBLE_HD EngineHit answer(const SolverData& s, const EngineQuery& q, const QueryShapes& own,
                           const Lanes& lanes = {}) {
  EngineHit best{-1, 0, {}, {}};
  constexpr bool closest = kKind == QueryKind::Closest;
  const ShapeData shape = shapeOf(own, q);
  const double gap = kCastGap * 2 * static_cast<double>(boundingRadius(shape));
  double distance = q.reach;
  PathSearch path{q.position, q.move, extent(shape, q.orientation)};
  const auto narrow = [&](double to) {
    if constexpr (closest)
      distance = to, path.half = {to, to, to};
    else
      path.limit = to;
  };
  if (closest) narrow(distance);
  const auto take = [&](const EngineHit& hit) {
    if (comesBefore(hit, best)) best = hit, narrow(hit.fraction);
  };
  visitNear<kSearch>(
      s, q, path,
      [&](int body) {
        const int id = s.idOf[body];
        visitParts(s, body, q.position, [&](const PlacedAny& target, int part) {
          if constexpr (kKind == QueryKind::Ray) {
            const RayImpact m = castRay(target, q.move);
            if (m.fraction <= 1) take({id, m.fraction, q.move * m.fraction, m.n, part, m.triangle});
          } else if constexpr (closest) {
            const Separation at = nearestPoint(target, distance);
            const bool inside = !(at.distance > 0);
            const double found = inside ? 0 : at.distance;
            if (found <= distance) take({id, found, inside ? Vec3d{} : at.onB, {}, part});
          } else {
            visitOwn(own.tables, shape, q.orientation, [&](const PlacedAny& moving) {
              const TimeOfImpact m = castShape(moving, q.move, target, gap);
              if (m.fraction <= 1)
                take({id, m.fraction, m.at.n == Vec3d{} ? Vec3d{} : m.at.onA, m.at.n, part});
            });
          }
        });
      },
      [&] { narrow(lanes.least(closest ? distance : path.limit)); }, lanes);
  best.position += q.position;
  return best;
}

template <QueryKind kKind, Search kSearch> struct FindHit {
  static constexpr const char* kStage = "queries";
  const EngineQuery* queries;
  QueryShapes own;
  EngineHit* hits;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    hits[i] = answer<kKind, kSearch>(s, queries[i], own);
  }
};

/// found(id) for the bodies that a shape overlaps, in no fixed order.
template <Search kSearch, class Found>
RUBBLE_HD void searchOverlaps(const SolverData& s, const QueryShapes& own, const EngineQuery& q,
                              Found&& found) {
  const ShapeData shape = shapeOf(own, q);
  visitNear<kSearch>(
      s, q, {q.position, {}, extent(shape, q.orientation)},
      [&](int body) {
        bool meets = false;
        visitParts(s, body, q.position, [&](const PlacedAny& target, int) {
          visitOwn(own.tables, shape, q.orientation,
                   [&](const PlacedAny& part) { meets = meets || overlaps(part, target); });
        });
        if (meets) found(s.idOf[body]);
      },
      [] {}, OneLane{});
}

template <Search kSearch> struct CountOverlaps {
  static constexpr const char* kStage = "queries";
  const EngineQuery* queries;
  QueryShapes own;
  int* counts;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    int n = 0;
    searchOverlaps<kSearch>(s, own, queries[i], [&](int) { ++n; });
    counts[i] = n;
  }
};

/// Writes the ids to [offsets[i], offsets[i + 1]), ascending.
template <Search kSearch> struct FillOverlaps {
  static constexpr const char* kStage = "queries";
  const EngineQuery* queries;
  QueryShapes own;
  const int* offsets;
  int* bodies;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    int n = 0;
    int* const to = bodies + offsets[i];
    searchOverlaps<kSearch>(s, own, queries[i], [&](int id) {
      int k = n++;
      for (; k > 0 && to[k - 1] > id; --k) to[k] = to[k - 1];
      to[k] = id;
    });
  }
};

/// f.operator()<kind>() for a kind that finds one body.
template <class F> void withHitKind(QueryKind kind, F&& f) {
  if (kind == QueryKind::Ray) return f.template operator()<QueryKind::Ray>();
  if (kind == QueryKind::Closest) return f.template operator()<QueryKind::Closest>();
  f.template operator()<QueryKind::Cast>();
}

}  // namespace rubble::RUBBLE_CORE
