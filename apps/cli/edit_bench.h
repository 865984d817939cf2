#pragma once
#include <string>
#include <vector>

#include "apps/cli/job.h"

namespace rubble::cli {

/// Measures what edits and queries between steps cost, for each scene, and prints a table. `steps`: of each
/// edit.
void benchEdits(const JobOptions& options, const std::vector<std::string>& scenes, int steps,
                const std::string& jsonFile);

}  // namespace rubble::cli
