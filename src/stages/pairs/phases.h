#pragma once
/// Broad phase: the pairs of bodies that may touch in the step.
#include "stages/executor.h"
#include "stages/pairs/broad_phase.h"

namespace rubble::RUBBLE_CORE::pairs {

/// Runs Kernel<parts>, which searches parts only if some body has any.
template <template <bool> class Kernel, Executor E> void forEachOwner(E& e) {
  if (e.view().generalShapes)
    e.forEach(Kernel<true>{}, e.view().bodies);
  else
    e.forEach(Kernel<false>{}, e.view().bodies);
}

template <Executor E> void clear(E& e) { e.clear(&SolverData::bucketCount, e.view().cells); }

/// Finds the bodies whose boxes touch or will touch.
template <Executor E> void find(E& e) {
  const int bodies = e.view().bodies, cells = e.view().cells;
  e.forEach(ComputeBounds{}, bodies);
  e.require(Per::PathCell, &Counters::pathCells);
  e.scan(&SolverData::bucketCount, &SolverData::bucketOffset, cells);
  e.forEach(ClearCellPaths{}, &Counters::pathCells);
  e.forEach(FillGrid{}, bodies);
  e.forEach(LinkSubcells{}, &Counters::pathCells);
  e.forEach(BeginSearches{}, bodies);
  e.forEach(ForgetSearchers{}, bodies);
  e.forEach(FindNeighbors{}, &Counters::searched);
  e.beside(FindPathNeighbors{}, &Counters::pathCells);
  forEachOwner<FindPairs>(e);
  e.scan(&SolverData::pairCount, &SolverData::pairOffset, bodies, &Counters::pairs, Per::Pair);
  forEachOwner<WritePairs>(e);
}

}  // namespace rubble::RUBBLE_CORE::pairs
