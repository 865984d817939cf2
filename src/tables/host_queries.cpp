#include <algorithm>
#include <tuple>
#include <utility>

#include "platform/threads.h"
#include "tables/host_queries.h"
#include "tables/query_shapes.h"
#include "tables/shape_edit.h"

namespace rubble::RUBBLE_CORE {

namespace {

template <class Kernel> void forEach(const SolverData& s, const Kernel& kernel, std::size_t n) {
  forEachRange(n, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) kernel(s, static_cast<int>(i));
  });
}

/// Fills the grid at the present poses.
void fillGrid(SolverData& s) {
  // bodies do not move during queries
  const Real dt = std::exchange(s.step->dt, Real(0));
  std::ranges::fill(firstOf(s.bucketCount, s.cells), 0);
  Counters& c = *s.counters;
  std::fill(std::begin(c.levelCount), std::end(c.levelCount), 0);
  std::fill_n(&c.levelHalf[0][0], 3 * kGridLevels, 0);
  std::fill_n(&c.levelReach[0][0][0], 6 * kGridLevels, 0);
  for (int i = 0; i < s.bodies; ++i) ComputeBounds{}(s, i);
  int sum = 0;
  for (int i = 0; i < s.cells; ++i) {
    s.bucketOffset[i] = sum;
    sum += s.bucketCount[i];
  }
  s.bucketOffset[s.cells] = sum;
  for (int i = 0; i < s.bodies; ++i) FillGrid{}(s, i);
  s.step->dt = dt;
}

/// f.operator()<search>() for the cheaper search; the grid is filled if it needs one.
template <class F> void withSearch(SolverData& s, const EngineQueries& asked, F&& f) {
  if (asked.queries.size() <= kFewQueries) return f.template operator()<Search::OneByOne>();
  fillGrid(s);
  f.template operator()<Search::ByGrid>();
}

}  // namespace

QueryShelf::QueryShelf(std::span<const std::shared_ptr<const CookedShape>> shapes) {
  for (const auto& cooked : shapes) {
    ShapeData& shape = shapes_.emplace_back(shapeData(cooked->shape));
    if (shape.data < 0) continue;
    shape.data += tables_.shapeIndices;
    addShape(tables_, *cooked, std::vector<int>(cooked->parts.size(), -1), endOfShapes(tables_));
  }
}

std::span<const EngineHit> HostQueries::hits(HostTables& tables, const EngineQueries& asked) {
  QueryShelf shelf(asked.shapes);
  hits_.resize(asked.queries.size());
  withSearch(tables.view(), asked, [&]<Search kSearch>() {
    withHitKind(asked.kind, [&]<QueryKind kKind>() {
      forEach(tables.view(), FindHit<kKind, kSearch>{asked.queries.data(), shelf.view(), hits_.data()},
              asked.queries.size());
    });
  });
  return hits_;
}

EngineOverlaps HostQueries::overlaps(HostTables& tables, const EngineQueries& asked) {
  QueryShelf shelf(asked.shapes);
  const std::size_t count = asked.queries.size();
  offsets_.assign(count + 1, 0);
  withSearch(tables.view(), asked, [&]<Search kSearch>() {
    forEach(tables.view(), CountOverlaps<kSearch>{asked.queries.data(), shelf.view(), offsets_.data()},
            count);
    int sum = 0;
    for (int& offset : offsets_) sum += std::exchange(offset, sum);
    bodies_.resize(static_cast<std::size_t>(sum));
    forEach(tables.view(),
            FillOverlaps<kSearch>{asked.queries.data(), shelf.view(), offsets_.data(), bodies_.data()},
            count);
  });
  return {offsets_, bodies_};
}

namespace {

/// The triangle of a surface that is closest to a point on it, -1 for other shapes.
int triangleAt(const SolverData& s, int body, const Vec3d& point) {
  const ShapeData& shape = s.params[body].shape;
  if (shape.kind != ShapeKind::Mesh && shape.kind != ShapeKind::HeightField) return -1;
  const PlacedAny surface = placedAny(s.shapeTables(), shape, s.position[body] - point, s.orientation[body],
                                      0);
  const Placed at{probes::point(), {}, {}};
  const Vec3 x(rotateInverse(surface.q, -surface.p));
  const Real grow = Real(2e-3) * s.params[body].radius;
  int best = -1;
  double least = 0;
  visitTriangles(surface.tables, shape, x - Vec3{grow, grow, grow}, x + Vec3{grow, grow, grow},
                 [&](const SurfaceTriangle& t) {
                   const double d = separation(at, probes::triangleOf(surface, t)).distance;
                   if (best < 0 || d < least || (d == least && t.index < best)) best = t.index, least = d;
                   return false;
                 });
  return best;
}

/// All hits of a query, in no fixed order.
template <Search kSearch>
void findAll(const SolverData& s, QueryKind kind, const EngineQuery& q, const QueryShapes& own,
             std::vector<EngineHit>& out) {
  const ShapeData shape = shapeOf(own, q);
  const double gap = kCastGap * 2 * static_cast<double>(boundingRadius(shape));
  const auto visitTargets = [&](int body, auto&& f) {
    visitParts(s, body, q.position, [&](const PlacedAny& target, int part) {
      EngineHit best{-1, 0, {}, {}};
      f(target, [&](double fraction, const Vec3d& at, const Vec3d& n, int triangle) {
        if (best.body < 0 || fraction < best.fraction)
          best = {s.idOf[body], fraction, q.position + at, n, part, triangle};
      });
      if (best.body < 0) return;
      if (kind == QueryKind::Cast) best.triangle = triangleAt(s, body, best.position);
      out.push_back(best);
    });
  };
  const auto look = [&](int body) {
    visitTargets(body, [&](const PlacedAny& target, auto&& take) {
      if (kind == QueryKind::Ray) {
        const RayImpact m = castRay(target, q.move);
        if (m.fraction <= 1) take(m.fraction, q.move * m.fraction, m.n, m.triangle);
        return;
      }
      visitOwn(own.tables, shape, q.orientation, [&](const PlacedAny& moving) {
        if (kind == QueryKind::Overlap) {
          if (overlaps(moving, target)) take(0, {}, {}, -1);
          return;
        }
        const TimeOfImpact m = castShape(moving, q.move, target, gap);
        if (m.fraction <= 1) take(m.fraction, m.at.n == Vec3d{} ? Vec3d{} : m.at.onA, m.at.n, -1);
      });
    });
  };
  visitNear<kSearch>(
      s, q, {q.position, q.move, extent(shape, q.orientation)}, look, [] {}, OneLane{});
  std::ranges::sort(out, {}, [](const EngineHit& h) { return std::tuple(h.fraction, h.body, h.part); });
}

}  // namespace

EngineAllHits HostQueries::allHits(HostTables& tables, const EngineQueries& asked) {
  QueryShelf shelf(asked.shapes);
  const QueryShapes own = shelf.view();
  std::vector<std::vector<EngineHit>> lists(asked.queries.size());
  withSearch(tables.view(), asked, [&]<Search kSearch>() {
    forEach(
        tables.view(),
        [&](const SolverData& s, int i) {
          const auto k = static_cast<std::size_t>(i);
          findAll<kSearch>(s, asked.kind, asked.queries[k], own, lists[k]);
        },
        lists.size());
  });
  offsets_.assign(1, 0), hits_.clear();
  for (const std::vector<EngineHit>& list : lists) {
    hits_.insert(hits_.end(), list.begin(), list.end());
    offsets_.push_back(static_cast<int>(hits_.size()));
  }
  return {offsets_, hits_};
}

}  // namespace rubble::RUBBLE_CORE
