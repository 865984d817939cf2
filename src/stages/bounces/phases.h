#pragma once
/// Restitution of impacts.
#include "stages/bounces/bounce.h"
#include "stages/executor.h"

namespace rubble::RUBBLE_CORE::bounces {

/// Finds the contacts that bounce, before velocities are known.
template <Executor E> void find(E& e) {
  if (!e.view().bounces) return;
  e.forEach(StartBounces{}, e.view().bodies);
  e.forEach(FindBounces{}, &Counters::bounceRows);
  e.rounds({&Counters::bounceSpread, &Counters::bounceSpreads}, phase(ReachBounces{}, &Counters::bounceRows),
           phase(FindReach{}, &Counters::bounceRows));
}

/// Applies impulses of restitution, once velocities are known.
template <Executor E> void act(E& e) {
  if (!e.view().bounces) return;
  const int bodies = e.view().bodies;
  e.forEach(TakeBackBounces{}, bodies);
  e.forEach(CheckBounces{}, &Counters::bounceRows);
  e.rounds({&Counters::bounceBound, &Counters::bounceBounds}, phase(ReachSolved{}, &Counters::bounceRows),
           phase(FindSolved{}, &Counters::bounceRows));
  e.forEach(RestoreSolved{}, bodies);
  e.forEach(ProposeBounces{}, &Counters::bounceRows);
  e.rounds({&Counters::bounceLeft, &Counters::bounceRounds}, phase(ActBounces{}, &Counters::bounceRows),
           phase(ProposeBounces{}, &Counters::bounceRows));
  e.forEach(EndBounces{}, &Counters::bounceRows);
}

}  // namespace rubble::RUBBLE_CORE::bounces
