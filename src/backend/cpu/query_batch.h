#pragma once
/// A batch of queries in the precision of the tables.
#include <optional>
#include <span>
#include <vector>

#include "backend/cpu/table_edit.h"
#include "stages/queries.h"

namespace rubble::RUBBLE_CORE {

/// Queries, with tables of the shapes that are asked with.
struct QueryBatch {
  std::vector<QueryData> data;
  std::optional<HostTables> shelf;  ///< none where no shape needs tables

  explicit QueryBatch(std::span<const EngineQuery> queries);
  ShapeTables tables() const { return shelf ? shelf->view().shapeTables() : ShapeTables{}; }
};

std::vector<EngineHit> engineHits(std::span<const QueryHit> hits);
/// Bodies [offsets[i], offsets[i + 1]) of each query i.
std::vector<std::vector<int>> bodiesByQuery(std::span<const int> offsets, std::span<const int> bodies);

}  // namespace rubble::RUBBLE_CORE
