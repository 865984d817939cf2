#pragma once
/// From the step reports of a run to its record.
#include <optional>

#include "apps/cli/job.h"
#include "io/report_json.h"

namespace rubble::cli {

/// A range of steps, [begin, end).
struct StepRange {
  int begin = 0, end = 0;
  bool empty() const { return end <= begin; }
};

/// The phases that times are quoted for. Settled: the 60 steps before the smash, or steps 60 to 119 where
/// there is none (the second half of a shorter run). Smash: the 120 steps from the smash on.
struct Phases {
  StepRange settled;
  std::optional<StepRange> smash;
};
Phases phasesOf(int smashStep, int stepsTaken);

/// Step after which the quality of a run is quoted: half a second after the smash, or the last one.
int qualityStep(int smashStep, int steps, double dt);

/// Is a stage of the step one of those that find contact points? All else of the step counts as solving.
bool isCollisionStage(const std::string& stage);

/// Times and counts of a run. `quality` is the one to quote.
io::RunRecord makeRecord(const PreparedJob& prepared, const scenes::Job& job, int smashStep,
                         const scenes::RunResult& result, const Quality& quality);

/// Each stage's wall clock over a range of steps, in the order of the step [ms].
std::vector<std::pair<std::string, io::PhaseTimes>> stageTimes(const std::vector<StepReport>& reports,
                                                               StepRange range);

}  // namespace rubble::cli
