#pragma once
/// Restitution of impacts.
#include "stages/bounces/bounce.h"
#include "stages/executor.h"

namespace rubble::RUBBLE_CORE::bounces {

/// Before velocities are known: finds the contacts that take part.
template <Executor E> void find(E& e) {
  if (!e.view().bounces) return;
  e.forEach(StartBounces{}, e.view().bodies);
  e.forEach(FindBounces{}, &Counters::bounceRows);
  e.rounds(ReachBounces{}, FindReach{}, &Counters::bounceRows, &Counters::bounceSpread,
           &Counters::bounceSpreads);
}

/// After velocities are known: applies impulses.
template <Executor E> void act(E& e) {
  if (!e.view().bounces) return;
  const int bodies = e.view().bodies;
  e.forEach(TakeBackBounces{}, bodies);
  e.forEach(CheckBounces{}, &Counters::bounceRows);
  e.rounds(ReachSolved{}, FindSolved{}, &Counters::bounceRows, &Counters::bounceBound,
           &Counters::bounceBounds);
  e.forEach(RestoreSolved{}, bodies);
  e.forEach(ProposeBounces{}, &Counters::bounceRows);
  e.rounds(ActBounces{}, ProposeBounces{}, &Counters::bounceRows, &Counters::bounceLeft,
           &Counters::bounceRounds);
  e.forEach(EndBounces{}, &Counters::bounceRows);
}

}  // namespace rubble::RUBBLE_CORE::bounces
