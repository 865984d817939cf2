#pragma once
/// Steps tables on the device. This header is plain host code; device code is behind it.
#include <memory>
#include <string>
#include <vector>

#include <rubble/ranks.h>
#include <rubble/report.h>

#include "backend/cuda/device_memory.h"
#include "backend/observable_engine.h"
#include "tables/state_rows.h"

namespace rubble {
class Transport;
}

namespace rubble::RUBBLE_CORE {

/// Runs the step as one CUDA graph per configuration (sizes, pointers, constants). A configuration that
/// occurs for the first time runs without a graph. A step that exceeds a table's capacity stops on the device
/// before it writes. The host then grows the table and continues from the operation that stopped.
class CudaStepper {
 public:
  explicit CudaStepper(const CudaOptions& options);
  ~CudaStepper();

  DeviceTables& tables();
  const DeviceTables& tables() const;
  cudaStream_t stream() const;
  /// Returns whether the device counts the elements of this kind, so that the stepper manages its capacity.
  bool counted(Per per) const;
  std::size_t bytes() const;

  /// Takes one step with the sizes of `host`, whose pointers are not used, and the constants on the device.
  /// Adds restarts and stage times to the report.
  Counters step(const SolverData& host, StepReport& report);

  /// Divides steps among the GPUs of the ranks of a transport, which must outlive the stepper.
  void divide(Transport& transport, const RankOptions& options);
  /// All ranks get the state of all pairs and joints. `host`: sizes. Returns whether it was not there
  /// already.
  bool gatherState(const SolverData& host);
  /// The tables were replaced or sorted. All ranks have the whole state.
  void restart();
  /// Of the last step, by rank, without times.
  std::vector<RankReport> reports() const;

  /// While there is an observer, kernels run one by one and without graphs.
  void observe(KernelObserver observer);

  // stages/pairs/order.h, with the sizes of `host` and that many old pairs
  void sortBodies(const SolverData& host, int pairs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Sizes and plan of `host` with the pointers of `device`.
inline SolverData onDevice(const SolverData& host, const SolverData& device) {
  SolverData s = host;
  forEachArray([&](const auto& array) { s.*array.member = device.*array.member; });
  s.counters = device.counters, s.step = device.step;
  return s;
}

/// Small kernels of edits, all in the order of the stream.
///
/// Copies element k of `from` to element slots[k] of `to`. All pointers are device memory, elements are
/// arrays of 4-byte words.
struct ScatterPiece {
  void* to;
  const void* from;
  const int* slots;
  int count, words;
};
/// Scatters all pieces, some tens per launch.
void scatterPieces(cudaStream_t stream, const std::vector<ScatterPiece>& pieces);
/// The arrays of forEachMotionArray() for one body.
struct BodyMotionState {
  Vec3d position;
  Quat orientation;
  Vec3 velocity, angularVelocity, previousVelocity;
  int asleep;
  Real stillTime;
};
/// Writes the state of a body to page-locked memory.
void readMotion(cudaStream_t stream, const SolverData& device, int slot, BodyMotionState* to);
/// changeVelocity() of distinct bodies.
void addVelocities(cudaStream_t stream, const SolverData& device, const int* slots, const Vec3d* changes,
                   int count);
/// Copies element placeOf[id] of `from` to element `id` of `to`. Elements are arrays of 4-byte words.
void gatherById(cudaStream_t stream, void* to, const void* from, const int* placeOf, int count, int words);
void scatterStateRows(cudaStream_t stream, const SolverData& device, const ScatterRows& rows, int count);
/// Clears the old manifolds of these bodies (sorted slots, device memory).
void forgetContactsOf(cudaStream_t stream, const SolverData& device, const int* slots, int count, int pairs);
/// Clears the old contacts of vertices with these bodies. `pairs`: capacity.
void forgetVertexContactsOf(cudaStream_t stream, const SolverData& device, const int* slots, int count,
                            int pairs);
/// Initializes the old pair offsets of new bodies [begin, end), which own no pairs.
void startPairOffsets(cudaStream_t stream, const SolverData& device, int begin, int end);
/// The same for owners [begin, end), the corners of new bodies.
void startCornerOffsets(cudaStream_t stream, const SolverData& device, int begin, int end);

/// Text of cudaStatus() (info.h) if the backend is built.
std::string deviceStatus();
bool deviceReady();

}  // namespace rubble::RUBBLE_CORE
