#pragma once
#include <vector>

#include "io/report_json.h"

namespace rubble::cli {

/// Mean, median, 95th percentile (nearest rank) and maximum of `values`; all zero if there are none.
io::PhaseTimes summarize(std::vector<double> values);

}  // namespace rubble::cli
