#pragma once
/// Strands (ropes and rods): all vertices of a strand form one block.
#include "stages/executor.h"
#include "stages/soft/strands.h"

namespace rubble::RUBBLE_CORE::strands {

/// One Newton step on all vertices of each strand.
template <Executor E> void solve(E& e) {
  const SolverData& s = e.view();
  if (!s.plan.jointTrees || s.strands == 0) return;
  if (s.features > 0)
    e.forEach(AssembleStrands<true>{}, s.strandVertices);
  else
    e.forEach(AssembleStrands<false>{}, s.strandVertices);
  e.forEach(SolveStrand{}, s.strands);
  e.forEach(TakeStrandForces{}, s.strandVertices);
  e.forEach(MoveStrands{}, s.strandVertices);
}

}  // namespace rubble::RUBBLE_CORE::strands
