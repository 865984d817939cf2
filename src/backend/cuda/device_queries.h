#pragma once
/// Queries over tables on the device, by the functors of stages/queries/queries.h.
#include "backend/cuda/device_memory.h"
#include "collision/ray_arrays.h"
#include "stages/queries/queries.h"
#include "tables/records.h"

namespace rubble::RUBBLE_CORE {

/// `device`: tables on the device with their present sizes; `constants`: those of the host, by world.
class DeviceQueries {
 public:
  std::span<EngineQuery> room(std::size_t n) {
    room_.reserve(sizeof(EngineQuery) * n);
    return {reinterpret_cast<EngineQuery*>(room_.data()), n};
  }
  /// As Engine::hits and Engine::overlaps.
  std::span<const EngineHit> hits(const SolverData& device, const StepConstants* constants,
                                  const EngineQueries& asked, cudaStream_t stream);
  EngineOverlaps overlaps(const SolverData& device, const StepConstants* constants,
                          const EngineQueries& asked, cudaStream_t stream);
  /// As Engine::castRays. Nothing waits for the device.
  RayHitArrays hits(const SolverData& device, const StepConstants* constants, const EngineRays& rays,
                    cudaStream_t stream);
  /// Bodies have moved or changed since the last query.
  void moved() { filled_ = false; }

 private:
  /// Queries on the device.
  struct Asked {
    const EngineQuery* queries;
    QueryShapes shapes;
    int count;
  };
  Asked send(const EngineQueries& asked, cudaStream_t stream);
  /// Fills the grid at the present poses. The constants of the result have dt = 0.
  SolverData withGrid(const SolverData& device, const StepConstants* constants, cudaStream_t stream);
  /// Sums of the counts before each of n elements, and their total.
  void scan(const int* counts, int n, int* offsets, cudaStream_t stream);

  DeviceBuffer scratch_, still_, batch_, counts_, found_;
  DeviceBuffer shapes_, vectors_, indices_, parts_;  ///< of casts and overlaps
  PinnedBuffer room_, hits_, offsets_, bodies_;
  DeviceBuffer answers_, rayHits_;  ///< of rays that are arrays
  PinnedBuffer constants_;
  StreamEvent constantsSent_;
  bool filled_ = false;
};

}  // namespace rubble::RUBBLE_CORE
