#pragma once
/// What runs the kernels of a step.
#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

template <class L> struct SolveBody;
struct SolveVertex;

/// Stands for every kernel: a functor f(SolverData, index). Its name is that of its stage in times, profilers
/// and comparisons.
struct AnyKernel {
  static constexpr const char* kStage = "any";
  RUBBLE_HD void operator()(const SolverData&, int) const {}
};

/// What an executor offers to a step. `Counter` is a field of Counters: a number that the step counts itself.
///
///   forEach(kernel, n)             n known before the step: bodies, joints
///   forEach(kernel, counter)       n counted in this step
///   beside(kernel, n or counter)   as forEach, for a kernel that shares no data with the one before it, nor
///                                  with one that stands beside that
///   forEachIn(kernel, offsets, k)  the range [offsets[k], offsets[k + 1])
///   forEachColor(kernel, vertexKernel)  color by color, over its bodies and its vertices
///   clear(array, n)                zeros
///   scan(counts, offsets, n)       exclusive sums; the total behind the last one
///   scan(counts, offsets, n, counter, per)  the total in a counter too, and room for that many
///   groupByKey(keys, n, offsets, order, counter)  indices modulo nodes() by key, ascending; keys below 0 are
///                                  left out. The counter has the number of keys. No key is found at two
///                                  levels: index / nodes()
///   require(per, counter)          room for that many before they are written: nothing is dropped
///   rounds(take, propose, counter, left, turn)  takes turns of two kernels over as many as are counted, until
///                                  `propose` leaves `left` at zero; `turn` counts them
///   aliasRows()                    contact rows take the place of the old manifolds
///   swapManifolds()                manifolds of this step are the old ones of the next
///   Lane                           Real or Real4: points that one call treats side by side
template <class E>
concept Executor = requires(E e, const E& still, const SolveBody<typename E::Lane>& body,
                            const SolveVertex& vertex) {
  typename E::Lane;
  { still.view() } -> std::convertible_to<const SolverData&>;
  e.forEach(AnyKernel{}, 1);
  e.forEach(AnyKernel{}, &Counters::pairs);
  e.beside(AnyKernel{}, 1);
  e.beside(AnyKernel{}, &Counters::pairs);
  e.forEachIn(AnyKernel{}, &SolverData::levelAggregate, 0);
  e.clear(&SolverData::pairCount, 1);
  e.clear(&SolverData::colorCount, &Counters::colors);
  e.scan(&SolverData::bucketCount, &SolverData::bucketOffset, 1);
  e.scan(&SolverData::pairCount, &SolverData::pairOffset, 1, &Counters::pairs, Per::Pair);
  e.scan(&SolverData::isActive, &SolverData::activePairOffset, &Counters::pairs, &Counters::activePairs,
         Per::ActivePair);
  e.groupByKey(&SolverData::aggregateOf, 1, &SolverData::aggregateOffset, &SolverData::aggregateNode,
               &Counters::aggregates);
  e.require(Per::Color, &Counters::colors);
  e.rounds(AnyKernel{}, AnyKernel{}, &Counters::clashing, &Counters::clashes, &Counters::rounds);
  e.forEachColor(body, vertex);
  e.aliasRows();
  e.swapManifolds();
};

/// Kernel over the joints of every type, which do not wait for one another: over each joint, or over so many
/// of its parts as it says by `kPerJoint` (joints/joints.h).
template <template <class> class Kernel, Executor E, class... Args> void forEachJoint(E& e, Args... args) {
  bool first = true;
  forEachType(JointTypes{}, [&]<class F>() {
    int elements = e.view().joints[typeIndex<F>(JointTypes{})];
    if constexpr (requires { Kernel<F>::kPerJoint; }) elements *= Kernel<F>::kPerJoint;
    if (elements == 0) return;
    if (first)
      e.forEach(Kernel<F>{args...}, elements);
    else
      e.beside(Kernel<F>{args...}, elements);
    first = false;
  });
}

}  // namespace rubble::RUBBLE_CORE
