#include "world/log.h"

namespace rubble {

void logStep(const StepReport& report, const std::string& step, const LogSink& log) {
  for (const Growth& growth : report.grown)
    log(LogLevel::Info,
        step + ": the table of " + growth.what + " grew to hold " + std::to_string(growth.needed));
  const struct {
    LogLevel level;
    int count;
    const char* what;
  } counts[] = {
      {LogLevel::Info, report.brokenJoints, "joints broke"},
      {LogLevel::Warning, report.quarantined, "bodies are frozen: their state is not finite"},
      {LogLevel::Warning, report.failedSolves, "local problems were skipped: no positive definite Hessian"},
      {LogLevel::Warning, report.spinLimited, "bodies were limited to 2 rad"},
      {LogLevel::Warning, report.unsettledImpacts, "impacts continue in the next step"}};
  for (const auto& [level, count, what] : counts)
    if (count > 0) log(level, step + ": " + std::to_string(count) + " " + what);
  if (!report.difference.empty())
    log(LogLevel::Warning, step + ": the two backends differ: " + report.difference);
}

void IdleCalls::write(const LogSink& log) {
  for (Kind* const kind : {&force, &events}) {
    if (!kind->seen || kind->told) continue;
    kind->told = true;
    log(LogLevel::Warning, kind->advice);
  }
}

}  // namespace rubble
