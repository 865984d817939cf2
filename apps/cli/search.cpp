#include "apps/cli/search.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "apps/cli/output.h"
#include "apps/cli/session.h"
#include "apps/cli/system.h"
#include "io/json_text.h"

namespace rubble::cli {
namespace {

struct Trial {
  int walls = 0, bodies = 0;
  double settled = 0, smash = 0;  ///< mean [ms]
  double bytesPerBody = 0;
  bool verdict = false;  ///< of the scene
  bool holds = false;    ///< the limit
  std::string error;     ///< why it could not run: no memory
};

constexpr int kSmashedSteps = 120;  // of the smash phase

Trial tryWalls(const SearchOptions& options, int walls) {
  Trial trial;
  trial.walls = walls;
  JobOptions job = options.job;
  job.scene = "walls";
  job.arguments.push_back(fmt::format("walls={}", walls));
  try {
    PreparedJob prepared = prepareJob(job);
    prepared.steps = job.steps.value_or(prepared.job.smashStep + kSmashedSteps);
    prepared.world.timings = false;  // the stages are not reported
    SessionOptions session;
    session.quiet = true;
    const io::RunRecord record = runSession(std::move(prepared), session).record;
    trial.bodies = record.bodies;
    trial.settled = record.settled ? record.settled->mean : 0;
    trial.smash = record.smash ? record.smash->mean : 0;
    trial.bytesPerBody = record.bytesPerBody;
    trial.verdict = record.holds;
    trial.holds = trial.settled <= options.limitMs && trial.smash <= options.limitMs;
  } catch (const Error& error) {
    // a scene that does not fit is too large
    trial.error = error.what();
  }
  return trial;
}

/// A number of walls that is likely just too large, by the time that so many take; up to four times as many.
int nextAfter(const Trial& trial, double limitMs) {
  constexpr double kBeyond = 1.03;
  const double slowest = std::max(trial.settled, trial.smash);
  return static_cast<int>(
      std::clamp(kBeyond * trial.walls * limitMs / slowest, trial.walls + 1.0, 4.0 * trial.walls));
}

nlohmann::ordered_json jsonOf(const SearchOptions& options, const std::vector<Trial>& trials,
                              const Trial* best) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Trial& t : trials)
    list.push_back({{"walls", t.walls},
                    {"bodies", t.bodies},
                    {"settled_ms", t.settled},
                    {"smash_ms", t.smash},
                    {"bytes_per_body", t.bytesPerBody},
                    {"verdict", t.verdict},
                    {"holds", t.holds},
                    {"error", t.error}});
  return {{"backend", options.job.backend},
          {"limit_ms", options.limitMs},
          {"walls", best ? best->walls : 0},
          {"bodies", best ? best->bodies : 0},
          {"trials", std::move(list)},
          {"machine", machineName()},
          {"date", timestamp()}};
}

}  // namespace

bool searchLargest(const SearchOptions& options) {
  JobOptions first = options.job;
  first.scene = "walls";
  prepareJob(first);  // reports wrong arguments before anything runs
  std::FILE* const out = options.jsonFile == "-" ? stderr : stdout;
  fmt::print(out, "{:>8}{:>10}{:>14}{:>12}{:>10}   {}\n", "walls", "bodies", "settled [ms]", "smash [ms]",
             "B/body", "");
  std::vector<Trial> trials;
  const auto holds = [&](int walls) {
    trials.push_back(tryWalls(options, walls));
    const Trial& t = trials.back();
    fmt::print(out, "{:>8}{:>10}{:>14.3f}{:>12.3f}{:>10.0f}   {}\n", t.walls, t.bodies, t.settled, t.smash,
               t.bytesPerBody,
               !t.error.empty() ? t.error
                                : fmt::format("{}{}", t.holds ? "holds" : "too slow",
                                              t.verdict ? "" : "; the scene's verdict does not hold"));
    std::fflush(out);
    return t.holds;
  };
  constexpr int kMostWalls = 20000;
  constexpr double kPrecision = .02;
  int low = 0, high = 1;
  while (high <= kMostWalls && holds(high)) low = high, high = nextAfter(trials.back(), options.limitMs);
  while (low > 0 && high - low > std::max(1, static_cast<int>(kPrecision * low))) {
    const int middle = low + (high - low) / 2;
    (holds(middle) ? low : high) = middle;
  }
  const auto best = std::find_if(trials.begin(), trials.end(),
                                 [&](const Trial& t) { return t.walls == low && low > 0; });
  if (best != trials.end())
    fmt::print(out, "largest: {} walls, {} bodies, under {:.2f} ms\n", best->walls, best->bodies,
               options.limitMs);
  else
    fmt::print(out, "not even one wall holds {:.2f} ms\n", options.limitMs);
  if (!options.jsonFile.empty())
    writeOutput(options.jsonFile,
                io::prettyJson(jsonOf(options, trials, best == trials.end() ? nullptr : &*best)));
  return best != trials.end();
}

}  // namespace rubble::cli
