#include <algorithm>
#include <map>
#include <utility>

#include <tbb/parallel_for.h>

#include "tables/query_batch.h"
#include "tables/shape_edit.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// f(i) for all i < n, in parallel if that pays.
template <class F> void forEachIndex(int n, F&& f) {
  constexpr int kGrain = 2048;
  tbb::parallel_for(tbb::blocked_range<int>(0, n, kGrain), [&](const auto& range) {
    for (int i = range.begin(); i < range.end(); ++i) f(i);
  });
}

template <class Kernel> void forEach(const SolverData& s, const Kernel& kernel, int n) {
  tbb::parallel_for(0, n, [&](int i) { kernel(s, i); });
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

}  // namespace

QueryBatch::QueryBatch(const HostTables& tables, std::span<const EngineQuery> queries) {
  data.resize(queries.size());
  std::map<const CookedShape*, int> places;
  for (const EngineQuery& q : queries)
    if (q.shape && q.shape->shape.data >= 0 && !places.contains(q.shape.get())) {
      if (!shelf) shelf.emplace();
      places[q.shape.get()] = shelf->shapeIndices;
      addShape(*shelf, *q.shape, std::vector<int>(q.shape->parts.size(), -1));
    }
  forEachIndex(count(), [&](int i) {
    const EngineQuery& q = queries[static_cast<std::size_t>(i)];
    ShapeData shape = q.shape ? shapeData(q.shape->shape) : ShapeData{{0, 0, 0}, 0, ShapeKind::Sphere, -1};
    if (shape.data >= 0) shape.data += places.at(q.shape.get());
    data[static_cast<std::size_t>(i)] = {static_cast<QueryKind>(q.kind),
                                         shape,
                                         q.position,
                                         q.orientation,
                                         q.move,
                                         q.reach,
                                         2 * static_cast<double>(boundingRadius(shape)),
                                         q.layers,
                                         q.mask,
                                         q.sensors,
                                         slotOf(tables, q.ignore),
                                         q.world};
  });
}

std::vector<EngineHit> engineHits(const HostTables& tables, std::span<const QueryHit> hits) {
  std::vector<EngineHit> out(hits.size());
  forEachIndex(static_cast<int>(hits.size()), [&](int i) {
    const QueryHit& hit = hits[static_cast<std::size_t>(i)];
    out[static_cast<std::size_t>(i)] = {hit.body < 0 ? -1 : tables.view().idOf[hit.body], hit.fraction,
                                        hit.position, hit.n};
  });
  return out;
}

std::vector<std::vector<int>> idsByQuery(const HostTables& tables, const std::vector<int>& offsets,
                                         const std::vector<int>& bodies) {
  std::vector<std::vector<int>> out;
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    auto& ids = out.emplace_back(bodies.begin() + offsets[i], bodies.begin() + offsets[i + 1]);
    for (int& body : ids) body = tables.view().idOf[body];
    std::sort(ids.begin(), ids.end());
  }
  return out;
}

std::vector<EngineHit> runQueries(HostTables& tables, std::span<const EngineQuery> queries) {
  fillGrid(tables.view());
  const QueryBatch batch(tables, queries);
  std::vector<QueryHit> hits(batch.data.size());
  forEach(tables.view(), RunQuery{batch.data.data(), batch.shapes(), hits.data()}, batch.count());
  return engineHits(tables, hits);
}

std::vector<std::vector<int>> runOverlaps(HostTables& tables, std::span<const EngineQuery> queries) {
  fillGrid(tables.view());
  const QueryBatch batch(tables, queries);
  std::vector<int> offsets(batch.data.size() + 1);
  forEach(tables.view(), CountOverlaps{batch.data.data(), batch.shapes(), offsets.data()}, batch.count());
  int sum = 0;
  for (int& offset : offsets) sum += std::exchange(offset, sum);
  std::vector<int> bodies(static_cast<std::size_t>(sum));
  forEach(tables.view(), FillOverlaps{batch.data.data(), batch.shapes(), offsets.data(), bodies.data()},
          batch.count());
  return idsByQuery(tables, offsets, bodies);
}

}  // namespace rubble::RUBBLE_CORE
