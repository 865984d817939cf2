#pragma once
#include "apps/cli/job.h"

namespace rubble::cli {

/// What it takes to make the world of each scene: times of its parts, medians of `rounds`, and memory. Writes
/// a list of records to a file, unless its name is empty.
void benchMaking(const JobOptions& options, const std::vector<std::string>& scenes, int rounds,
                 const std::string& jsonFile);

}  // namespace rubble::cli
