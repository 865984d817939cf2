#include "platform/crew.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace rubble {

namespace {

/// Looks for a change: the first kLooks at once, the next ones between other threads' turns. After kMostLooks
/// a member leaves.
constexpr int kLooks = 2000, kMostLooks = 4000;

void lookAgain(int looks) {
  if (looks >= kLooks) return std::this_thread::yield();
#if defined(__GNUC__) && defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__GNUC__) && defined(__aarch64__)
  asm volatile("yield");
#endif
}

}  // namespace

void Crew::run(int wanted, FunctionRef<void(int)> work) {
  wanted = std::min(wanted, size_);
  for (int k = 1; k < wanted; ++k) {
    std::atomic<State>& state = places_[static_cast<std::size_t>(k)].state;
    if (state.load(std::memory_order_relaxed) != State::Away) continue;
    state.store(State::Waiting, std::memory_order_relaxed);
    summon_(*this, k);
  }
  work_ = &work;
  loop_ = ++loops_ * kMost + static_cast<std::uint64_t>(std::max(wanted - 1, 0));
  attempt(0);
  // A member that enters says so first and looks at loop_ then. So it sees that the loop is over, or is seen.
  // Both are exchanges, where a store would do: qemu 7.2 lets loads of an ARM pass it.
  loop_.exchange(kNone);
  for (int k = 1; k < wanted; ++k)
    for (int looks = 0; places_[static_cast<std::size_t>(k)].state == State::Working; ++looks)
      lookAgain(looks);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void Crew::serve(int k) noexcept {
  std::atomic<State>& state = places_[static_cast<std::size_t>(k)].state;
  std::uint64_t last = kNone;
  for (int looks = 0; looks < kMostLooks; lookAgain(++looks)) {
    const std::uint64_t loop = loop_.load(std::memory_order_acquire);
    if (loop == kDismissed) break;
    if (loop <= last || static_cast<std::uint64_t>(k) > loop % kMost) continue;
    last = loop, looks = 0;
    state.exchange(State::Working);
    if (loop_ == loop) attempt(k);
    state.store(State::Waiting, std::memory_order_release);
  }
  state.store(State::Away, std::memory_order_release);
}

void Crew::attempt(int k) noexcept {
  for (;;) try {
      return (*work_)(k);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
}

}  // namespace rubble
