#pragma once
/// A device-side copy of all persistent state.
#include <memory>

#include "backend/cuda/device_memory.h"
#include "backend/engine.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

/// Table sizes at the time of a snapshot.
struct SnapshotSizes {
  int bodies = 0, planes = 0, exclusions = 0, pairs = 0, activePairs = 0, manifolds = 0;
  int shapeVectors = 0, shapeIndices = 0, shapeParts = 0, surfaces = 0, rollers = 0;
  TraitCounts traits;
  bool rolledBefore = false, oneWay = false;
  int joints[JointTypes::kSize] = {};
  int excludedPairs = 0, bodyIds = 0, jointIds[JointTypes::kSize] = {};
  /// Number of persistent elements of a kind.
  int count(Per per) const;
};
SnapshotSizes sizesOf(const HostTables& tables, int pairs, int activePairs, int manifolds);
/// Reserves and sets these sizes.
void adopt(HostTables& tables, const SnapshotSizes& sizes);

/// Authored arrays on the host, shared by all snapshots between two edits.
using AuthoredBytes = std::vector<std::byte>;
std::shared_ptr<const AuthoredBytes> copyAuthored(const HostTables& tables, const SnapshotSizes& sizes);
void putAuthored(HostTables& tables, const SnapshotSizes& sizes, const AuthoredBytes& bytes);

/// A copy of State arrays on the device, in memory that is used again.
class StateCopy {
 public:
  /// Copies in the order of the stream: all arrays, or those of the contacts of bodies.
  void take(const SnapshotSizes& sizes, const SolverData& device, bool contactsOnly, cudaStream_t stream);
  /// Pointers to the arrays that were taken.
  const SolverData& view() const { return view_; }

 private:
  DeviceBuffer data_;
  SolverData view_;
};

class DeviceSnapshot final : public EngineSnapshot {
 public:
  /// Copies in stream order, without synchronization.
  DeviceSnapshot(const SnapshotSizes& sizes, const SolverData& device,
                 std::shared_ptr<const AuthoredBytes> authored, cudaStream_t stream);

  /// Restores into device tables of sufficient capacity, in stream order.
  void put(const SolverData& device, cudaStream_t stream) const;
  /// As saveState() of the host engines.
  std::vector<std::byte> bytes() const override;

  const SnapshotSizes sizes;
  const std::shared_ptr<const AuthoredBytes> authored;
  Counters counters{};
  double previousDt = 0;
  bool hasForces = false;  ///< some forces are pending for the next step

 private:
  DeviceBuffer data_;
  StreamEvent made_;
};

}  // namespace rubble::RUBBLE_CORE
