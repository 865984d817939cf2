#include "platform/threads.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "platform/crew.h"

#if defined(RUBBLE_HAS_TBB)
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#else
#include "platform/team.h"
#endif

namespace rubble {

namespace {

/// What runs the loops of a thread: tasks of the host, a crew that it owns, or the thread alone, as inside of
/// another loop.
struct Loops {
  const TaskSystem* host = nullptr;
  Crew* crew = nullptr;
  bool alone = false;
};
Loops& loopsHere() {
  thread_local Loops here;
  return here;
}
struct Scope {
  explicit Scope(const Loops& inner) : outer(std::exchange(loopsHere(), inner)) {}
  ~Scope() { loopsHere() = outer; }
  const Loops outer;
};

/// Threads that the loops of this thread run on, or tasks of the host.
int threadsHere() {
  const Loops& here = loopsHere();
  if (here.host) return here.host->parts;
  if (here.crew) return here.crew->size();
#if defined(RUBBLE_HAS_TBB)
  if (!here.alone) return tbb::this_task_arena::max_concurrency();
#endif
  return 1;
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
    const Scope scope({.alone = true});
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

/// work(k) on the owner of the crew and on its members.
void runTogether(Crew& crew, int wanted, FunctionRef<void(int)> work) {
  crew.run(wanted, [&](int k) {
    const Scope scope({.alone = true});
    work(k);
  });
}

}  // namespace

#if defined(RUBBLE_HAS_TBB)
/// Members are tasks of oneTBB. It is not asked for more threads than there are cores: it would have none,
/// and say so on standard error.
struct Threads::Pool {
  explicit Pool(int count)
      : arena(count > 0 ? std::min(count, cores()) : tbb::task_arena::automatic),
        members(count > 0 ? count : arena.max_concurrency()) {}
  /// tbb::info needs memory to count them, and waits for ever where that has failed once.
  static int cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }
  int count() const { return members; }
  void run(FunctionRef<void(Crew&)> f) {
    arena.execute([&] {
      tbb::task_group tasks;
      const auto call = [&](Crew& crew, int k) { tasks.run([&crew, k] { crew.serve(k); }); };
      Crew crew(count(), call);
      struct End {
        tbb::task_group& tasks;
        Crew& crew;
        ~End() { crew.dismiss(), tasks.wait(); }
      } const end{tasks, crew};
      f(crew);
    });
  }
  tbb::task_arena arena;
  const int members;
};
#else
struct Threads::Pool {
  explicit Pool(int count) : team(count) {}
  int count() const { return team.threads(); }
  void run(FunctionRef<void(Crew&)> f) { team.run(f); }
  Team team;
};
#endif

Threads::Threads(int count, TaskSystem tasks)
    : own_(std::make_unique<Pool>(count)), tasks_(std::move(tasks)) {}
Threads::~Threads() = default;

int Threads::count() const { return tasks_.run ? tasks_.parts : own_->count(); }

void Threads::run(FunctionRef<void()> f) {
  if (tasks_.run) return withTasks(tasks_, f);
  if (count() == 1) {
    const Scope scope({.alone = true});
    return f();
  }
  own_->run([&](Crew& crew) {
    const Scope scope({.crew = &crew});
    f();
  });
}

void withTasks(const TaskSystem& tasks, FunctionRef<void()> f) {
  if (!tasks.run) return f();
  const Scope scope({.host = &tasks});
  f();
}

void forEachTask(std::size_t n, FunctionRef<void(std::size_t)> f) {
  const Loops& here = loopsHere();
  if (here.host && here.host->parts > 1 && n > 0) return forEachHostTask(*here.host, static_cast<int>(n), f);
  if (here.crew && n > 1) {
    std::atomic<std::size_t> next{0};
    return runTogether(*here.crew, static_cast<int>(std::min<std::size_t>(n, Crew::kMost)), [&](int) {
      for (std::size_t k; (k = next.fetch_add(1, std::memory_order_relaxed)) < n;) f(k);
    });
  }
#if defined(RUBBLE_HAS_TBB)
  if (!here.host && !here.alone) return tbb::parallel_for(std::size_t{0}, n, f, tbb::simple_partitioner{});
#endif
  for (std::size_t k = 0; k < n; ++k) f(k);
}

void forEachShare(int n, int grain, FunctionRef<void(int, int)> f) {
  if (n <= 0) return;
  const Loops& here = loopsHere();
  Shares shares(n, threadsHere(), grain, f);
  if (shares.count() == 1) return f(0, n);
  if (here.crew) return runTogether(*here.crew, shares.count(), [&](int k) { shares.takeFrom(k); });
  forEachTask(static_cast<std::size_t>(shares.count()),
              [&](std::size_t k) { shares.takeFrom(static_cast<int>(k)); });
}

void forEachRange(std::size_t n, std::size_t grain, FunctionRef<void(std::size_t, std::size_t)> f) {
  if (n == 0) return;
  const Loops& here = loopsHere();
#if defined(RUBBLE_HAS_TBB)
  if (!here.host && !here.crew && !here.alone)
    return tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain),
                             [&](const auto& range) { f(range.begin(), range.end()); });
#endif
  // a few ranges for each thread balance them
  const auto most = static_cast<std::size_t>(threadsHere() * (here.crew ? 8 : 1));
  const std::size_t parts = std::clamp(n / grain, std::size_t{1}, most);
  const auto at = [&](std::size_t part) { return n * part / parts; };
  forEachTask(parts, [&](std::size_t k) { f(at(k), at(k + 1)); });
}

void sortOnThreads(std::span<int> numbers, const std::uint64_t* key) {
  const auto less = [key](int a, int b) { return key[a] != key[b] ? key[a] < key[b] : a < b; };
#if defined(RUBBLE_HAS_TBB)
  // by itself, so that no task of a crew runs inside of it
  if (!loopsHere().host && !loopsHere().alone)
    return tbb::this_task_arena::isolate([&] { tbb::parallel_sort(numbers.begin(), numbers.end(), less); });
#endif
  std::sort(numbers.begin(), numbers.end(), less);
}

}  // namespace rubble
