#pragma once
/// Worlds shared by processes that find one another over TCP.
#include <memory>
#include <string>

namespace rubble {

/// The connections of this process to the others, for the time of its life. While it exists, a World with the
/// backend "distributed" and ranks.count 0 is shared by all processes, which make the same calls in the same
/// order, from one thread. They trust the network: nothing is encrypted.
///
/// The environment says which process this is, by the names that torchrun and its like set:
///   RANK, WORLD_SIZE   number of this process, from 0 on, and of all
///   MASTER_ADDR        host of process 0
///   MASTER_PORT        process 0 listens at the port after this one, because a launcher may listen at it
///   RUBBLE_PORT        the port itself, in place of that
class SocketRanks {
 public:
  /// Is this process one of several by its environment?
  static bool launched();

  /// Connects all processes. Throws Error if one of them does not come within so many seconds, has another
  /// build, or a variable is missing or wrong.
  explicit SocketRanks(double timeout = 60);
  /// Waits for all processes, a few seconds at most.
  ~SocketRanks();
  SocketRanks(const SocketRanks&) = delete;
  SocketRanks& operator=(const SocketRanks&) = delete;

  int rank() const;
  int count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rubble
