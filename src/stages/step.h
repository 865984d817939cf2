#pragma once
/// The step on one page: algorithm 1 of the method, written once over an Executor. What runs in parallel, and where, is its business.
#include "stages/coloring.h"

namespace rubble::RUBBLE_CORE {

/// What an executor offers. A kernel is a functor f(View, index); `Counter` is a field of Counters.
///
///   forEach(kernel, n)                      n known before the step: bodies, joints
///   forEach(kernel, counter)                n counted in this step
///   clear(array, n)                         zeros
///   scan(counts, offsets, n[, counter])     exclusive sums, the total behind the last one and in the counter
///   require(per, counter)                   room for that many, or the step is begun again with more
///   untilZero(counter, round)               repeats round() until it leaves the counter at zero
///   forEachColor(kernel)                    colour by colour, over its bodies
///   keepManifolds()                         those of this step are the old ones of the next
///   Lane                                    Real or Real4: points that one call treats side by side
template <class E>
concept Executor = requires(E e, View& v) {
  typename E::Lane;
  e.forEach(PredictBodies{}, 1);
  e.forEach(StoreContacts{}, &Counters::manifolds);
  e.clear(&View::pairCount, 1);
  e.scan(&View::pairCount, &View::pairOffset, 1, &Counters::pairs);
  e.require(Per::Pair, &Counters::pairs);
  e.forEachColor(SolveBody<typename E::Lane>{});
};

template <Executor E>
void findPairs(E& e) {
  const int bodies = e.view().bodies, cells = e.view().cells;
  e.clear(&View::bucketCount, cells);
  e.forEach(ComputeBounds{}, bodies);
  e.scan(&View::bucketCount, &View::bucketOffset, cells);
  e.forEach(FillGrid{}, bodies);
  e.forEach(FindPairs{}, bodies);
  e.scan(&View::pairCount, &View::pairOffset, bodies, &Counters::pairs);
  e.require(Per::Pair, &Counters::pairs);
  e.forEach(WritePairs{}, bodies);
}

template <Executor E>
void findContacts(E& e) {
  e.forEach(UpdateManifolds{}, &Counters::pairs);
  e.scan(&View::touching, &View::rowOfPair, &Counters::pairs, &Counters::manifolds);
  e.require(Per::Manifold, &Counters::manifolds);
  e.forEach(BuildContactRows{}, &Counters::pairs);
}

template <Executor E>
void findIncidence(E& e) {
  const int bodies = e.view().bodies;
  const auto forEachBlock = [&]<template <class> class Kernel>() {
    e.forEach(Kernel<ContactBlocks>{}, &Counters::manifolds);
    forEachType(JointTypes{}, [&]<class F>() { e.forEach(Kernel<JointBlocks<F>>{}, e.view().joints[typeIndex<F>(JointTypes{})]); });
  };
  e.clear(&View::entryCount, bodies);
  forEachBlock.template operator()<CountEntries>();
  e.scan(&View::entryCount, &View::entryOffset, bodies, &Counters::entries);
  e.require(Per::Entry, &Counters::entries);
  forEachBlock.template operator()<FillEntries>();
  e.forEach(SortEntries{}, bodies);
}

template <Executor E>
void colorBodies(E& e) {
  const int bodies = e.view().bodies;
  e.untilZero(&Counters::clashes, [&] {
    e.forEach(ProposeColors{}, bodies);
    e.forEach(TakeColors{}, bodies);
  });
  e.require(Per::Color, &Counters::colors);
  e.clear(&View::colorCount, &Counters::colors);
  e.forEach(CountColors{}, bodies);
  e.scan(&View::colorCount, &View::colorOffset, &Counters::colors);
  e.forEach(FillColors{}, bodies);
}

/// One step of dt. Everything before the iterations happens at x^t and changes no body.
template <Executor E>
void step(E& e) {
  using L = typename E::Lane;
  const int bodies = e.view().bodies;
  const auto forEachJoint = [&]<template <class> class Kernel>() {
    forEachType(JointTypes{}, [&]<class F>() { e.forEach(Kernel<F>{}, e.view().joints[typeIndex<F>(JointTypes{})]); });
  };

  findPairs(e);
  findContacts(e);
  forEachJoint.template operator()<BeginJoints>();
  findIncidence(e);
  colorBodies(e);

  e.forEach(PredictBodies{}, bodies);
  e.forEach(MarkDormant{}, &Counters::manifolds);

  for (int n = 0; n < e.view().step.iterations; ++n) {
    e.forEachColor(SolveBody<L>{});
    e.forEach(UpdateContactDuals<L>{}, &Counters::manifolds);
    forEachJoint.template operator()<UpdateJointDuals>();
  }

  e.forEach(StoreContacts{}, &Counters::manifolds);
  forEachJoint.template operator()<FinishJoints>();
  e.forEach(FinishBodies{}, bodies);
  e.keepManifolds();
}

}  // namespace rubble::RUBBLE_CORE
