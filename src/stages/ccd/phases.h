#pragma once
/// Continuous collision detection: bodies that move farther in a step than contact rows can anticipate stop
/// at their time of impact.
#include "stages/ccd/general_impacts.h"
#include "stages/ccd/islands.h"
#include "stages/ccd/unpaired_impacts.h"
#include "stages/executor.h"

namespace rubble::RUBBLE_CORE::ccd {

template <Executor E> void stop(E& e) {
  const SolverData& s = e.view();
  e.forEach(FlagFast{}, s.bodies);
  const bool joints = s.hasJoints();
  if (joints) {
    e.forEach(StartCcdIslands{}, s.bodies);
    forEachJoint<JoinCcdIslands>(e);
  }
  for (int round = 0; round < kCcdRounds; ++round) {
    if (round > 0) {
      e.forEach(BeginCcdRound{round}, &Counters::fastBodies);
      e.forEach(ListStopped{round}, &Counters::fastBodies);
    }
    e.forEach(FindImpacts{round}, &Counters::swept);
    if (s.generalShapes) e.forEach(FindGeneralImpacts{round}, &Counters::swept);
    e.beside(FindUnpairedImpacts{round}, &Counters::searchedBodies);
  }
  if (joints) {
    e.forEach(RaiseIslandShares{}, s.bodies);
    e.forEach(StopCcdIslands{}, s.bodies);
  }
  e.forEach(ChooseCcdPairs{}, &Counters::swept);
  e.forEach(StopBodies{}, &Counters::swept);
  e.forEach(StopUnpairedBodies{}, s.bodies);
}

}  // namespace rubble::RUBBLE_CORE::ccd
