#pragma once
#include <string>

#include <rubble/log.h>
#include <rubble/report.h>

namespace rubble {

/// Writes what is worth a line in the report of a step. `step`: what lines begin with.
void logStep(const StepReport& report, const std::string& step, const LogSink& log);

/// Calls without effect, by kind. The log of the step after the first one has a line of it, and no other
/// step.
struct IdleCalls {
  struct Kind {
    const char* advice;
    bool seen = false, told = false;
  };
  Kind force{"forces and impulses move dynamic bodies only: some were given to static or kinematic ones"};
  Kind events{"World::events() is empty unless WorldOptions::events is set"};

  /// Counts those of another world as well.
  void add(const IdleCalls& other) { force.seen |= other.force.seen, events.seen |= other.events.seen; }
  /// Writes the lines that are due.
  void write(const LogSink& log);
};

}  // namespace rubble
