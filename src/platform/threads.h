#pragma once
/// Loops over several threads: tasks of the host, threads of oneTBB (RUBBLE_HAS_TBB), or those of a Team. No
/// result depends on which.
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

#include <rubble/tasks.h>

namespace rubble {

/// Refers to a function object, which must outlive it. With it the division of a loop among threads is
/// compiled once, and not once for each loop.
template <class Signature> class FunctionRef;
template <class... Args> class FunctionRef<void(Args...)> {
 public:
  template <class F>
  requires(!std::same_as<std::remove_cvref_t<F>, FunctionRef>) FunctionRef(F&& f)
      : object_(const_cast<void*>(static_cast<const void*>(std::addressof(f)))),
        call_([](void* object, Args... args) {
          (*static_cast<std::remove_reference_t<F>*>(object))(args...);
        }) {}
  void operator()(Args... args) const { call_(object_, args...); }

 private:
  void* object_;
  void (*call_)(void* object, Args... args);
};

/// What runs the loops below.
class Threads {
 public:
  /// `count`: threads; 0 for as many as the processor runs at once. `tasks`: of the host, in their place.
  explicit Threads(int count, TaskSystem tasks = {});
  ~Threads();
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  const TaskSystem& tasks() const { return tasks_; }
  /// Most ranges that loops have use for.
  int count() const;
  /// Calls f(), whose loops run on these threads.
  void run(FunctionRef<void()> f);

 private:
  struct Pool;
  std::unique_ptr<Pool> own_;
  TaskSystem tasks_;
};

/// Calls f(), whose loops run on these tasks if there are any.
void withTasks(const TaskSystem& tasks, FunctionRef<void()> f);

/// Calls f(k) for k = 0 .. n - 1, each a task of its own.
void forEachTask(std::size_t n, FunctionRef<void(std::size_t)> f);

/// Calls f(begin, end) for ranges that make up [0, n), the same ones in each loop as far as threads keep
/// pace. They begin at multiples of 4. None is below `grain`, a multiple of 4 too, unless it is the only one.
void forEachShare(int n, int grain, FunctionRef<void(int, int)> f);

/// Calls f(begin, end) for ranges that make up [0, n), of `grain` and more: threads that are done early take
/// what others have left.
void forEachRange(std::size_t n, std::size_t grain, FunctionRef<void(std::size_t, std::size_t)> f);

/// Sorts numbers by their keys, those of equal keys by themselves.
void sortOnThreads(std::span<int> numbers, const std::uint64_t* key);

}  // namespace rubble
