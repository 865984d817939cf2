#pragma once
/// Threads for builds without oneTBB.
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace rubble {

/// Threads that wait for loops. The calling thread is one of them; the others start with the first loop.
class Team {
 public:
  /// `threads`: 0 for as many as the processor runs at once.
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int threads() const { return threads_; }
  /// Calls task(k) for k = 0 .. count - 1 (below 2^32 - 1), each once, in any order and on any thread of the
  /// team, and returns when all are done. The first exception of a task is thrown again then. A loop inside
  /// of a task, or one while another thread runs a loop, runs on the calling thread alone.
  template <class Task> void run(std::size_t count, Task&& task) {
    const Call call = [](void* context, std::size_t k) {
      (*static_cast<std::remove_reference_t<Task>*>(context))(k);
    };
    run(count, call, const_cast<void*>(static_cast<const void*>(std::addressof(task))));
  }

 private:
  using Call = void (*)(void* context, std::size_t k);

  void run(std::size_t count, Call call, void* context);
  void start() noexcept;
  void work();
  bool takeOne();

  const int threads_;
  std::vector<std::thread> helpers_;
  std::atomic<bool> busy_{false}, stops_{false};
  /// Number of the loop in the upper half, its next task in the lower one.
  std::atomic<std::uint64_t> ticket_{kClosed};
  /// Of the loop: read before a ticket is taken, and valid if it was.
  std::atomic<std::size_t> count_{0};
  std::atomic<Call> call_{nullptr};
  std::atomic<void*> context_{nullptr};
  std::atomic<std::size_t> left_{0};  ///< tasks that are not done
  std::atomic<std::uint32_t> loops_{0};
  // Not std::atomic::wait, which loses wakes in GCC 12 where the system has no futex.
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;

  static constexpr std::uint64_t kClosed = 0xffffffffu;
};

}  // namespace rubble
