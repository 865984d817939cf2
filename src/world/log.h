#pragma once
#include <rubble/log.h>
#include <rubble/report.h>

namespace rubble {

/// Writes what is worth a line in the report of a step.
void logStep(const StepReport& report, const LogSink& log);

}  // namespace rubble
