#include "stages/queries/queries.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

#include "tables/shape_edit.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

namespace {

template <class Kernel> void forEach(const SolverData& s, const Kernel& kernel, std::size_t n) {
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) { kernel(s, static_cast<int>(i)); });
}

/// Fills the grid at the present poses.
void fillGrid(SolverData& s) {
  // bodies do not move during queries
  const Real dt = s.step->dt;
  s.step->dt = 0;
  std::fill_n(s.bucketCount, s.cells, 0);
  for (int level = 0; level < kGridLevels; ++level) {
    s.counters->levelCount[level] = 0;
    for (int& half : s.counters->levelHalf[level]) half = 0;
  }
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

/// Queries in the precision of the tables, and tables of the query shapes.
struct CoreQueries {
  std::vector<QueryData> data;
  std::optional<HostTables> shelf;

  explicit CoreQueries(std::span<const EngineQuery> queries) {
    std::map<const CookedShape*, int> places;
    data.reserve(queries.size());
    for (const EngineQuery& q : queries) {
      const bool point = q.kind == EngineQuery::Ray || q.kind == EngineQuery::Closest;
      ShapeData shape = point ? ShapeData{{0, 0, 0}, 0, ShapeKind::Sphere, -1} : shapeData(q.shape->shape);
      if (shape.data >= 0) {
        if (!shelf) shelf.emplace();
        const auto [place, isNew] = places.try_emplace(q.shape.get(), shelf->shapeIndices);
        if (isNew) addShape(*shelf, *q.shape, std::vector<int>(q.shape->parts.size(), -1));
        shape.data += place->second;
      }
      data.push_back({static_cast<QueryKind>(q.kind), shape, q.position, q.orientation, q.move, q.reach,
                      2 * static_cast<double>(boundingRadius(shape)), q.layers, q.mask, q.sensors, q.ignore});
    }
  }
  ShapeTables tables() const { return shelf ? shelf->view().shapeTables() : ShapeTables{}; }
};

}  // namespace

std::vector<EngineHit> runQueries(HostTables& tables, std::span<const EngineQuery> queries) {
  fillGrid(tables.view());
  const CoreQueries core(queries);
  const std::vector<QueryData>& data = core.data;
  std::vector<QueryHit> hits(data.size());
  forEach(tables.view(), RunQuery{data.data(), core.tables(), hits.data()}, data.size());
  std::vector<EngineHit> out;
  out.reserve(hits.size());
  for (const QueryHit& hit : hits) out.push_back({hit.body, hit.fraction, hit.position, hit.n});
  return out;
}

std::vector<std::vector<int>> runOverlaps(HostTables& tables, std::span<const EngineQuery> queries) {
  fillGrid(tables.view());
  const CoreQueries core(queries);
  const std::vector<QueryData>& data = core.data;
  std::vector<int> offsets(data.size() + 1);
  forEach(tables.view(), CountOverlaps{data.data(), core.tables(), offsets.data()}, data.size());
  int sum = 0;
  for (int& offset : offsets) sum += std::exchange(offset, sum);
  std::vector<int> bodies(static_cast<std::size_t>(sum));
  forEach(tables.view(), FillOverlaps{data.data(), core.tables(), offsets.data(), bodies.data()},
          data.size());
  std::vector<std::vector<int>> out;
  for (std::size_t i = 0; i < data.size(); ++i)
    out.emplace_back(bodies.begin() + offsets[i], bodies.begin() + offsets[i + 1]);
  return out;
}

}  // namespace rubble::RUBBLE_CORE
