#pragma once
#include <string>

#include "apps/cli/job.h"

namespace rubble::cli {

struct SearchOptions {
  JobOptions job;      ///< backend, threads and solver; the scene is 'walls'
  double limitMs = 0;  ///< of the mean step, settled and in the smash [ms]
  std::string jsonFile;
};

/// Finds the largest number of walls that holds the limit, by doubling and bisection down to 2 %, and prints
/// every trial. False if not even one wall does.
bool searchLargest(const SearchOptions& options);

}  // namespace rubble::cli
