#pragma once
/// Loops over several threads: those of oneTBB (RUBBLE_HAS_TBB), or of a Team. No result depends on which.
#include <algorithm>
#include <cstddef>
#include <utility>

#if defined(RUBBLE_HAS_TBB)
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#else
#include "platform/team.h"
#endif

namespace rubble {

#if defined(RUBBLE_HAS_TBB)

/// A number of threads for the loops below.
class Threads {
 public:
  /// `count`: 0 for as many as the processor runs at once.
  explicit Threads(int count) : arena_(count > 0 ? count : tbb::task_arena::automatic) {}
  int count() { return arena_.max_concurrency(); }
  /// Calls f(), whose loops run on these threads.
  template <class F> void run(F&& f) { arena_.execute(std::forward<F>(f)); }

 private:
  tbb::task_arena arena_;
};

/// Calls f(begin, end) for ranges that make up [0, n): about as many as there are threads, none below `grain`
/// unless it is the only one.
template <class F> void forEachShare(int n, int grain, F&& f) {
  const auto body = [&](const tbb::blocked_range<int>& range) { f(range.begin(), range.end()); };
  tbb::parallel_for(tbb::blocked_range<int>(0, n, static_cast<std::size_t>(grain)), body,
                    tbb::static_partitioner{});
}

/// Calls f(begin, end) for ranges that make up [0, n), of `grain` and more: threads that are done early take
/// what others have left.
template <class F> void forEachRange(std::size_t n, std::size_t grain, F&& f) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) { f(range.begin(), range.end()); });
}

/// Calls f(k) for k = 0 .. n - 1, each a task of its own.
template <class F> void forEachTask(std::size_t n, F&& f) {
  tbb::parallel_for(std::size_t{0}, n, std::forward<F>(f), tbb::simple_partitioner{});
}

/// std::sort. `less` must be a total order.
template <class Iterator, class Less> void sortOnThreads(Iterator begin, Iterator end, Less less) {
  tbb::parallel_sort(begin, end, less);
}

#else

class Threads {
 public:
  explicit Threads(int count) : team_(count) {}
  int count() const { return team_.threads(); }
  template <class F> void run(F&& f) {
    const Own own(&team_);
    f();
  }
  /// The team of the innermost run() of this thread; null outside, where loops run on the calling thread.
  static Team* current() { return team(); }

 private:
  static Team*& team() {
    thread_local Team* current = nullptr;
    return current;
  }
  struct Own {
    explicit Own(Team* own) : outer(std::exchange(team(), own)) {}
    ~Own() { team() = outer; }
    Team* const outer;
  };
  Team team_;
};

template <class F> void forEachTask(std::size_t n, F&& f) {
  if (Team* const team = Threads::current())
    team->run(n, f);
  else
    for (std::size_t k = 0; k < n; ++k) f(k);
}

/// f(begin, end) for `parts` ranges of the same size.
template <class N, class F> void forEachOf(N parts, N n, F&& f) {
  forEachTask(static_cast<std::size_t>(parts), [&](std::size_t k) {
    const auto at = [&](std::size_t part) {
      return static_cast<N>(static_cast<unsigned long long>(n) * part / static_cast<std::size_t>(parts));
    };
    f(at(k), at(k + 1));
  });
}

template <class F> void forEachShare(int n, int grain, F&& f) {
  const Team* const team = Threads::current();
  if (n > 0) forEachOf(std::clamp(n / grain, 1, team ? team->threads() : 1), n, f);
}

template <class F> void forEachRange(std::size_t n, std::size_t grain, F&& f) {
  const Team* const team = Threads::current();
  // a few ranges for each thread balance them
  const std::size_t most = team ? 8 * static_cast<std::size_t>(team->threads()) : 1;
  if (n > 0) forEachOf(std::clamp(n / grain, std::size_t{1}, most), n, f);
}

template <class Iterator, class Less> void sortOnThreads(Iterator begin, Iterator end, Less less) {
  std::sort(begin, end, less);
}

#endif

}  // namespace rubble
