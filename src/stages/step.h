#pragma once
/// The step: algorithm 1 of the method [P A], written once over an Executor, which decides what runs in
/// parallel and where. Each subsystem keeps its phases in its own folder and returns at once if the world
/// does not use it.
#include "stages/bodies/phases.h"
#include "stages/bounces/phases.h"
#include "stages/ccd/phases.h"
#include "stages/coarse/phases.h"
#include "stages/columns/phases.h"
#include "stages/contacts/phases.h"
#include "stages/islands/phases.h"
#include "stages/joints/phases.h"
#include "stages/pairs/phases.h"
#include "stages/soft/cluster_phases.h"
#include "stages/soft/phases.h"
#include "stages/soft/strand_phases.h"
#include "stages/trees/phases.h"

namespace rubble::RUBBLE_CORE {

/// Clears the arrays in which kernels of the step count or raise numbers.
template <Executor E> void clear(E& e) {
  pairs::clear(e);
  contacts::clear(e);
  trees::clear(e);
  coarse::clear(e);
  bodies::clear(e);
}

/// Detects collisions and builds constraint rows, incidence lists and colors at x^t. Bodies move only to
/// their initial guess.
template <Executor E> void prepare(E& e) {
  clear(e);
  pairs::find(e);
  bodies::predict(e);
  soft::findPairs(e);
  islands::wake(e);
  contacts::prepare(e);
  joints::prepare(e);
  soft::prepare(e);
  clusters::prepare(e);
  trees::prepare(e);
  coarse::findAggregates(e);
  e.together(
      [&] {
        bodies::findIncidence(e);
        e.signal();
        columns::find(e);
        trees::findSoftTrees(e);
        bodies::color(e);
        islands::findFree(e);
      },
      [&] {
        coarse::listAggregates(e);
        e.awaitSignal();
        coarse::findBoundaries(e);
      });
  soft::predict(e);
  clusters::prepare(e);
}

/// One iteration: each block solver takes a descent step, then the multipliers are updated.
template <Executor E> void iterate(E& e, int n, bool last) {
  coarse::solve(e, n);
  clusters::solve(e);
  trees::solve(e, last);
  strands::solve(e);
  columns::solve(e);
  bodies::sweep(e);
  soft::accelerate(e, n);
  if (last) coarse::keepMomentum(e), trees::solveLast(e);
  contacts::updateDuals(e, last);
  joints::updateDuals(e);
  soft::updateDuals(e);
}

/// Computes velocities and stores the state that persists to the next step.
template <Executor E> void finish(E& e) {
  soft::keepApart(e);
  joints::finish(e);
  soft::finishRows(e);
  contacts::finish(e);
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
  const int iterations = e.view().plan.iterations;
  prepare(e);
  for (int n = 0; n < iterations; ++n) iterate(e, n, n + 1 == iterations);
  finish(e);
}

}  // namespace rubble::RUBBLE_CORE
