#pragma once
/// The executor for the threads of a processor. Kernels write only elements of their own index, so results do
/// not depend on the number of threads.
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include <rubble/report.h>

#include "backend/cpu/counting.h"
#include "backend/cpu/privatized_count.h"
#include "backend/cpu/simd4_kernels.h"
#include "backend/cpu/stage_clock.h"
#include "backend/division.h"
#include "backend/kernel_observer.h"
#include "platform/threads.h"
#include "stages/step.h"
#include "tables/host_tables.h"
#include "tables/state_rows.h"

namespace rubble::RUBBLE_CORE {

class CpuExecutor {
 public:
  using Lane = Real4;

  /// `timings`: measure stage times. `tasks`: run all loops, if given. `memory`: of the tables.
  explicit CpuExecutor(int threads, bool timings = true, TaskSystem tasks = {},
                       const MemorySystem& memory = {})
      : tables_(memory), threads_(threads, std::move(tasks)), timings_(timings) {}

  HostTables& tables() { return tables_; }
  const HostTables& tables() const { return tables_; }
  SolverData& view() { return tables_.view(); }
  const SolverData& view() const { return tables_.view(); }

  void observe(KernelObserver observer) { observer_ = std::move(observer); }
  /// Divides steps among ranks; null: this executor runs all of a step.
  void divide(Division* division) { division_ = division; }
  /// Disables SIMD kernels, privatized counts and searches that last: from now on each loop takes its
  /// elements one by one, the last one first. Results must not depend on it.
  void takeBackward() { backward_ = view().searchesAlways = true; }

  /// Most ranges that loops have use for.
  int threads() const { return threads_.count(); }
  /// Runs f() on the threads of this executor.
  template <class F> void run(F&& f) { threads_.run(f); }

  template <class Kernel> void forEach(const Kernel& kernel, int n) {
    enter<Kernel>();
    runAll(kernel, n);
  }
  template <class Kernel> void forEach(const Kernel& kernel, int Counters::*n) {
    forEach(kernel, view().counters->*n);
  }

  template <class Kernel, class N> void beside(const Kernel& kernel, N n) { forEach(kernel, n); }

  template <class Kernel> void forEachIn(const Kernel& kernel, Array<int> SolverData::*offsets, int k) {
    enter<Kernel>();
    const SolverData& s = view();
    const int begin = (s.*offsets)[k];
    if constexpr (isDivided<Kernel>())
      if (division_) return runPart(kernel, (s.*offsets)[k + 1] - begin, k);
    run(s, kernel, (s.*offsets)[k + 1] - begin, [begin](int i) { return begin + i; });
  }

  void clear(Array<int> SolverData::*array, int n) { clearOnThreads(view().*array, n, threads_.count()); }
  void clear(Array<int> SolverData::*array, int Counters::*n) { clear(array, view().counters->*n); }

  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, int n) {
    scanOnThreads(view().*counts, view().*offsets, n, threads_.count());
  }
  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, int Counters::*n) {
    scan(counts, offsets, view().counters->*n);
  }
  template <class N>
  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, N n, int Counters::*total,
            Per per) {
    if (division_ && counts == &SolverData::hasRows) division_->share(Share::Touches, 0);
    scan(counts, offsets, n);
    view().counters->*total = (view().*offsets)[countOf(n)];
    require(per, total);
  }

  void groupByKey(const char* stage, Array<int> SolverData::*keys, int n, Array<int> SolverData::*offsets,
                  Array<int> SolverData::*order, int Counters::*keyCount) {
    if (timings_) clock_.enter(stage);
    const SolverData& s = view();
    countingSort_.run(s.*keys, n, s.nodes(), s.counters->*keyCount, s.*offsets, s.*order, threads_.count());
  }

  void require(Per per, int Counters::*count) {
    const int needed = view().counters->*count;
    if (needed <= tables_.capacity(per)) return;
    tables_.reserve(per, needed);
    grown_.push_back({kindName(per), needed});
  }

  template <class Take, class... Others>
  void rounds(const Rounds& of, const Take& take, const Others&... others) {
    int &left = view().counters->*of.left, &turn = view().counters->*of.turn;
    const auto runIf = [&](bool wanted, const auto& phase) {
      if (wanted) runAll(phase.kernel, countOf(phase.count));
    };
    enter<typename Take::Kernel>();
    while (left != 0 && turn < of.most) {
      runIf(true, take);
      left = 0;
      ++turn;
      (runIf(Others::kWhen != When::AtEnd, others), ...);
    }
    (runIf(Others::kWhen == When::AtEnd && turn != 0, others), ...);
  }

  template <class Kernel, class VertexKernel>
  void forEachColor(const Kernel& kernel, const VertexKernel& vertexKernel) {
    enter<Kernel>();
    const SolverData& s = view();
    for (int c = 0; c < s.counters->colors; ++c) {
      const int begin = s.colorOffset[c];
      if (division_)
        runPart(kernel, division_->color(c)), division_->share(Share::ColorPoses, c);
      else
        run(s, kernel, s.colorOffset[c + 1] - begin,
            [of = s.colorBody, begin](int k) { return of[begin + k]; });
      if (s.vertices == 0) continue;
      const int first = s.vertexColorOffset[c];
      run(s, vertexKernel, s.vertexColorOffset[c + 1] - first,
          [of = s.colorVertex, first](int k) { return of[first + k]; });
    }
  }

  template <class First, class Second> void together(First&& first, Second&& second) {
    first();
    second();
  }
  void signal() {}
  void awaitSignal() {}

  void aliasRows() { tables_.aliasRows(); }
  void swapManifolds() {
    if (division_) division_->share(Share::Counts, 0);
    if (observer_) observer_("between steps", "");
    tables_.swapManifolds();
  }

  // Scratch memory between steps, used by stages/pairs/order.h.
  template <class T> T* room(int n) {
    const HostMemory& memory = tables_.memory();
    std::unique_ptr<void, Release> own(memory.allocate(sizeof(T) * static_cast<std::size_t>(n)), {&memory});
    rooms_.push_back(std::move(own));
    return static_cast<T*>(rooms_.back().get());
  }
  void order(const std::uint64_t* keys, int* to, int n) {
    std::iota(to, to + n, 0);
    sortOnThreads({to, static_cast<std::size_t>(n)}, keys);
  }
  template <class T> void copy(T* to, const T* from, int n) { std::copy_n(from, n, to); }
  /// Releases the scratch memory.
  void endRooms() { rooms_.clear(); }

  /// Stage times since the last call [ms].
  std::vector<StageTime> takeTimes() { return clock_.take(); }
  /// Tables that have grown since the last call.
  std::vector<Growth> takeGrown() { return std::exchange(grown_, {}); }

 private:
  int countOf(int n) const { return n; }
  int countOf(int Counters::*n) const { return view().counters->*n; }

  /// Begins a kernel of a stage.
  template <class Kernel> void enter() {
    if (observer_) observer_(Kernel::kStage, kernelName<Kernel>());
    if (timings_) clock_.enter(Kernel::kStage);
  }

  template <class Kernel> void runAll(const Kernel& kernel, int n) {
    if constexpr (isDivided<Kernel>())
      if (division_) return runPart(kernel, n, Divided<Kernel>::which(kernel));
    const SolverData& s = view();
    if constexpr (requires { InParts<Kernel>::run(s, kernel, 0, n); })
      if (!backward_)
        return forRange(n, [&](int begin, int end) { InParts<Kernel>::run(s, kernel, begin, end); });
    run(s, kernel, n, [](int i) { return i; });
  }

  /// Runs the elements of this rank. What another rank counts does not count here.
  template <class Kernel> void runPart(const Kernel& kernel, const Division::Part& part) {
    const SolverData& s = view();
    const auto runRange = [&](int begin, int end) {
      run(s, kernel, end - begin,
          [index = part.index, begin](int k) { return index ? index[begin + k] : begin + k; });
    };
    runRange(0, part.counted);
    if (part.count == part.counted) return;
    constexpr int Counters::*kReported[] = {&Counters::contacts, &Counters::recycled, &Counters::failedSolves,
                                            &Counters::boundedSteps, &Counters::broken};
    int before[std::size(kReported)];
    std::ranges::transform(kReported, before, [&](int Counters::*c) { return s.counters->*c; });
    runRange(part.counted, part.count);
    for (std::size_t k = 0; k < std::size(kReported); ++k) s.counters->*kReported[k] = before[k];
  }
  template <class Kernel> void runPart(const Kernel& kernel, int n, int which) {
    using D = Divided<Kernel>;
    if constexpr (D::kBefore != Share::None) division_->share(D::kBefore, which);
    runPart(kernel, division_->part(D::kCut, n, which));
    if constexpr (D::kAfter != Share::None) division_->share(D::kAfter, which);
  }

  /// Calls the kernel for at(0), ..., at(n - 1), four at a time if it has a SIMD version.
  template <class Kernel, class At> void run(const SolverData& s, const Kernel& kernel, int n, const At& at) {
    forRange(n, [&s, own = kernel, at, backward = backward_](int begin, int end) {
      int i = begin;
      if constexpr (requires(const Lane4& four) { Simd4Kernel<Kernel>::run(s, four); })
        for (; i + kLanes <= end && !backward; i += kLanes) {
          const auto four = [&](auto&& f, int k) {
            if (k + kLanes <= end) f({at(k), at(k + 1), at(k + 2), at(k + 3)});
          };
          if constexpr (requires(const Lane4& a) { Simd4Kernel<Kernel>::expect(s, a); }) {
            four([&](const Lane4& a) { Simd4Kernel<Kernel>::expect(s, a); }, i + kAhead * kLanes);
            four([&](const Lane4& a) { Simd4Kernel<Kernel>::prepare(s, a); }, i + kLanes);
          }
          four([&](const Lane4& a) { Simd4Kernel<Kernel>::run(s, a); }, i);
        }
      const int first = backward ? begin + end - 1 : 0, step = backward ? -1 : 1;
      for (; i < end; ++i) own(s, at(first + step * i));
    });
  }
  /// Calls f(begin, end) for subranges of [0, n) in parallel.
  void forRange(int n, FunctionRef<void(int, int)> f) {
    // Ranges of as few elements are worth a thread: a body with its contacts takes 1 us, an aggregate more.
    constexpr int kGrain = 8;
    if (n <= kGrain || threads_.count() == 1) return f(0, n);
    forEachShare(n, kGrain, f);
  }

  struct Release {
    const HostMemory* memory;
    void operator()(void* room) const { memory->release(room); }
  };

  HostTables tables_;
  std::vector<std::unique_ptr<void, Release>> rooms_;
  CountingSort countingSort_;
  Threads threads_;
  bool timings_;
  bool backward_ = false;
  Division* division_ = nullptr;
  KernelObserver observer_;
  StageClock clock_;
  std::vector<Growth> grown_;
};

}  // namespace rubble::RUBBLE_CORE
