#pragma once
/// The shapes of queries in the precision of the tables.
#include "stages/queries/queries.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

class QueryShelf {
 public:
  explicit QueryShelf(std::span<const std::shared_ptr<const CookedShape>> shapes);
  QueryShapes view() { return {shapes_.data(), tables_.view().shapeTables()}; }
  std::span<const ShapeData> shapes() const { return shapes_; }
  const HostTables& tables() const { return tables_; }

 private:
  std::vector<ShapeData> shapes_;
  HostTables tables_;
};

}  // namespace rubble::RUBBLE_CORE
