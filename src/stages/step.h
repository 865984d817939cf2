#pragma once
/// The step on one page: algorithm 1 of the method, written once over an Executor. What runs in parallel, and
/// where, is its business. Each subsystem has its phases in a folder of its own, and returns at once where a
/// world has nothing of its kind.
#include "stages/bodies/phases.h"
#include "stages/bounces/phases.h"
#include "stages/ccd/phases.h"
#include "stages/coarse/phases.h"
#include "stages/contacts/phases.h"
#include "stages/islands/phases.h"
#include "stages/joints/phases.h"
#include "stages/pairs/phases.h"
#include "stages/soft/cluster_phases.h"
#include "stages/soft/phases.h"
#include "stages/soft/strand_phases.h"
#include "stages/trees/phases.h"

namespace rubble::RUBBLE_CORE {

/// Rows and blocks, at x^t. No body moves beyond its initial guess.
template <Executor E> void prepare(E& e) {
  bodies::predict(e);
  pairs::find(e);
  soft::findPairs(e);
  islands::wake(e);
  contacts::prepare(e);
  joints::prepare(e);
  soft::prepare(e);
  clusters::prepare(e);
  trees::prepare(e);
  coarse::findAggregates(e);
  bodies::findIncidence(e);
  trees::findSoftTrees(e);
  bodies::color(e);
  soft::predict(e);
  coarse::prepare(e);
  clusters::prepare(e);
}

/// One iteration: each block solver makes its step of descent, then multipliers follow.
template <Executor E> void iterate(E& e, int n, bool last) {
  coarse::solve(e, n);
  clusters::solve(e);
  trees::solve(e, last);
  strands::solve(e);
  bodies::sweep(e);
  soft::accelerate(e, n);
  if (last) coarse::keepMomentum(e), trees::solveLast(e);
  contacts::updateDuals(e, last);
  joints::updateDuals(e);
  soft::updateDuals(e);
}

/// Velocities, and what lasts until the next step.
template <Executor E> void finish(E& e) {
  contacts::finish(e);
  soft::keepApart(e);
  joints::finish(e);
  soft::finishRows(e);
  ccd::stop(e);
  bounces::find(e);
  bodies::finish(e);
  bounces::act(e);
  trees::finish(e);
  islands::keepMomenta(e);
  clusters::keepSpin(e);
  soft::finish(e);
  islands::sleep(e);
  e.swapManifolds();
}

/// One step of dt.
template <Executor E> void step(E& e) {
  const int iterations = e.view().step.iterations;
  prepare(e);
  for (int n = 0; n < iterations; ++n) iterate(e, n, n + 1 == iterations);
  finish(e);
}

}  // namespace rubble::RUBBLE_CORE
