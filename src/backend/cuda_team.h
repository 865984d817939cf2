#pragma once
/// GPUs of one process, or of several, that step one world together.
#include <memory>

#include <rubble/ranks.h>

#include "backend/distributed/transport.h"
#include "backend/engine.h"

namespace rubble {

/// The GPUs of RankOptions::devices. Requires cudaReady().
std::unique_ptr<Engine> makeCudaTeam(const RankOptions& ranks, bool timings);
/// The rank of this process, on the only one of RankOptions::devices. Requires cudaReady().
std::unique_ptr<Engine> makeCudaRank(std::unique_ptr<Transport> transport, const RankOptions& ranks,
                                     bool timings);

}  // namespace rubble
