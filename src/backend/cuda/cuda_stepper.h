#pragma once
/// Steps tables on the device. Host code: what is compiled for the device lies behind it.
#include <memory>
#include <string>
#include <vector>

#include <rubble/report.h>

#include "backend/cuda/device_memory.h"
#include "tables/state_rows.h"

namespace rubble::RUBBLE_CORE {

/// Runs the step as one CUDA graph a configuration (sizes, pointers, constants); a configuration seen for the
/// first time runs without one. A step that lacks room stops on the device before it does harm; the host
/// makes room and goes on where it stopped.
class CudaStepper {
 public:
  /// `timings`: measure stages.
  explicit CudaStepper(bool timings);
  ~CudaStepper();

  DeviceTables& tables();
  const DeviceTables& tables() const;
  cudaStream_t stream() const;
  /// Is this kind one whose number the device counts, so that its room is the stepper's business?
  bool counted(Per per) const;
  std::size_t bytes() const;

  /// One step with the sizes and constants of `host`, whose pointers are not used. Adds to restarts and
  /// stages of the report.
  Counters step(const SolverData& host, StepReport& report);

  // stages/pairs/order.h, with the sizes of `host` and so many old pairs
  void sortBodies(const SolverData& host, int pairs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Small kernels of edits; all run in the order of the stream.
///
/// Element k of `from` goes to element slots[k] of `to`; all on the device, elements of so many 4-byte words.
struct ScatterPiece {
  void* to;
  const void* from;
  const int* slots;
  int count, words;
};
/// One launch for up to some tens of pieces.
void scatterPieces(cudaStream_t stream, const std::vector<ScatterPiece>& pieces);
/// changeVelocity() of bodies that differ from one another.
void addVelocities(cudaStream_t stream, const SolverData& device, const int* slots, const Vec3d* changes,
                   int count);
/// Element `id` of `to` becomes element placeOf[id] of `from`, of so many 4-byte words each.
void gatherById(cudaStream_t stream, void* to, const void* from, const int* placeOf, int count, int words);
void scatterStateRows(cudaStream_t stream, const SolverData& device, const ScatterRows& rows, int count);
/// Old manifolds of these bodies (sorted, on the device) are emptied.
void forgetContactsOf(cudaStream_t stream, const SolverData& device, const int* slots, int count, int pairs);
/// Likewise those of vertices with these bodies; `pairs`: room for them.
void forgetVertexContactsOf(cudaStream_t stream, const SolverData& device, const int* slots, int count,
                            int pairs);
/// Bodies [begin, end) are new and own no old pairs.
void startPairOffsets(cudaStream_t stream, const SolverData& device, int begin, int end);
/// Likewise owners [begin, end), which are corners of new bodies.
void startCornerOffsets(cudaStream_t stream, const SolverData& device, int begin, int end);

/// What cudaStatus() of info.h says when the backend is built.
std::string deviceStatus();
bool deviceReady();

}  // namespace rubble::RUBBLE_CORE
