#pragma once
/// Processes that share worlds, if this one was started as one of several.
#include <functional>
#include <memory>

#include "backend/distributed/transport.h"

namespace rubble {

struct RankProcesses {
  int count = 1;
  /// The end of this process, for one world. `timeout`: longest wait [s]. All processes call it together.
  std::function<std::unique_ptr<Transport>(double timeout)> transport = {};
};

// The one record that all threads of a process share. Each call holds its lock.

/// Those that share worlds with this process, as joined; of count 1 without.
RankProcesses rankProcesses();
/// Throws Error if they were joined and not left: a process has one SocketRanks or MpiRanks at a time.
void requireNoProcesses();
void joinProcesses(RankProcesses processes);
void leaveProcesses();

}  // namespace rubble
