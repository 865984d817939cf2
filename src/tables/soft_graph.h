#pragma once
/// Precomputed topology of deformable objects: incidence lists, clusters and surface features.
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

/// Lists the elements and attachments of each vertex, and the vertices that share one.
void connect(HostTables& tables);
/// Places the clusters of all objects by level, and lists the boundary elements of each.
void placeClusters(HostTables& tables, const std::vector<EngineSoftObject>& objects);
/// Lists the soft nodes: objects with clusters, then granular particles.
void placeSoftNodes(HostTables& tables, const std::vector<EngineSoftObject>& objects);
/// Lists the strands: chains of springs without branches that are not closed.
void placeStrands(HostTables& tables, const std::vector<EngineSoftObject>& objects);
/// Places edges and triangles of all colliding surfaces, and sizes their grid.
void placeFeatures(HostTables& tables, const std::vector<EngineSoftObject>& objects);
/// Reserves features, grid cells and pair owners for the counts of `s`.
void reserveFeatures(HostTables& tables, const SolverData& s);

}  // namespace rubble::RUBBLE_CORE
