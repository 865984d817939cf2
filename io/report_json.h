#pragma once
/// The record of a run or of a benchmark, and its JSON form. The key names are fixed: scripts compare records
/// over time.
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <rubble/report.h>

namespace rubble::io {

/// One statement of a verdict and what was measured. An infinite bound is no bound; a missing value is NaN.
struct ClaimRecord {
  std::string metric;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string why;
  double value = std::numeric_limits<double>::quiet_NaN();
  bool holds = false;
};

/// Wall clock of the steps of one phase [ms].
struct PhaseTimes {
  double mean = 0, median = 0, p95 = 0, max = 0;
};

/// What changes from step to step, for plots; all of one length.
struct RunSeries {
  std::vector<double> time;             ///< after the step [s]
  std::vector<double> stepMs;           ///< wall clock of the step [ms]
  std::vector<double> energy;           ///< kinetic and potential [J]
  std::vector<double> gapMean, gapMax;  ///< of the joints [m]
  std::vector<double> penetration;      ///< deepest contact [m]
};

/// Everything that one run leaves behind. What does not exist in a run (a phase, a drop) is empty and written
/// as null.
struct RunRecord {
  std::string scene;
  std::string backend;
  std::string device;
  int threads = 0;
  int gpus = 0;  ///< that step the world together; 0: one, or none
  std::string commit;
  int bodies = 0, manifolds = 0, contacts = 0, colors = 0;  ///< at the end of the settled phase
  int clashes = 0;                                          ///< of the worst step
  int iterations = 0;                                       ///< of a substep
  int substeps = 1;                                         ///< not written as JSON
  double dt = 0;                                            ///< [s]
  std::optional<PhaseTimes> settled, smash;
  using StageMeans = std::vector<std::pair<std::string, double>>;
  StageMeans stages, smashStages;  ///< means of the two phases [ms], in the order of the step
  int restarts = 0;  ///< steps of either phase that were begun again with more room: part of their times
  double solveMs = 0, collisionMs = 0,
         totalMs = 0;             ///< means of the settled phase; solve and collision add up to total
  std::optional<double> topDrop;  ///< [m]
  std::optional<Distribution> penetration;          ///< [m]
  std::optional<double> jointGapMean, jointGapMax;  ///< [m]; empty for a scene without joints
  double energy = 0;                                ///< kinetic and potential [J]
  double engineMb = 0;      ///< tables of the engine at the end, on host or device [MB]
  double bytesPerBody = 0;  ///< of those tables at the end of the settled phase [B]
  double rssMb = 0;         ///< resident memory of the process [MB]
  bool holds = true;        ///< the verdict
  std::string statedFor;  ///< what the verdict is stated for, where the run was another; not written as JSON
  std::vector<ClaimRecord> claims;
  std::map<std::string, double> metrics;  ///< everything that the probes measured
  std::optional<RunSeries> series;        ///< written only if it is there
  std::vector<RankReport> ranks;          ///< means over all steps; written only if there are any
  std::string hash;                       ///< of the state at the end; written only if it is there
  std::string machine;
  std::string date;  ///< ISO 8601, UTC
};

/// One JSON object.
std::string toJson(const RunRecord& record);
/// A JSON list of records.
std::string toJson(std::span<const RunRecord> records);

}  // namespace rubble::io
