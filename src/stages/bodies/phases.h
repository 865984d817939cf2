#pragma once
/// Bodies: begin and end of the step, the constraint graph, and the sweep over bodies and vertices.
#include "stages/bodies/coloring.h"
#include "stages/executor.h"
#include "stages/joints/phases.h"
#include "stages/soft/phases.h"

namespace rubble::RUBBLE_CORE::bodies {

template <Executor E> void clear(E& e) { e.clear(&SolverData::incidenceCount, e.view().bodies); }

/// Inertial targets and initial guesses. Begins beside what writes pairs, with which it shares no data.
template <Executor E> void predict(E& e) { e.beside(PredictBodies{}, e.view().bodies); }

/// The incidence list of each body.
template <Executor E> void findIncidence(E& e) {
  const int bodies = e.view().bodies;
  const auto forEachBlock = [&]<template <class> class Kernel>() {
    e.forEach(Kernel<ContactBlocks>{}, &Counters::manifolds);
    forEachType(JointTypes{}, [&]<class F>() {
      e.beside(Kernel<JointBlocks<F>>{}, e.view().joints[typeIndex<F>(JointTypes{})]);
    });
  };
  forEachBlock.template operator()<CountIncidences>();
  soft::countIncidences(e);
  e.scan(&SolverData::incidenceCount, &SolverData::incidenceOffset, bodies, &Counters::incidences,
         Per::Incidence);
  forEachBlock.template operator()<FillIncidences>();
  soft::fillIncidences(e);
  e.forEach(SortIncidences{}, bodies);
}

/// Colors of bodies and vertices.
template <Executor E> void color(E& e) {
  const int bodies = e.view().bodies;
  e.forEach(FindClashes{}, bodies);
  e.forEach(FindVertexClashes{}, e.view().vertices);
  e.rounds({&Counters::clashes, &Counters::rounds}, phase(TakeColors{}, &Counters::clashing),
           phase(ProposeColors{}, &Counters::clashing));
  e.require(Per::Color, &Counters::colors);
  e.clear(&SolverData::colorCount, &Counters::colors);
  e.forEach(CountColors{}, bodies);
  e.scan(&SolverData::colorCount, &SolverData::colorOffset, &Counters::colors);
  e.forEach(FillColors{}, bodies);
  soft::listColors(e);
}

/// One sweep, color by color: each body and vertex takes a step of its own.
template <Executor E> void sweep(E& e) {
  joints::linearize(e);
  e.forEachColor(SolveBody<typename E::Lane>{}, SolveVertex{});
}

/// Poses and velocities at the end of the step.
template <Executor E> void finish(E& e) { e.forEach(FinishBodies{}, e.view().bodies); }

}  // namespace rubble::RUBBLE_CORE::bodies
