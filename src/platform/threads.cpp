#include "platform/threads.h"

#include <algorithm>
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

/// A long loop has this many ranges for each thread: cores are seldom equally fast, and those that are done
/// early take what others have left. A short one has a range for each, because to take a range of less than
/// so many elements from another thread costs more than it saves.
constexpr int kTurns = 4, kWorthTaking = 32;

/// f(begin, end) for `parts` ranges of the same size.
template <class N> void forEachOf(N parts, N n, FunctionRef<void(N, N)> f) {
  if (parts == 1) return f(N{0}, n);
  const auto at = [&](std::size_t part) {
    return static_cast<N>(static_cast<unsigned long long>(n) * part / static_cast<std::size_t>(parts));
  };
  forEachTask(static_cast<std::size_t>(parts), [&](std::size_t k) { f(at(k), at(k + 1)); });
}

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
  if (const TaskSystem* const host = hostTasks())
    return forEachOf(std::clamp(n / grain, 1, host->parts), n, f);
#if defined(RUBBLE_HAS_TBB)
  const auto body = [&](const tbb::blocked_range<int>& range) { f(range.begin(), range.end()); };
  const int threads = tbb::this_task_arena::max_concurrency();
  if (const int size = n / (kTurns * threads); size >= kWorthTaking)
    tbb::parallel_for(tbb::blocked_range<int>(0, n, static_cast<std::size_t>(size)), body,
                      tbb::simple_partitioner{});
  else
    tbb::parallel_for(tbb::blocked_range<int>(0, n, static_cast<std::size_t>(grain)), body,
                      tbb::static_partitioner{});
#else
  const Team* const team = currentOf<Team>();
  const int threads = team ? team->threads() : 1;
  forEachOf(n / (kTurns * threads) >= kWorthTaking ? kTurns * threads : std::clamp(n / grain, 1, threads), n,
            f);
#endif
}

void forEachRange(std::size_t n, std::size_t grain, FunctionRef<void(std::size_t, std::size_t)> f) {
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

void sortOnThreads(std::span<int> numbers, const std::uint64_t* key) {
  const auto less = [key](int a, int b) { return key[a] != key[b] ? key[a] < key[b] : a < b; };
#if defined(RUBBLE_HAS_TBB)
  if (!hostTasks()) return tbb::parallel_sort(numbers.begin(), numbers.end(), less);
#endif
  std::sort(numbers.begin(), numbers.end(), less);
}

}  // namespace rubble
