#include "platform/team.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace rubble {

namespace {

/// Is this thread inside of a task?
thread_local bool isInTask = false;

/// Looks for work, or for its end, before a thread sleeps. Loops of a step follow one another within
/// microseconds.
constexpr int kLooks = 2000;

}  // namespace

Team::Team(int threads)
    : threads_(threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {}

Team::~Team() {
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  wake_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void Team::start() noexcept {
  if (!helpers_.empty()) return;
  try {
    helpers_.reserve(static_cast<std::size_t>(threads_ - 1));
    for (int k = 1; k < threads_; ++k) helpers_.emplace_back([this] { work(); });
  } catch (const std::exception&) {
    // the system gives no more threads or memory: those that are there do the work
  }
}

void Team::run(std::size_t count, Call call, void* context) {
  if (count < 2 || threads_ == 1 || isInTask || busy_.exchange(true, std::memory_order_acquire)) {
    for (std::size_t k = 0; k < count; ++k) call(context, k);
    return;
  }
  const std::uint64_t loop = (ticket_.load(std::memory_order_relaxed) >> 32) + 1;
  start();
  failed_ = false;
  count_ = count, left_ = count, call_ = call, context_ = context;
  ticket_ = loop << 32;
  {
    const std::lock_guard lock(mutex_);
    ++loops_;
  }
  wake_.notify_all();
  while (takeOne()) {
  }
  for (int looks = 0; left_ > 0 && looks < kLooks; ++looks) {
  }
  if (left_ > 0) {
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return left_ == 0; });
  }
  // closed before another loop changes what a ticket stands for
  ticket_ = loop << 32 | kClosed;
  const std::exception_ptr failure = std::exchange(failure_, nullptr);
  busy_.store(false, std::memory_order_release);
  if (failure) std::rethrow_exception(failure);
}

bool Team::takeOne() {
  std::uint64_t ticket = ticket_;
  std::size_t task;
  Call call;
  void* context;
  do {
    task = ticket & kClosed;
    if (task >= count_) return false;
    call = call_, context = context_;
  } while (!ticket_.compare_exchange_weak(ticket, ticket + 1));
  isInTask = true;
  try {
    call(context, task);
  } catch (...) {
    if (!failed_.exchange(true)) failure_ = std::current_exception();
  }
  isInTask = false;
  if (left_.fetch_sub(1) == 1) {
    const std::lock_guard lock(mutex_);
    done_.notify_all();
  }
  return true;
}

void Team::work() {
  while (!stops_) {
    const std::uint32_t loops = loops_;
    int looks = 0;
    while (looks < kLooks && !stops_) looks = takeOne() ? 0 : looks + 1;
    std::unique_lock lock(mutex_);
    if (looks == kLooks) wake_.wait(lock, [&] { return stops_ || loops_ != loops; });
  }
}

}  // namespace rubble
