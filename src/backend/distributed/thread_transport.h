#pragma once
/// Ranks that are threads of one process. They share messages and nothing else.
#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>

#include "backend/distributed/transport.h"

namespace rubble {

/// The mailboxes of all ranks.
class ThreadHub {
 public:
  /// `timeout`: longest wait for a message [s].
  ThreadHub(int ranks, double timeout);
  /// The end of a rank. Must not outlive the hub.
  std::unique_ptr<Transport> join(int rank);
  /// What failed first; empty: nothing.
  std::string failure() const;

 private:
  class End;
  /// Messages to one rank.
  struct Mailbox {
    std::mutex mutex;
    std::condition_variable arrived;
    std::vector<std::deque<std::vector<std::byte>>> from;
    std::vector<std::vector<std::byte>> spare;  ///< buffers of messages that have been read
  };

  void post(int from, int to, std::span<const std::byte> bytes);
  void take(int from, int to, std::span<std::byte> bytes);
  void fail(int rank, const std::string& why) noexcept;

  double timeout_;
  std::vector<std::unique_ptr<Mailbox>> boxes_;
  std::atomic<bool> failed_ = false;
  mutable std::mutex failureMutex_;
  std::string failure_;
};

}  // namespace rubble
