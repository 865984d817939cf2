#include "apps/cli/measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <rubble/info.h>

#include "apps/cli/statistics.h"
#include "apps/cli/system.h"

namespace rubble::cli {
namespace {

constexpr int kSettledSteps = 60;
constexpr int kSmashSteps = 120;

std::vector<double> totals(const std::vector<StepReport>& reports, StepRange range) {
  std::vector<double> ms;
  for (int i = range.begin; i < range.end; ++i) ms.push_back(reports[static_cast<std::size_t>(i)].totalMs);
  return ms;
}

std::optional<double> metric(const scenes::Metrics& metrics, const std::string& name) {
  const auto found = metrics.find(name);
  return found == metrics.end() ? std::nullopt : std::optional(found->second);
}

void addTimes(io::RunRecord& record, const std::vector<StepReport>& reports, const Phases& phases) {
  if (phases.settled.empty()) return;
  record.settled = summarize(totals(reports, phases.settled));
  if (phases.smash) {
    record.smash = summarize(totals(reports, *phases.smash));
    for (const auto& [name, times] : stageTimes(reports, *phases.smash))
      record.smashStages.emplace_back(name, times.mean);
  }
  for (int i = phases.settled.begin; i < (phases.smash ? *phases.smash : phases.settled).end; ++i)
    record.restarts += reports[static_cast<std::size_t>(i)].restarts;
  for (const auto& [name, times] : stageTimes(reports, phases.settled)) {
    record.stages.emplace_back(name, times.mean);
    if (isCollisionStage(name)) record.collisionMs += times.mean;
  }
  record.totalMs = record.settled->mean;
  record.solveMs = record.totalMs - record.collisionMs;
}

void addCounts(io::RunRecord& record, const std::vector<StepReport>& reports, const Phases& phases) {
  if (reports.empty()) return;
  const StepReport& settled = reports[static_cast<std::size_t>(std::max(phases.settled.end, 1) - 1)];
  record.bodies = settled.bodies;
  record.manifolds = settled.manifolds;
  record.contacts = settled.contacts;
  record.colors = settled.colors;
  for (const StepReport& report : reports) record.clashes = std::max(record.clashes, report.clashes);
}

/// Means over all steps, by rank.
void addRanks(io::RunRecord& record, const std::vector<StepReport>& reports) {
  if (reports.empty()) return;
  const auto steps = static_cast<double>(reports.size());
  const auto mean = [steps](auto sum) {
    return static_cast<decltype(sum)>(static_cast<double>(sum) / steps);
  };
  record.ranks.resize(reports.back().ranks.size());
  for (std::size_t r = 0; r < record.ranks.size(); ++r) {
    RankReport& sum = record.ranks[r];
    std::int64_t bodies = 0, ghosts = 0, rows = 0, migrated = 0;
    for (const StepReport& report : reports) {
      const RankReport& own = report.ranks[r];
      sum.ownMs += own.ownMs, sum.exchangeMs += own.exchangeMs;
      sum.bytes += own.bytes, sum.messages += own.messages;
      bodies += own.bodies, ghosts += own.ghosts, rows += own.rows, migrated += own.migrated;
    }
    sum.ownMs = mean(sum.ownMs), sum.exchangeMs = mean(sum.exchangeMs);
    sum.bytes = mean(sum.bytes), sum.messages = mean(sum.messages);
    sum.bodies = static_cast<int>(mean(bodies)), sum.ghosts = static_cast<int>(mean(ghosts));
    sum.rows = static_cast<int>(mean(rows)), sum.migrated = static_cast<int>(mean(migrated));
    sum.memoryBytes = reports.back().ranks[r].memoryBytes;
  }
}

void addVerdict(io::RunRecord& record, const scenes::RunResult& result) {
  record.holds = result.verdict.holds;
  record.metrics = result.metrics;
  for (const scenes::ClaimResult& r : result.verdict.results) {
    const bool measured = result.metrics.contains(r.claim.metric);
    record.claims.push_back({r.claim.metric, r.claim.min, r.claim.max, r.claim.why,
                             measured ? r.value : std::numeric_limits<double>::quiet_NaN(), r.holds});
  }
}

}  // namespace

Phases phasesOf(int smashStep, int stepsTaken) {
  Phases phases;
  const bool smashed = smashStep >= 0 && smashStep < stepsTaken;
  if (smashed) {
    phases.settled = {std::max(0, smashStep - kSettledSteps), smashStep};
    phases.smash = StepRange{smashStep, std::min(stepsTaken, smashStep + kSmashSteps)};
  } else if (stepsTaken >= 2 * kSettledSteps) {
    phases.settled = {kSettledSteps, 2 * kSettledSteps};
  } else {
    phases.settled = {stepsTaken / 2, stepsTaken};
  }
  return phases;
}

int qualityStep(int smashStep, int steps, double dt) {
  if (smashStep < 0) return steps - 1;
  return std::min(steps - 1, smashStep + static_cast<int>(std::lround(.5 / dt)));
}

bool isCollisionStage(const std::string& stage) {
  constexpr std::array<std::string_view, 4> kStages{"bounds", "grid", "pairs", "narrow"};
  return std::find(kStages.begin(), kStages.end(), stage) != kStages.end();
}

std::vector<std::pair<std::string, io::PhaseTimes>> stageTimes(const std::vector<StepReport>& reports,
                                                               StepRange range) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> samples;
  for (int i = range.begin; i < range.end; ++i) {
    for (const StageTime& stage : reports[static_cast<std::size_t>(i)].stages) {
      std::vector<double>& ms = samples[stage.name];
      if (ms.empty()) order.push_back(stage.name);
      ms.push_back(stage.ms);
    }
  }
  std::vector<std::pair<std::string, io::PhaseTimes>> times;
  times.reserve(order.size());
  for (const std::string& name : order) times.emplace_back(name, summarize(samples[name]));
  return times;
}

namespace {

/// What steps the world: a processor, or GPUs by name.
std::string deviceOf(const WorldOptions& options) {
  if (options.backend != "cuda" && options.ranks.devices.empty()) return processorName();
  const std::string status = cudaStatus();  // "on: name, ..."
  return status.substr(status.find(' ') + 1);
}

}  // namespace

io::RunRecord makeRecord(const PreparedJob& prepared, const scenes::Job& job, int smashStep,
                         const scenes::RunResult& result, const Quality& quality) {
  io::RunRecord record;
  record.scene = prepared.title;
  record.backend = prepared.world.backend;
  record.device = deviceOf(prepared.world);
  record.threads = threadCount(prepared.world.threads);
  record.gpus = static_cast<int>(prepared.world.ranks.devices.size());
  record.commit = buildInfo().commit;
  record.iterations = prepared.world.params.iterations;
  record.substeps = prepared.world.params.substeps;
  record.dt = prepared.world.params.dt;
  const Phases phases = phasesOf(smashStep, static_cast<int>(result.reports.size()));
  addTimes(record, result.reports, phases);
  addCounts(record, result.reports, phases);
  addRanks(record, result.reports);
  record.topDrop = metric(result.metrics, "top_drop_m");
  record.penetration = quality.penetration;
  if (!job.scene.joints.empty()) {
    record.jointGapMean = quality.jointGapMean;
    record.jointGapMax = quality.jointGapMax;
  }
  record.energy = quality.kineticEnergy + quality.potentialEnergy;
  record.rssMb = residentMb();
  addVerdict(record, result);
  const Params& params = prepared.world.params;
  if (static_cast<int>(result.reports.size()) != job.steps || params.iterations != job.iterations ||
      params.substeps != job.substeps)
    record.statedFor = fmt::format("{} steps of {}{} iterations", job.steps,
                                   job.substeps == 1 ? "" : fmt::format("{} x ", job.substeps),
                                   job.iterations);
  record.machine = machineName();
  record.date = timestamp();
  return record;
}

}  // namespace rubble::cli
