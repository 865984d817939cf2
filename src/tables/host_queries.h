#pragma once
/// Queries over tables in host memory. Their memory is kept from call to call.
#include "tables/host_tables.h"
#include "tables/records.h"

namespace rubble::RUBBLE_CORE {

class HostQueries {
 public:
  std::span<EngineQuery> room(std::size_t n) {
    if (room_.size() < n) room_.resize(n);
    return {room_.data(), n};
  }
  /// As Engine::hits and Engine::overlaps. May overwrite the grid.
  std::span<const EngineHit> hits(HostTables& tables, const EngineQueries& asked);
  EngineOverlaps overlaps(HostTables& tables, const EngineQueries& asked);
  EngineAllHits allHits(HostTables& tables, const EngineQueries& asked);

 private:
  std::vector<EngineQuery> room_;
  std::vector<EngineHit> hits_;
  std::vector<int> offsets_, bodies_;
};

}  // namespace rubble::RUBBLE_CORE
