#include <algorithm>
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
    addShape(tables_, *cooked, std::vector<int>(cooked->parts.size(), -1));
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

}  // namespace rubble::RUBBLE_CORE
