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

/// Set by what started the processes (rubble/mpi.h).
RankProcesses& rankProcesses();

}  // namespace rubble
