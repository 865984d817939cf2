#pragma once
/// GPUs of one process that step one world together.
#include <memory>

#include <rubble/ranks.h>

#include "backend/engine.h"

namespace rubble {

/// The GPUs of RankOptions::devices. Requires cudaReady().
std::unique_ptr<Engine> makeCudaTeam(const RankOptions& ranks, bool timings);

}  // namespace rubble
