#pragma once
/// Threads that run one loop after another together, without a rest in between.
#include <array>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>

#include "platform/threads.h"

namespace rubble {

/// A thread that runs loops, its owner, and members that help it. Those look for the next loop all the time
/// instead of being woken for it: a step has hundreds of loops, each of a few microseconds. Members come when
/// a loop first has use for them, and leave if there is none for long. No loop waits for a member to come.
class Crew {
 public:
  /// `size`: threads with the owner, up to kMost. `summon(crew, k)`, which must outlive the crew, lets
  /// another thread call crew.serve(k), soon, late or never.
  Crew(int size, FunctionRef<void(Crew&, int)> summon)
      : size_(size < kMost ? size : kMost), summon_(summon) {}
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  int size() const { return size_; }

  /// Calls work(0) on this thread, the owner, and work(k) on members 0 < k < wanted that come before it
  /// returns. Returns when all calls have. Each call takes what is left to do until nothing is, so that any
  /// of them does all. One that throws is repeated, for the rest; the first exception is thrown at the end.
  void run(int wanted, FunctionRef<void(int)> work);

  /// Takes part as member k until dismiss(), or until there is nothing to do for long.
  void serve(int k) noexcept;

  /// No loop follows.
  void dismiss() { loop_ = kDismissed; }

  static constexpr int kMost = 256;

 private:
  enum class State { Away, Waiting, Working };
  /// Of a member, in a cache line of its own.
  struct alignas(64) Place {
    std::atomic<State> state{State::Away};
  };

  void attempt(int k) noexcept;

  const int size_;
  const FunctionRef<void(Crew&, int)> summon_;
  std::array<Place, kMost> places_;
  /// What members look at: number of the loop that they may enter, times kMost, and its last member. It
  /// ascends from loop to loop.
  alignas(64) std::atomic<std::uint64_t> loop_{kNone};
  std::uint64_t loops_ = 0;
  const FunctionRef<void(int)>* work_ = nullptr;  ///< of the loop, while it can be entered or a member works
  std::mutex mutex_;
  std::exception_ptr failure_;

  static constexpr std::uint64_t kNone = 0, kDismissed = ~std::uint64_t{0};
};

}  // namespace rubble
