#pragma once
/// Bodies: begin and end of their step, the graph of what acts on them, and the sweep over them and vertices.
#include "stages/executor.h"
#include "stages/bodies/coloring.h"
#include "stages/joints/phases.h"
#include "stages/soft/phases.h"

namespace rubble::RUBBLE_CORE::bodies {

/// Inertial targets and initial guesses.
template <Executor E>
void predict(E& e) {
  e.forEach(PredictBodies{}, e.view().bodies);
}

/// The row blocks that act on each body.
template <Executor E>
void findIncidence(E& e) {
  const int bodies = e.view().bodies;
  const auto forEachBlock = [&]<template <class> class Kernel>() {
    e.forEach(Kernel<ContactBlocks>{}, &Counters::manifolds);
    forEachType(JointTypes{}, [&]<class F>() { e.beside(Kernel<JointBlocks<F>>{}, e.view().joints[typeIndex<F>(JointTypes{})]); });
  };
  e.clear(&View::entryCount, bodies);
  forEachBlock.template operator()<CountEntries>();
  soft::countEntries(e);
  e.scan(&View::entryCount, &View::entryOffset, bodies, &Counters::entries, Per::Entry);
  forEachBlock.template operator()<FillEntries>();
  soft::fillEntries(e);
  e.forEach(SortEntries{}, bodies);
}

/// Colors of bodies and vertices.
template <Executor E>
void color(E& e) {
  const int bodies = e.view().bodies;
  e.forEach(FindClashes{}, bodies);
  e.forEach(FindVertexClashes{}, e.view().vertices);
  e.rounds(TakeColors{}, ProposeColors{}, &Counters::clashing, &Counters::clashes, &Counters::rounds);
  e.require(Per::Color, &Counters::colors);
  e.clear(&View::colorCount, &Counters::colors);
  e.forEach(CountColors{}, bodies);
  e.scan(&View::colorCount, &View::colorOffset, &Counters::colors);
  e.forEach(FillColors{}, bodies);
  soft::listColors(e);
}

/// One sweep, color by color: each body and vertex makes a step of its own.
template <Executor E>
void sweep(E& e) {
  joints::linearize(e);
  e.forEachColor(SolveBody<typename E::Lane>{}, SolveVertex{});
}

/// Poses and velocities at the end of the step.
template <Executor E>
void finish(E& e) {
  e.forEach(FinishBodies{}, e.view().bodies);
}

}  // namespace rubble::RUBBLE_CORE::bodies
