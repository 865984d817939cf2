#pragma once
/// The interface through which a step launches its kernels.
#include <string_view>

#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

template <class L> struct SolveBody;
struct SolveVertex;

/// The name of a kernel's type, without namespace and template arguments, from the signature of kernelName().
/// GCC and Clang write "... [with Kernel = a::Name<...>; ...]", MSVC "... kernelName<struct a::Name<...>>".
constexpr std::string_view kernelNameIn(std::string_view signature) {
  constexpr std::string_view kGnu = "Kernel = ", kMsvc = "kernelName<";
  const std::size_t gnu = signature.find(kGnu);
  signature.remove_prefix(gnu != signature.npos ? gnu + kGnu.size() : signature.find(kMsvc) + kMsvc.size());
  signature = signature.substr(0, signature.find_first_of("<;]>"));
  return signature.substr(signature.find_last_of(": ") + 1);
}
template <class Kernel> constexpr std::string_view kernelName() {
#if defined(_MSC_VER) && !defined(__clang__)
  return kernelNameIn(__FUNCSIG__);
#elif defined(__GNUC__)
  return kernelNameIn(__PRETTY_FUNCTION__);
#else
  return Kernel::kStage;
#endif
}

/// Stands for any kernel: a functor f(SolverData, index). `kStage` is the name of its stage in timings,
/// profilers and comparisons between executors.
struct AnyKernel {
  static constexpr const char* kStage = "any";
  RUBBLE_HD void operator()(const SolverData&, int) const {}
};

/// Stands for any sequence of operations.
struct AnySequence {
  void operator()() const {}
};

/// When a kernel of rounds() runs: after the preceding one, or beside it because they share no data, or once
/// at the end.
enum class When { Next, Beside, AtEnd };
template <class KernelType, class N, When kW> struct Phase {
  using Kernel = KernelType;
  static constexpr When kWhen = kW;
  Kernel kernel;
  N count;  ///< of its elements: a number, or a counter
};
template <When kWhen = When::Next, class Kernel, class N>
Phase<Kernel, N, kWhen> phase(const Kernel& kernel, N n) {
  return {kernel, n};
}
/// When rounds() ends: no element is left, or there have been enough rounds.
struct Rounds {
  int Counters::*left;
  int Counters::*turn;  ///< counts the rounds
  /// A bound that is not reached: each round of a coloring, say, settles at least the clashing body of
  /// highest rank, so a few are enough.
  static constexpr int kMaxRounds = 10000;
  int most = kMaxRounds;
};

/// The operations that an executor offers to a step. `Counter` is a member of Counters: a number that the
/// step itself counts.
///
///   forEach(kernel, n)             n known before the step: bodies, joints
///   forEach(kernel, counter)       n counted in this step
///   beside(kernel, n or counter)   as forEach, for a kernel that shares no data with the preceding kernel,
///                                  nor with those launched beside that; they may run concurrently
///   forEachIn(kernel, offsets, k)  the range [offsets[k], offsets[k + 1])
///   forEachColor(kernel, vertexKernel)  color by color, over its bodies and its vertices
///   clear(array, n)                sets n elements to zero
///   scan(counts, offsets, n)       exclusive prefix sums; the total follows the last one
///   scan(counts, offsets, n, counter, per)  stores the total in a counter too, and reserves capacity for it
///   groupByKey(stage, keys, n, offsets, order, counter)  counting sort of the indices modulo nodes() by
///                                  ascending key; negative keys are left out. The counter receives the
///                                  number of keys. No key occurs at two levels (index / nodes())
///   require(per, counter)          reserves capacity before elements are written: none is dropped
///   rounds({left, turn}, take, propose...)  phases: runs `take`, sets `left` to zero and counts one more
///                                  `turn`, then runs all others in order, until they leave `left` at zero.
///                                  If there was a round, those AtEnd follow. To an observer it is one
///                                  kernel: how many rounds it has may depend on the order of elements
///   together(first, second)        two sequences of operations of which neither reads what the other one
///                                  writes; they may run concurrently. To an observer one follows the other
///   signal(), awaitSignal()        the second one may read what the first one has written before signal(),
///                                  from awaitSignal() on
///   aliasRows()                    contact rows reuse the memory of the old manifolds
///   swapManifolds()                manifolds of this step become the old ones of the next
///   Lane                           Real or Real4: the number of contact points that one call processes
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
  e.groupByKey(AnyKernel::kStage, &SolverData::aggregateOf, 1, &SolverData::aggregateOffset,
               &SolverData::aggregateNode, &Counters::aggregates);
  e.require(Per::Color, &Counters::colors);
  e.rounds(Rounds{&Counters::clashes, &Counters::rounds}, phase(AnyKernel{}, &Counters::clashing),
           phase(AnyKernel{}, &Counters::clashing), phase<When::AtEnd>(AnyKernel{}, 1));
  e.forEachColor(body, vertex);
  e.together(AnySequence{}, AnySequence{});
  e.signal();
  e.awaitSignal();
  e.aliasRows();
  e.swapManifolds();
};

/// Runs a kernel over the joints of all types, which are independent of one another. The element is a joint,
/// or one of its `kPerJoint` parts if the kernel declares that constant (joints/joints.h). `when`: after the
/// preceding kernel or beside it.
template <template <class> class Kernel, When when = When::Next, Executor E, class... Args>
void forEachJoint(E& e, Args... args) {
  bool first = when == When::Next;
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
