#pragma once
/// Contacts between rigid bodies: manifolds, rows and multipliers.
#include "stages/bodies/corrections.h"
#include "stages/bounces/bounce.h"
#include "stages/contacts/general_contacts.h"
#include "stages/contacts/one_way.h"
#include "stages/contacts/rolling.h"
#include "stages/executor.h"

namespace rubble::RUBBLE_CORE::contacts {

template <Executor E> void clear(E& e) { e.clear(&SolverData::impactSpeedBound, e.view().bodies); }

/// Builds manifolds and rows at x^t.
template <Executor E> void prepare(E& e) {
  using L = typename E::Lane;
  const SolverData& s = e.view();
  e.forEach(FindImpactSpeedBounds{}, &Counters::pairs);
  e.forEach(FindActivePairs{}, &Counters::pairs);
  e.forEach(TestNewPairs{}, &Counters::newPairs);
  e.scan(&SolverData::isActive, &SolverData::activePairOffset, &Counters::pairs, &Counters::activePairs,
         Per::ActivePair);
  e.forEach(ListActivePairs{}, &Counters::pairs);
  e.forEach(RecycleManifolds<L>{}, &Counters::activePairs);
  e.forEach(TestPairs{}, &Counters::tested);
  if (s.generalShapes) e.forEach(TestGeneralPairs{}, &Counters::tested);
  if (s.oneWay) e.forEach(DecideOneWay{}, &Counters::activePairs);
  e.scan(&SolverData::hasRows, &SolverData::rowOffset, &Counters::activePairs, &Counters::manifolds,
         Per::Manifold);
  if (s.rolls) {
    e.forEach(CountRolling{}, 1);
    e.require(Per::Rolling, &Counters::rollers);
    e.forEach(BuildRolling{}, &Counters::rollers);
  }
  e.aliasRows();
  e.forEach(BuildContactRows<L>{}, &Counters::activePairs);
  e.forEach(AddArcs{}, &Counters::activePairs);
  if (!s.bounces) return;
  e.forEach(CountBounces{}, 1);
  e.require(Per::Bounce, &Counters::bounceRows);
}

/// Multipliers, stiffness and friction states.
template <Executor E> void updateDuals(E& e, bool last) {
  using L = typename E::Lane;
  if (last)
    e.forEach(FinishContacts<L>{}, &Counters::manifolds);
  else
    e.forEach(UpdateContactDuals<L>{}, &Counters::manifolds);
  if (e.view().rolls) e.forEach(UpdateRollingDuals{}, &Counters::manifolds);
}

/// Finds the displacement by which penetration correction will move each body in the next step.
template <Executor E> void finish(E& e) { e.forEach(FindCorrections{}, e.view().bodies); }

}  // namespace rubble::RUBBLE_CORE::contacts
