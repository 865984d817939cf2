#pragma once
/// A copy on the device of all that lasts from step to step.
#include <memory>

#include "backend/cuda/device_memory.h"
#include "backend/engine.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

/// Sizes of the tables that a snapshot is of.
struct SnapshotSizes {
  int bodies = 0, planes = 0, exclusions = 0, pairs = 0, activePairs = 0, manifolds = 0;
  int shapeVectors = 0, shapeIndices = 0, shapeParts = 0, surfaces = 0, rollers = 0;
  TraitCounts traits;
  bool rolledBefore = false;
  int joints[JointTypes::kSize] = {};
  /// Elements of a kind of which something lasts.
  int count(Per per) const;
};
SnapshotSizes sizesOf(const HostTables& tables, int pairs, int activePairs, int manifolds);
/// Makes room for those sizes and sets them.
void adopt(HostTables& tables, const SnapshotSizes& sizes);

/// What edits have authored, on the host: shared by all snapshots between two edits.
using AuthoredBytes = std::vector<std::byte>;
std::shared_ptr<const AuthoredBytes> copyAuthored(const HostTables& tables, const SnapshotSizes& sizes);
void putAuthored(HostTables& tables, const SnapshotSizes& sizes, const AuthoredBytes& bytes);

class DeviceSnapshot final : public EngineSnapshot {
 public:
  /// Copies in the order of the stream; nobody waits.
  DeviceSnapshot(const SnapshotSizes& sizes, const SolverData& device,
                 std::shared_ptr<const AuthoredBytes> authored, cudaStream_t stream);

  /// Back into tables of the device that have the room, in the order of the stream.
  void put(const SolverData& device, cudaStream_t stream) const;
  /// As saveState() of the host engines.
  std::vector<std::byte> bytes() const override;

  const SnapshotSizes sizes;
  const std::shared_ptr<const AuthoredBytes> authored;
  Counters counters{};
  double previousDt = 0;
  bool hasForces = false;  ///< some wait for the next step

 private:
  DeviceBuffer data_;
  StreamEvent made_;
};

}  // namespace rubble::RUBBLE_CORE
