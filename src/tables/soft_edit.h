#pragma once
/// Edits and measures of deformable objects in host tables.
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

/// With std::bad_alloc nothing is changed.
void setSoft(HostTables& tables, const std::vector<EngineSoftObject>& objects,
             const std::vector<EngineAttachment>& attachments);
/// Counts the tetrahedra with a finite yield stress.
void countYielding(SolverData& s);
/// Slots in use of all kinds of elements of deformable objects. A loaded state must match them.
struct SoftCounts {
  int vertices, refs, tetraCorners, neighbors, particleCells, attachments;
  int elements[ElementTypes::kSize];
  int clusterBegin[kClusterLevels + 1], movingParts, clusterRefs, softNodes, objects, lines, strandVertices;
  float particleCell;
  int edges, features, featureCells;
  float featureCell;
};
SoftCounts softCounts(const SolverData& s);
/// Reserves memory for so many elements beside so many slots of bodies.
void reserveSoft(HostTables& tables, const SoftCounts& counts, int bodies);
void setSoftCounts(HostTables& tables, const SoftCounts& counts);

/// A copy of the persistent state of deformable objects, to which an edit without memory returns.
class SoftBackup {
 public:
  explicit SoftBackup(const HostTables& tables);
  void restore(HostTables& tables) const noexcept;

 private:
  SolverData view_;
  std::vector<std::size_t> sizes_;  ///< of each array [bytes]
  std::vector<std::byte> bytes_;
};

void setVertexStates(HostTables& tables, int first, std::span<const rubble::Vec3> positions,
                     std::span<const rubble::Vec3> velocities);
/// Clears the contacts of vertices with that body.
void forgetVertexContacts(HostTables& tables, int body);

}  // namespace rubble::RUBBLE_CORE
