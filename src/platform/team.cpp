#include "platform/team.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace rubble {

Team::Team(int threads)
    : threads_(threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
      members_(static_cast<std::size_t>(std::min(threads_, Crew::kMost))) {}

Team::~Team() {
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  for (Member& member : members_) {
    member.wake.notify_one();
    if (member.thread.joinable()) member.thread.join();
  }
}

void Team::run(FunctionRef<void(Crew&)> f) {
  const auto call = [this](Crew& crew, int k) { summon(crew, k); };
  bool isFree;
  {
    const std::lock_guard lock(mutex_);
    isFree = !std::exchange(busy_, true);
  }
  Crew crew(isFree ? threads_ : 1, call);
  if (!isFree) return f(crew);
  struct End {
    Team& team;
    Crew& crew;
    ~End() {
      crew.dismiss();
      std::unique_lock lock(team.mutex_);
      for (Member& member : team.members_) member.crew = nullptr;
      team.done_.wait(lock, [this] { return std::ranges::none_of(team.members_, &Member::serves); });
      team.busy_ = false;
    }
  } const end{*this, crew};
  f(crew);
}

void Team::summon(Crew& crew, int k) noexcept {
  Member& member = members_[static_cast<std::size_t>(k)];
  const std::lock_guard lock(mutex_);
  member.crew = &crew;
  if (member.thread.joinable()) return member.wake.notify_one();
  try {
    member.thread = std::thread([this, k] { work(k); });
  } catch (const std::exception&) {
    // the system gives no more threads or memory: those that are there do the work
  }
}

void Team::work(int k) {
  Member& member = members_[static_cast<std::size_t>(k)];
  std::unique_lock lock(mutex_);
  for (;;) {
    member.wake.wait(lock, [&] { return stops_ || member.crew; });
    if (stops_) return;
    Crew& crew = *std::exchange(member.crew, nullptr);
    member.serves = true;
    lock.unlock();
    crew.serve(k);
    lock.lock();
    member.serves = false;
    done_.notify_all();
  }
}

}  // namespace rubble
