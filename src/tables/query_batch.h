#pragma once
/// Queries in the precision and the slots of tables, and their answers as ids.
#include <optional>

#include "stages/queries/queries.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

struct QueryBatch {
  QueryBatch(const HostTables& tables, std::span<const EngineQuery> queries);

  int count() const { return static_cast<int>(data.size()); }
  ShapeTables shapes() const { return shelf ? shelf->view().shapeTables() : ShapeTables{}; }

  std::vector<QueryData> data;
  std::optional<HostTables> shelf;  ///< tables of the query shapes
};

std::vector<EngineHit> engineHits(const HostTables& tables, std::span<const QueryHit> hits);
/// The ids of [offsets[i], offsets[i + 1]) for each query, ascending.
std::vector<std::vector<int>> idsByQuery(const HostTables& tables, const std::vector<int>& offsets,
                                         const std::vector<int>& bodies);

}  // namespace rubble::RUBBLE_CORE
