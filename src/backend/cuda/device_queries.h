#pragma once
/// Queries over tables on the device, by the functors of stages/queries/queries.h.
#include "backend/cuda/device_memory.h"
#include "tables/query_batch.h"

namespace rubble::RUBBLE_CORE {

class DeviceQueries {
 public:
  /// `s`: tables on the device with their present sizes; `constants`: those of the host. Both wait for their
  /// answers.
  std::vector<QueryHit> run(const SolverData& s, const StepConstants& constants, const QueryBatch& batch,
                            cudaStream_t stream);
  /// The bodies of query i are [offsets[i], offsets[i + 1]).
  void overlaps(const SolverData& s, const StepConstants& constants, const QueryBatch& batch,
                cudaStream_t stream, std::vector<int>& offsets, std::vector<int>& bodies);
  /// Bodies have moved or changed since the last query.
  void moved() { filled_ = false; }

 private:
  /// Fills the grid at the present poses. The constants of the result have dt = 0.
  SolverData withGrid(const SolverData& s, const StepConstants& constants, cudaStream_t stream);
  /// Queries and the tables of their shapes on the device.
  struct Sent {
    const QueryData* queries;
    ShapeTables shapes;
  };
  Sent send(const QueryBatch& batch, cudaStream_t stream);

  DeviceBuffer scratch_, batch_, answers_, still_;
  PinnedBuffer sent_, hits_;
  bool filled_ = false;
};

}  // namespace rubble::RUBBLE_CORE
