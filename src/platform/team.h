#pragma once
/// Threads for builds without oneTBB.
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "platform/crew.h"

namespace rubble {

/// Threads that sleep between the times when a crew needs them.
class Team {
 public:
  /// `threads`: with the one that calls run(); 0 for as many as the processor runs at once.
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int threads() const { return threads_; }
  /// Calls f with a crew of this thread and those of the team: of this thread alone, if another call is not
  /// over.
  void run(FunctionRef<void(Crew&)> f);

 private:
  /// A thread, which starts when it is first called.
  struct Member {
    Crew* crew = nullptr;  ///< calls it
    bool serves = false;
    // Not std::atomic::wait, which loses wakes in GCC 12 where the system has no futex.
    std::condition_variable wake = {};
    std::thread thread = {};
  };

  void summon(Crew& crew, int k) noexcept;
  void work(int k);

  const int threads_;
  std::mutex mutex_;  // of all below
  std::condition_variable done_;
  bool busy_ = false, stops_ = false;
  std::vector<Member> members_;
};

}  // namespace rubble
