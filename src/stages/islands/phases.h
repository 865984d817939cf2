#pragma once
/// Islands of connected bodies, for sleeping and for momentum conservation.
#include "stages/executor.h"
#include "stages/islands/island_momentum.h"
#include "stages/islands/sleep.h"
#include "stages/soft/soft_sleep.h"

namespace rubble::RUBBLE_CORE::islands {

/// Runs a kernel over the contacts and attachments by which deformable objects keep bodies awake.
template <template <class> class Kernel, Executor E> void forEachSoftNeighbor(E& e) {
  if (e.view().vertices == 0) return;
  e.forEach(Kernel<NearVertex>{}, &Counters::pointPairs);
  e.forEach(Kernel<HeldByVertices>{}, e.view().attachments);
}

/// Wakes islands that are disturbed.
template <Executor E> void wake(E& e) {
  if (!e.view().plan.sleeping) return;
  const int bodies = e.view().bodies;
  e.clear(&SolverData::islandFlag, bodies);
  e.forEach(WakeByForces{}, bodies);
  e.forEach(WakeByPairs{}, &Counters::pairs);
  forEachSoftNeighbor<WakeBySoft>(e);
  forEachJoint<WakeByJoints>(e);
  e.forEach(WakeBodies{}, bodies);
}

/// Puts islands at rest to sleep.
template <Executor E> void sleep(E& e) {
  if (!e.view().plan.sleeping) return;
  const int bodies = e.view().bodies;
  e.clear(&SolverData::islandFlag, bodies);
  e.forEach(StartIslands{}, bodies);
  e.forEach(JoinIslandsByPairs{}, &Counters::pairs);
  forEachJoint<JoinIslandsByJoints>(e);
  e.forEach(FindRestless{}, bodies);
  e.forEach(FindMovedIslands{}, &Counters::pairs);
  forEachSoftNeighbor<KeepAwakeBySoft>(e);
  e.forEach(FallAsleep{}, bodies);
}

/// Finds the free islands, which nothing holds, from the incidence lists.
template <Executor E> void findFree(E& e) {
  const SolverData& s = e.view();
  if (s.plan.literalRotations) return;
  const int bodies = s.bodies;
  if (!s.plan.coarseCorrection) e.forEach(StartIslandForest{}, bodies);
  e.forEach(JoinMomentumIslands{}, bodies);
  e.forEach(FindMomentumIslands{}, bodies);
  e.forEach(NumberFreeIslands{}, bodies);
  e.require(Per::FreeIsland, &Counters::freeIslands);
}

/// Restores the momenta of free islands. Begins beside what ends the step of bodies or trees.
template <Executor E> void keepMomenta(E& e) {
  const SolverData& s = e.view();
  if (s.plan.literalRotations) return;
  const int bodies = s.bodies;
  e.beside(BeginFreeIslands{}, bodies);
  e.forEach(MeasureMomenta{}, bodies);
  e.forEach(SumMomenta{}, bodies);
  e.forEach(RepairIslands{}, &Counters::freeIslands);
  e.forEach(RepairBodies{}, bodies);
}

}  // namespace rubble::RUBBLE_CORE::islands
