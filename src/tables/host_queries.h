#pragma once
/// Queries over tables in host memory. Their memory is kept from call to call.
#include <rubble/tasks.h>

#include "tables/host_tables.h"
#include "tables/records.h"

namespace rubble::RUBBLE_CORE {

class HostQueries {
 public:
  /// `tasks`: of the host, for loops. Must outlive this object.
  explicit HostQueries(const TaskSystem& tasks) : tasks_(tasks) {}
  std::span<EngineQuery> room(std::size_t n) {
    if (room_.size() < n) room_.resize(n);
    return {room_.data(), n};
  }
  /// As Engine::hits and Engine::overlaps. May overwrite the grid.
  std::span<const EngineHit> hits(HostTables& tables, const EngineQueries& asked);
  EngineOverlaps overlaps(HostTables& tables, const EngineQueries& asked);
  EngineAllHits allHits(HostTables& tables, const EngineQueries& asked);

 private:
  template <class Kernel> void forEach(const SolverData& s, const Kernel& kernel, std::size_t n);

  const TaskSystem& tasks_;
  std::vector<EngineQuery> room_;
  std::vector<EngineHit> hits_;
  std::vector<int> offsets_, bodies_;
};

}  // namespace rubble::RUBBLE_CORE
