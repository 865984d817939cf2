#pragma once
/// The coarse correction of deformable objects: rigid motions of clusters of vertices.
#include "stages/executor.h"
#include "stages/soft/clusters.h"
#include "stages/soft/spin.h"

namespace rubble::RUBBLE_CORE::clusters {

/// Centers and mean velocities of the clusters.
template <Executor E> void prepare(E& e) {
  const int* const begin = e.view().clusterBegin;
  if (e.view().vertices == 0) return;
  e.forEach(PlaceClusters{}, begin[1]);
  e.forEach(PlaceLargeClusters{}, begin[kClusterLevels] - begin[1]);
}

/// One sweep over the clusters of every level, from coarse to fine.
template <Executor E> void solve(E& e) {
  if (!e.view().plan.coarseCorrection || e.view().vertices == 0) return;
  const int* const begin = e.view().clusterBegin;
  for (int level = kClusterLevels - 1; level >= 0; --level) {
    const int clusters = level > 0 ? begin[level + 1] - begin[level] : e.view().movingParts,
              parts = level > 0 ? begin[1] : clusters;
    if (clusters == 0) continue;
    if (e.view().features > 0)
      e.forEach(SumCluster<true>{}, parts);
    else
      e.forEach(SumCluster<false>{}, parts);
    e.forEach(SolveCluster{level}, clusters);
    e.forEach(MoveCluster{level}, parts);
  }
}

/// Restores the angular momentum of free solids that implicit Euler dissipates.
template <Executor E> void keepSpin(E& e) {
  if (e.view().softNodes == 0) return;
  e.forEach(SumSpins{}, e.view().clusterBegin[1]);
  e.forEach(FindSpins{}, e.view().softNodes);
}

}  // namespace rubble::RUBBLE_CORE::clusters
