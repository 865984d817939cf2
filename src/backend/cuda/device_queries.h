#pragma once
/// Rays over tables on the device, by the functors of stages/queries/queries.h.
#include "backend/cuda/device_memory.h"
#include "tables/query_batch.h"

namespace rubble::RUBBLE_CORE {

class DeviceQueries {
 public:
  /// `s`: tables on the device with their present sizes; `constants`: those of the host. Waits for the hits,
  /// which are valid until the next call.
  std::span<const QueryHit> castRays(const SolverData& s, const StepConstants& constants,
                                     const QueryBatch& batch, cudaStream_t stream);
  /// Bodies have moved or changed since the last query.
  void moved() { filled_ = false; }

 private:
  /// Fills the grid at the present poses. The constants of the result have dt = 0.
  SolverData withGrid(const SolverData& s, const StepConstants& constants, cudaStream_t stream);
  DeviceBuffer scratch_, batch_, still_;
  PinnedBuffer sent_, hits_;
  Pinned<StepConstants> constants_;  ///< those in still_
  bool filled_ = false;
};

}  // namespace rubble::RUBBLE_CORE
