#include "backend/distributed/transport.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <utility>

#include <rubble/error.h>

#include "backend/distributed/rank_processes.h"

namespace rubble {

namespace {

/// MPI has one world per process, and a launcher one set of variables, so the record is that of the process.
struct SharedProcesses {
  std::mutex mutex;
  RankProcesses processes;
};
SharedProcesses& shared() {
  static SharedProcesses record;
  return record;
}
void requireNone(const SharedProcesses& all) {
  if (all.processes.transport) throw Error("ranks", "one SocketRanks or MpiRanks at a time", "another");
}

}  // namespace

RankProcesses rankProcesses() {
  const std::scoped_lock lock(shared().mutex);
  return shared().processes;
}
void requireNoProcesses() {
  const std::scoped_lock lock(shared().mutex);
  requireNone(shared());
}
void joinProcesses(RankProcesses processes) {
  const std::scoped_lock lock(shared().mutex);
  requireNone(shared());
  shared().processes = std::move(processes);
}
void leaveProcesses() {
  const std::scoped_lock lock(shared().mutex);
  shared().processes = {};
}

template <class F> void Transport::timed(F&& f) {
  const auto begin = std::chrono::steady_clock::now();
  f();
  traffic_.ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

void Transport::exchange(std::span<const Send> sends, std::span<const Receive> receives) {
  if (sends.empty() && receives.empty()) return;
  for (const Send& send : sends) traffic_.bytes += static_cast<std::int64_t>(send.bytes.size());
  traffic_.messages += static_cast<std::int64_t>(sends.size());
  timed([&] { swap(sends, receives); });
}

void Transport::gather(std::span<const std::byte> own, std::span<std::byte> all,
                       std::span<const std::size_t> sizes) {
  traffic_.bytes += static_cast<std::int64_t>(own.size()) * (ranks() - 1);
  traffic_.messages += ranks() - 1;
  timed([&] { swapAll(own, all, sizes); });
}

void Transport::swapAll(std::span<const std::byte> own, std::span<std::byte> all,
                        std::span<const std::size_t> sizes) {
  std::vector<Send> sends;
  std::vector<Receive> receives;
  std::size_t at = 0;
  for (int r = 0; r < ranks(); ++r) {
    const std::span<std::byte> block = all.subspan(at, sizes[static_cast<std::size_t>(r)]);
    at += block.size();
    if (r == rank())
      std::ranges::copy(own, block.begin());
    else {
      if (!own.empty()) sends.push_back({r, own});
      if (!block.empty()) receives.push_back({r, block});
    }
  }
  swap(sends, receives);
}

}  // namespace rubble
