#pragma once
/// Continuous collision detection: bodies that move farther in a step than contact rows can anticipate stop
/// at their time of impact.
#include "stages/ccd/assembly_stops.h"
#include "stages/ccd/general_stops.h"
#include "stages/ccd/late_stops.h"
#include "stages/executor.h"

namespace rubble::RUBBLE_CORE::ccd {

template <Executor E> void stop(E& e) {
  const SolverData& s = e.view();
  e.forEach(FlagFast{}, s.bodies);
  e.require(Per::Pair, &Counters::swept);
  const bool joints = s.hasJoints();
  if (joints) {
    e.forEach(StartAssemblies{}, s.bodies);
    forEachJoint<JoinAssemblies>(e);
  }
  for (int round = 0; round < kStopRounds; ++round) {
    if (round > 0) e.forEach(NoteStops{round}, s.bodies);
    e.forEach(FindStops{round}, &Counters::swept);
    if (s.generalShapes) e.forEach(FindGeneralStops{round}, &Counters::swept);
    if (round == 0) e.forEach(FindLateStops{}, s.bodies);
  }
  if (joints) {
    e.forEach(RaiseStops{}, s.bodies);
    e.forEach(StopAssemblies{}, s.bodies);
  }
  e.forEach(ChooseStops{}, &Counters::swept);
  e.forEach(StopBodies{}, &Counters::swept);
  e.forEach(StopLateBodies{}, s.bodies);
}

}  // namespace rubble::RUBBLE_CORE::ccd
