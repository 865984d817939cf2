#include "platform/threads.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <mutex>
#include <utility>

#if defined(RUBBLE_HAS_TBB)
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#else
#include "platform/team.h"
#endif

namespace rubble {

namespace {

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
const TaskSystem* hostTasks() { return currentOf<const TaskSystem>(); }

/// Threads that the loops of this thread run on, or tasks of the host.
int threadsHere() {
  if (const TaskSystem* const host = hostTasks()) return host->parts;
#if defined(RUBBLE_HAS_TBB)
  return tbb::this_task_arena::max_concurrency();
#else
  const Team* const team = currentOf<Team>();
  return team ? team->threads() : 1;
#endif
}

/// Calls f(k) for k = 0 .. n - 1 on tasks of the host, which do not throw: the exception of the lowest k is
/// thrown when all have returned.
void forEachHostTask(const TaskSystem& host, int n, FunctionRef<void(std::size_t)> f) {
  struct Loop {
    FunctionRef<void(std::size_t)> f;
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

/// f(begin, end) for `parts` ranges of the same size.
template <class N> void forEachOf(N parts, N n, FunctionRef<void(N, N)> f) {
  if (parts == 1) return f(N{0}, n);
  const auto at = [&](std::size_t part) {
    return static_cast<N>(static_cast<unsigned long long>(n) * part / static_cast<std::size_t>(parts));
  };
  forEachTask(static_cast<std::size_t>(parts), [&](std::size_t k) { f(at(k), at(k + 1)); });
}

/// [0, n) in shares of about the same size, each of them in up to kTurns ranges. A thread takes the ranges of
/// its own share, which is the same one in every loop over so many elements, and then what others have left:
/// cores are seldom equally fast, and what a thread wrote in one loop mostly lies in its own cache in the
/// next. Ranges begin at multiples of kTogether, where kernels that take so many elements at once begin anew.
class Shares {
 public:
  /// `most`: shares, one per thread.
  Shares(int n, int most, int grain, FunctionRef<void(int, int)> f)
      : n_(n),
        count_(std::clamp(n / grain, 1, std::min(most, kMost))),
        turns_(std::clamp(n / (count_ * grain), 1, kTurns)),
        f_(f) {
    for (int k = 0; k < count_; ++k) taken_[static_cast<std::size_t>(k)].ranges = 0;
  }
  int count() const { return count_; }

  /// Takes ranges until none is left, those of share `first` before others.
  void takeFrom(int first) {
    for (int k = 0; k < count_; ++k) {
      const int share = (first + k) % count_;
      const std::atomic_ref taken(taken_[static_cast<std::size_t>(share)].ranges);
      while (taken.load(std::memory_order_relaxed) < turns_) {
        const int turn = taken.fetch_add(1, std::memory_order_relaxed);
        if (turn < turns_) f_(at(share * turns_ + turn), at(share * turns_ + turn + 1));
      }
    }
  }

 private:
  /// Shares at most, beyond the cores of a host; ranges of a share; elements that SIMD kernels take at once.
  static constexpr int kMost = 256, kTurns = 8, kTogether = 4;
  struct alignas(64) Taken {
    int ranges;
  };

  int at(int range) const {
    const std::int64_t groups = (std::int64_t{n_} + kTogether - 1) / kTogether;
    return static_cast<int>(std::min<std::int64_t>(n_, groups * range / (count_ * turns_) * kTogether));
  }

  const int n_, count_, turns_;
  const FunctionRef<void(int, int)> f_;
  std::array<Taken, kMost> taken_;  // of the first `count`, each in a cache line of its own
};

}  // namespace

#if defined(RUBBLE_HAS_TBB)
struct Threads::Pool {
  explicit Pool(int count) : arena(count > 0 ? count : tbb::task_arena::automatic) {}
  int count() const { return arena.max_concurrency(); }
  void run(FunctionRef<void()> f) { arena.execute(f); }
  tbb::task_arena arena;
};
#else
struct Threads::Pool {
  explicit Pool(int count) : team(count) {}
  int count() const { return team.threads(); }
  void run(FunctionRef<void()> f) {
    const Current<Team> current(&team);
    f();
  }
  Team team;
};
#endif

Threads::Threads(int count, TaskSystem tasks)
    : own_(std::make_unique<Pool>(count)), tasks_(std::move(tasks)) {}
Threads::~Threads() = default;

int Threads::count() const { return tasks_.run ? tasks_.parts : own_->count(); }

void Threads::run(FunctionRef<void()> f) {
  if (tasks_.run) return withTasks(tasks_, f);
  const Current<const TaskSystem> none(nullptr);  // a task of the host starts none
  own_->run(f);
}

void withTasks(const TaskSystem& tasks, FunctionRef<void()> f) {
  const Current<const TaskSystem> current(tasks.run ? &tasks : nullptr);
  f();
}

void forEachTask(std::size_t n, FunctionRef<void(std::size_t)> f) {
  const auto each = [&] {
    for (std::size_t k = 0; k < n; ++k) f(k);
  };
  if (const TaskSystem* const host = hostTasks())
    return host->parts == 1 || n == 0 ? each() : forEachHostTask(*host, static_cast<int>(n), f);
#if defined(RUBBLE_HAS_TBB)
  tbb::parallel_for(std::size_t{0}, n, f, tbb::simple_partitioner{});
#else
  if (Team* const team = currentOf<Team>()) return team->run(n, f);
  each();
#endif
}

void forEachShare(int n, int grain, FunctionRef<void(int, int)> f) {
  if (n <= 0) return;
  Shares shares(n, threadsHere(), grain, f);
  if (shares.count() == 1) return f(0, n);
#if defined(RUBBLE_HAS_TBB)
  const auto take = [&](const auto&) { shares.takeFrom(tbb::this_task_arena::current_thread_index()); };
  if (!hostTasks())
    return tbb::parallel_for(tbb::blocked_range<int>(0, shares.count(), 1), take, tbb::static_partitioner{});
#endif
  forEachTask(static_cast<std::size_t>(shares.count()),
              [&](std::size_t k) { shares.takeFrom(static_cast<int>(k)); });
}

void forEachRange(std::size_t n, std::size_t grain, FunctionRef<void(std::size_t, std::size_t)> f) {
  if (n == 0) return;
#if defined(RUBBLE_HAS_TBB)
  if (!hostTasks())
    return tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain),
                             [&](const auto& range) { f(range.begin(), range.end()); });
#endif
  // a few ranges for each thread balance them
  const std::size_t most = static_cast<std::size_t>(threadsHere() * (hostTasks() ? 1 : 8));
  forEachOf(std::clamp(n / grain, std::size_t{1}, most), n, f);
}

void sortOnThreads(std::span<int> numbers, const std::uint64_t* key) {
  const auto less = [key](int a, int b) { return key[a] != key[b] ? key[a] < key[b] : a < b; };
#if defined(RUBBLE_HAS_TBB)
  if (!hostTasks()) return tbb::parallel_sort(numbers.begin(), numbers.end(), less);
#endif
  std::sort(numbers.begin(), numbers.end(), less);
}

}  // namespace rubble
