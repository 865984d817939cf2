#pragma once
#include <string>
#include <vector>

#include "apps/cli/job.h"

namespace rubble::cli {

/// Measures many worlds of each scene in one batch, and prints a table: world steps per second, and the times
/// of the stages if the options ask for timings. `threads`: one run for each.
void benchWorlds(const JobOptions& options, const std::vector<std::string>& scenes, int worlds,
                 const std::vector<int>& threads, bool stages);

}  // namespace rubble::cli
