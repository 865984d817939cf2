#pragma once
/// Columns: bodies stacked on one another form one block.
#include "stages/columns/columns.h"
#include "stages/executor.h"

namespace rubble::RUBBLE_CORE::columns {

/// Finds the columns from the incidence lists.
template <Executor E> void find(E& e) {
  const SolverData& s = e.view();
  if (!s.plan.jointTrees) return;
  e.forEach(FindColumnLinks{}, s.bodies);
  e.forEach(MeasureColumns{}, s.bodies);
  e.scan(&SolverData::columnCount, &SolverData::columnOffset, s.bodies, &Counters::columnNodes,
         Per::ColumnNode);
  e.forEach(FillColumns{}, s.bodies);
}

/// One Newton step on all bodies of each column.
template <Executor E> void solve(E& e) {
  if (!e.view().plan.jointTrees) return;
  e.forEach(AssembleColumns<typename E::Lane>{}, &Counters::columnNodes);
  e.forEach(SolveColumns{}, &Counters::columnNodes);
}

}  // namespace rubble::RUBBLE_CORE::columns
