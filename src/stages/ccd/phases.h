#pragma once
/// Continuous collision detection: bodies that move farther in a step than contact rows can anticipate stop
/// at their time of impact.
#include "stages/ccd/general_impacts.h"
#include "stages/ccd/islands.h"
#include "stages/ccd/unpaired_impacts.h"
#include "stages/executor.h"

namespace rubble::RUBBLE_CORE::ccd {

/// Stops fast bodies at the first thing that they would pass. Begins beside contacts::finish(), with which it
/// shares no data.
template <Executor E> void stop(E& e) {
  const SolverData& s = e.view();
  e.beside(FlagFast{}, s.bodies);
  const bool joints = s.hasJoints();
  if (joints) {
    e.forEach(StartCcdIslands{}, s.bodies);
    forEachJoint<JoinCcdIslands>(e);
  }
  e.forEach(ListSweptPairs{}, &Counters::swept);
  e.forEach(FindImpacts{}, &Counters::sweptPairs);
  if (s.generalShapes) e.forEach(FindGeneralImpacts{}, &Counters::sweptPairs);
  e.beside(FindUnpairedImpacts{}, &Counters::searchedBodies);
  e.rounds({&Counters::ccdImpacts, &Counters::ccdRounds, kCcdRounds},
           phase(BeginCcdRound{}, &Counters::fastBodies), phase(ListStopped{}, &Counters::fastBodies),
           phase(FindImpacts{}, &Counters::sweptPairs),
           phase<When::Beside>(FindGeneralImpacts{}, &Counters::sweptPairs),
           phase<When::Beside>(FindUnpairedImpacts{}, &Counters::searchedBodies),
           phase<When::AtEnd>(RaiseIslandShares{}, s.bodies), phase<When::AtEnd>(StopCcdIslands{}, s.bodies),
           phase<When::AtEnd>(ChooseCcdPairs{}, &Counters::sweptPairs),
           phase<When::AtEnd>(StopBodies{}, &Counters::sweptPairs),
           phase<When::AtEnd>(StopUnpairedBodies{}, s.bodies));
}

}  // namespace rubble::RUBBLE_CORE::ccd
