#pragma once
/// What is listed once when deformable objects are made: who shares what, clusters, and the parts of
/// surfaces.
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

/// Which elements and attachments act on each vertex, and which vertices share one.
void connect(HostTables& tables);
/// The clusters of all objects by level, and the elements that leave each.
void placeClusters(HostTables& tables, const std::vector<EngineSoftObject>& objects);
/// What groups move as one: objects with clusters, then granular particles.
void placeLumps(HostTables& tables, const std::vector<EngineSoftObject>& objects);
/// Ropes and rods: what springs join one by one, without branches and not to a ring.
void placeLines(HostTables& tables, const std::vector<EngineSoftObject>& objects);
/// Edges and triangles of all surfaces that collide, and their grid.
void placeFeatures(HostTables& tables, const std::vector<EngineSoftObject>& objects);
/// Room for as many features, cells and owners of pairs as the view says.
void reserveFeatures(HostTables& tables);

}  // namespace rubble::RUBBLE_CORE
