#pragma once
/// Ropes and rods: all vertices of one are a block.
#include "stages/executor.h"
#include "stages/soft/lines.h"

namespace rubble::RUBBLE_CORE::lines {

template <Executor E>
void solve(E& e) {
  const View& s = e.view();
  if (!s.step.jointTrees || s.lines == 0) return;
  if (s.features > 0) e.forEach(AssembleLines<true>{}, s.lineVertices);
  else e.forEach(AssembleLines<false>{}, s.lineVertices);
  e.forEach(SolveLine{}, s.lines);
  e.forEach(TakeLineForces{}, s.lineVertices);
  e.forEach(MoveLines{}, s.lineVertices);
}

}  // namespace rubble::RUBBLE_CORE::lines
