#pragma once
/// Edits and measures of deformable objects in host tables.
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

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
void setSoftCounts(HostTables& tables, const SoftCounts& counts);

void setVertexStates(HostTables& tables, int first, std::span<const rubble::Vec3> positions,
                     std::span<const rubble::Vec3> velocities);
/// Clears the contacts of vertices with that body.
void forgetVertexContacts(HostTables& tables, int body);

}  // namespace rubble::RUBBLE_CORE
