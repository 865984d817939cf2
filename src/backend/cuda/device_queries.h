#pragma once
/// Queries over tables on the device: the functors of stages/queries.h, a thread a query.
#include "backend/cpu/query_batch.h"
#include "backend/cuda/device_memory.h"

namespace rubble::RUBBLE_CORE {

class DeviceQueries {
 public:
  /// `view`: of the device, with the sizes that its tables have now. Both wait for their answers.
  std::vector<EngineHit> run(View view, const QueryBatch& batch, cudaStream_t stream);
  std::vector<std::vector<int>> overlaps(View view, const QueryBatch& batch, cudaStream_t stream);

 private:
  /// Enqueues the grid at the present poses.
  void fillGrid(View& view, cudaStream_t stream);
  /// Queries and the tables of their shapes on the device.
  struct Sent {
    const QueryData* queries;
    ShapeTables tables;
  };
  Sent send(const QueryBatch& batch, cudaStream_t stream);

  DeviceBuffer scratch_, batch_, answers_;
};

}  // namespace rubble::RUBBLE_CORE
