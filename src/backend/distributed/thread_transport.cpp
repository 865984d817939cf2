#include "backend/distributed/thread_transport.h"

#include <chrono>
#include <cstring>

namespace rubble {

class ThreadHub::End final : public Transport {
 public:
  End(ThreadHub& hub, int rank) : hub_(hub), rank_(rank) {}
  int rank() const override { return rank_; }
  int ranks() const override { return static_cast<int>(hub_.boxes_.size()); }
  void fail(const std::string& why) noexcept override { hub_.fail(rank_, why); }
  void requireAll() override {
    if (hub_.failed_) throw RankFailure(hub_.failure());
  }

 private:
  void swap(std::span<const Send> sends, std::span<const Receive> receives) override {
    for (const Send& send : sends) hub_.post(rank_, send.to, send.bytes);
    for (const Receive& receive : receives) hub_.take(receive.from, rank_, receive.bytes);
  }

  ThreadHub& hub_;
  int rank_;
};

ThreadHub::ThreadHub(int ranks, double timeout) : timeout_(timeout) {
  for (int r = 0; r < ranks; ++r) {
    boxes_.push_back(std::make_unique<Mailbox>());
    boxes_.back()->from.resize(static_cast<std::size_t>(ranks));
  }
}

std::unique_ptr<Transport> ThreadHub::join(int rank) { return std::make_unique<End>(*this, rank); }

std::string ThreadHub::failure() const {
  const std::lock_guard lock(failureMutex_);
  return failure_;
}

void ThreadHub::post(int from, int to, std::span<const std::byte> bytes) {
  Mailbox& box = *boxes_[static_cast<std::size_t>(to)];
  {
    const std::lock_guard lock(box.mutex);
    std::vector<std::byte> message;
    if (!box.spare.empty()) message = std::move(box.spare.back()), box.spare.pop_back();
    message.assign(bytes.begin(), bytes.end());
    box.from[static_cast<std::size_t>(from)].push_back(std::move(message));
  }
  box.arrived.notify_one();
}

void ThreadHub::take(int from, int to, std::span<std::byte> bytes) {
  Mailbox& box = *boxes_[static_cast<std::size_t>(to)];
  std::deque<std::vector<std::byte>>& queue = box.from[static_cast<std::size_t>(from)];
  std::unique_lock lock(box.mutex);
  const bool came = box.arrived.wait_for(lock, std::chrono::duration<double>(timeout_),
                                         [&] { return failed_ || !queue.empty(); });
  if (failed_) throw RankFailure(failure());
  if (!came)
    throw RankFailure("rank " + std::to_string(from) + " does not answer rank " + std::to_string(to));
  if (queue.front().size() != bytes.size())
    throw RankFailure("rank " + std::to_string(from) + " sent " + std::to_string(queue.front().size()) +
                      " bytes, rank " + std::to_string(to) + " expected " + std::to_string(bytes.size()));
  if (!bytes.empty()) std::memcpy(bytes.data(), queue.front().data(), bytes.size());
  box.spare.push_back(std::move(queue.front()));
  queue.pop_front();
}

void ThreadHub::fail(int rank, const std::string& why) noexcept {
  {
    const std::lock_guard lock(failureMutex_);
    if (failed_) return;
    try {
      failure_ = "rank " + std::to_string(rank) + " failed: " + why;
    } catch (...) {  // no memory for the message
    }
    failed_ = true;
  }
  for (const std::unique_ptr<Mailbox>& box : boxes_) {
    const std::lock_guard lock(box->mutex);
    box->arrived.notify_all();
  }
}

}  // namespace rubble
