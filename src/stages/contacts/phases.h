#pragma once
/// Contacts of bodies: manifolds, rows and their multipliers.
#include "stages/executor.h"
#include "stages/bodies/corrections.h"
#include "stages/contacts/rare_contacts.h"
#include "stages/contacts/rolling.h"
#include "stages/bounces/bounce.h"

namespace rubble::RUBBLE_CORE::contacts {

/// Manifolds and rows at x^t.
template <Executor E>
void prepare(E& e) {
  const View& s = e.view();
  e.clear(&View::agitation, s.bodies);
  e.forEach(FindAgitation{}, &Counters::pairs);
  e.forEach(FindNearPairs{}, &Counters::pairs);
  e.forEach(TestFreshPairs{}, &Counters::freshPairs);
  e.scan(&View::isNear, &View::nearPairOffset, &Counters::pairs, &Counters::nearPairs, Per::NearPair);
  e.forEach(ListNearPairs{}, &Counters::pairs);
  e.forEach(RecycleManifolds{}, &Counters::nearPairs);
  e.forEach(TestPairs{}, &Counters::tested);
  if (s.rareShapes) e.forEach(TestRarePairs{}, &Counters::tested);
  e.scan(&View::hasRows, &View::rowOffset, &Counters::nearPairs, &Counters::manifolds, Per::Manifold);
  if (s.rolls) {
    e.forEach(CountRolling{}, 1);
    e.require(Per::Rolling, &Counters::rollers);
    e.forEach(BuildRolling{}, &Counters::rollers);
  }
  e.lodgeRows();
  e.forEach(BuildContactRows{}, &Counters::nearPairs);
  if (!s.bounces) return;
  e.forEach(CountBounces{}, 1);
  e.require(Per::Bounce, &Counters::bounceRows);
}

template <Executor E>
void updateDuals(E& e, bool last) {
  using L = typename E::Lane;
  if (last) e.forEach(FinishContacts<L>{}, &Counters::manifolds);
  else e.forEach(UpdateContactDuals<L>{}, &Counters::manifolds);
  if (e.view().rolls) e.forEach(UpdateRollingDuals{}, &Counters::manifolds);
}

/// How far the correction of penetrations will move each body in the next step.
template <Executor E>
void finish(E& e) {
  e.forEach(FindCorrections{}, e.view().bodies);
}

}  // namespace rubble::RUBBLE_CORE::contacts
