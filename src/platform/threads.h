#pragma once
/// Loops over several threads: tasks of the host, threads of oneTBB (RUBBLE_HAS_TBB), or those of a Team. No
/// result depends on which.
#include <algorithm>
#include <cstddef>
#include <exception>
#include <mutex>
#include <utility>

#include <rubble/tasks.h>

#if defined(RUBBLE_HAS_TBB)
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#else
#include "platform/team.h"
#endif

namespace rubble {

/// What runs the loops of this thread: the tasks of the host or a Team of the innermost scope, or null.
template <class T> T*& currentOf() {
  thread_local T* current = nullptr;
  return current;
}
template <class T> struct Current {
  explicit Current(T* now) : outer(std::exchange(currentOf<T>(), now)) {}
  ~Current() { currentOf<T>() = outer; }
  T* const outer;
};
inline const TaskSystem* hostTasks() { return currentOf<const TaskSystem>(); }

/// Calls f(), whose loops run on these tasks if there are any.
template <class F> void withTasks(const TaskSystem& tasks, F&& f) {
  const Current<const TaskSystem> current(tasks.run ? &tasks : nullptr);
  f();
}

/// What runs the loops below.
class Threads {
 public:
  /// `count`: threads; 0 for as many as the processor runs at once. `tasks`: of the host, in their place.
  explicit Threads(int count, TaskSystem tasks = {})
#if defined(RUBBLE_HAS_TBB)
      : own_(count > 0 ? count : tbb::task_arena::automatic),
        tasks_(std::move(tasks)){}
#else
      : own_(count), tasks_(std::move(tasks)) {
  }
#endif
        Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  const TaskSystem& tasks() const { return tasks_; }
  /// Most ranges that loops have use for.
  int count() {
    if (tasks_.run) return tasks_.parts;
#if defined(RUBBLE_HAS_TBB)
    return own_.max_concurrency();
#else
    return own_.threads();
#endif
  }
  /// Calls f(), whose loops run on these threads.
  template <class F> void run(F&& f) {
    if (tasks_.run) return withTasks(tasks_, f);
    const Current<const TaskSystem> none(nullptr);  // a task of the host starts none
#if defined(RUBBLE_HAS_TBB)
    own_.execute(std::forward<F>(f));
#else
    const Current<Team> current(&own_);
    f();
#endif
  }

 private:
#if defined(RUBBLE_HAS_TBB)
  tbb::task_arena own_;
#else
  Team own_;
#endif
  TaskSystem tasks_;
};

/// Calls f(k) for k = 0 .. n - 1 on tasks of the host, which do not throw: the exception of the lowest k is
/// thrown when all have returned.
template <class F> void forEachHostTask(const TaskSystem& host, int n, F& f) {
  struct Loop {
    F& f;
    int failed;
    std::exception_ptr failure;
    std::mutex mutex;
  } loop{f, n, nullptr, {}};
  const auto task = [](void* context, int k) {
    Loop& own = *static_cast<Loop*>(context);
    try {
      own.f(static_cast<std::size_t>(k));
    } catch (...) {
      const std::lock_guard lock(own.mutex);
      if (k < own.failed) own.failed = k, own.failure = std::current_exception();
    }
  };
  host.run(n, task, &loop);
  if (loop.failure) std::rethrow_exception(loop.failure);
}

/// Calls f(k) for k = 0 .. n - 1, each a task of its own.
template <class F> void forEachTask(std::size_t n, F&& f) {
  const auto each = [&] {
    for (std::size_t k = 0; k < n; ++k) f(k);
  };
  if (const TaskSystem* const host = hostTasks()) {
    return host->parts == 1 || n == 0 ? each() : forEachHostTask(*host, static_cast<int>(n), f);
  }
#if defined(RUBBLE_HAS_TBB)
  tbb::parallel_for(std::size_t{0}, n, std::forward<F>(f), tbb::simple_partitioner{});
#else
  if (Team* const team = currentOf<Team>()) return team->run(n, f);
  each();
#endif
}

/// f(begin, end) for `parts` ranges of the same size.
template <class N, class F> void forEachOf(N parts, N n, F&& f) {
  if (parts == 1) return f(N{0}, n);
  const auto at = [&](std::size_t part) {
    return static_cast<N>(static_cast<unsigned long long>(n) * part / static_cast<std::size_t>(parts));
  };
  const auto range = [&](std::size_t k) { f(at(k), at(k + 1)); };
  forEachTask(static_cast<std::size_t>(parts), range);
}

/// Calls f(begin, end) for ranges that make up [0, n): about as many as there are threads, none below `grain`
/// unless it is the only one.
template <class F> void forEachShare(int n, int grain, F&& f) {
  if (n <= 0) return;
  if (const TaskSystem* const host = hostTasks())
    return forEachOf(std::clamp(n / grain, 1, host->parts), n, f);
#if defined(RUBBLE_HAS_TBB)
  const auto body = [&](const tbb::blocked_range<int>& range) { f(range.begin(), range.end()); };
  tbb::parallel_for(tbb::blocked_range<int>(0, n, static_cast<std::size_t>(grain)), body,
                    tbb::static_partitioner{});
#else
  const Team* const team = currentOf<Team>();
  forEachOf(std::clamp(n / grain, 1, team ? team->threads() : 1), n, f);
#endif
}

/// Calls f(begin, end) for ranges that make up [0, n), of `grain` and more: threads that are done early take
/// what others have left.
template <class F> void forEachRange(std::size_t n, std::size_t grain, F&& f) {
  if (n == 0) return;
  if (const TaskSystem* const host = hostTasks())
    return forEachOf(std::clamp(n / grain, std::size_t{1}, static_cast<std::size_t>(host->parts)), n, f);
#if defined(RUBBLE_HAS_TBB)
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) { f(range.begin(), range.end()); });
#else
  // a few ranges for each thread balance them
  const Team* const team = currentOf<Team>();
  const std::size_t most = team ? 8 * static_cast<std::size_t>(team->threads()) : 1;
  forEachOf(std::clamp(n / grain, std::size_t{1}, most), n, f);
#endif
}

/// std::sort. `less` must be a total order.
template <class Iterator, class Less> void sortOnThreads(Iterator begin, Iterator end, Less less) {
#if defined(RUBBLE_HAS_TBB)
  if (!hostTasks()) return tbb::parallel_sort(begin, end, less);
#endif
  std::sort(begin, end, less);
}

}  // namespace rubble
