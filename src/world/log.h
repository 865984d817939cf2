#pragma once
#include <rubble/log.h>
#include <rubble/report.h>

namespace rubble {

/// Writes what is worth a line in the report of a step.
void logStep(const StepReport& report, const LogSink& log);

/// A kind of call without effect. The log of the step after the first one has a line of it, and no other
/// step.
struct IdleCall {
  const char* advice;
  bool seen = false, told = false;
};
/// Writes the line, if it is due.
void logIdle(IdleCall& call, const LogSink& log);

}  // namespace rubble
