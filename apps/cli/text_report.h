#pragma once
#include <string>

#include "apps/cli/measure.h"

namespace rubble::cli {

/// The report of a run for people: counts, times, quality, what the step had to say, and the verdict with
/// each claim.
std::string textReport(const io::RunRecord& record, const std::vector<StepReport>& reports);

/// A length with a unit that fits its size: "12.3 mm".
std::string lengthText(double metres);

}  // namespace rubble::cli
