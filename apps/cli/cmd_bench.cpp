#include <sstream>

#include <fmt/format.h>

#include "apps/cli/command.h"
#include "apps/cli/edit_bench.h"
#include "apps/cli/job.h"
#include "apps/cli/make_bench.h"
#include "apps/cli/measure.h"
#include "apps/cli/processes.h"
#include "apps/cli/search.h"
#include "apps/cli/session.h"
#include "apps/cli/text_report.h"
#include "apps/cli/worlds_bench.h"

namespace rubble::cli {
namespace {

/// End of the smash phase for scenes that are smashed at step 120, and of the settled phase of the others.
constexpr int kSmashedSteps = 240;
constexpr int kSettledSteps = 120;

struct BenchOptions {
  JobOptions job;
  std::vector<std::string> scenes;
  std::vector<int> threads{0};
  std::string jsonFile;
  bool quiet = false;
  bool search = false;
  bool noStages = false;
  bool edits = false;
  bool making = false;
  int worlds = 0;
  double limitMs = 1000.0 / 60;
};

/// Long enough for both phases and no longer.
int benchSteps(const PreparedJob& prepared) {
  return prepared.job.smashStep >= 0 ? prepared.job.smashStep + kSmashedSteps - kSettledSteps : kSettledSteps;
}

void printRow(std::FILE* out, const io::RunRecord& r) {
  const auto ms = [](const std::optional<io::PhaseTimes>& phase, auto member) {
    return phase ? fmt::format("{:.3f}", (*phase).*member) : "-";
  };
  fmt::print(out, "{:<28}{:>4}{:>9}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>11}{:>12}{:>9.0f}{:>9.0f}\n",
             r.scene, r.threads, r.bodies, ms(r.settled, &io::PhaseTimes::mean),
             ms(r.settled, &io::PhaseTimes::median), fmt::format("{:.3f}", r.collisionMs),
             fmt::format("{:.3f}", r.solveMs), ms(r.smash, &io::PhaseTimes::mean),
             ms(r.smash, &io::PhaseTimes::max), r.topDrop ? lengthText(*r.topDrop) : "-",
             r.penetration ? lengthText(r.penetration->p99) : "-", r.rssMb, r.bytesPerBody);
}

int bench(BenchOptions options) {
  options.jsonFile = outputOfProcess(options.jsonFile);
  requireWritable(options.jsonFile);
  if (options.search)
    return searchLargest({options.job, options.limitMs, options.jsonFile}) ? kHolds : kDoesNotHold;
  if (options.scenes.empty()) throw Error("scenes", "names of scenes, or --search-60hz", "none");
  std::FILE* out = options.jsonFile == "-" ? stderr : stdout;
  std::vector<io::RunRecord> records;
  // Reports scenes that cannot run before any of them runs.
  for (const std::string& scene : options.scenes) {
    options.job.scene = scene;
    prepareJob(options.job);
  }
  if (options.edits) {
    constexpr int kEditSteps = 80;
    benchEdits(options.job, options.scenes, options.job.steps.value_or(kEditSteps), options.jsonFile);
    return kHolds;
  }
  if (options.making) {
    constexpr int kRounds = 5;
    options.job.threads = options.threads.front();
    benchMaking(options.job, options.scenes, options.job.steps.value_or(kRounds), options.jsonFile);
    return kHolds;
  }
  if (options.worlds > 0) {
    benchWorlds(options.job, options.scenes, options.worlds, options.threads, !options.noStages);
    return kHolds;
  }
  for (const std::string& scene : options.scenes) {
    for (const int threads : options.threads) {
      options.job.scene = scene;
      options.job.threads = threads;
      PreparedJob prepared = prepareJob(options.job);
      prepared.world.timings = !options.noStages;
      if (!options.job.steps) prepared.steps = benchSteps(prepared);
      SessionOptions session;
      session.quiet = options.quiet || !Processes::isFirst();
      SessionResult result = runSession(std::move(prepared), session);
      if (!options.quiet) fmt::print(out, "{}\n", textReport(result.record, result.reports));
      records.push_back(std::move(result.record));
    }
  }
  fmt::print(out, "{:<28}{:>4}{:>9}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>11}{:>12}{:>9}{:>9}\n",
             "ms per step", "thr", "bodies", "settled", "median", "collide", "solve", "smash", "peak",
             "top drop", "depth 99 %", "MB", "B/body");
  for (const io::RunRecord& record : records) printRow(out, record);
  if (!options.jsonFile.empty())
    writeOutput(options.jsonFile, io::toJson(std::span<const io::RunRecord>(records)));
  return kHolds;
}

}  // namespace

void addBench(CLI::App& app, int& status) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand(
      "bench",
      "Measure scenes: times of the settled phase (the 60 steps before the smash, or steps 60 to 119) "
      "and of the smash (the 120 steps from it on)");
  command->add_option("scenes", options->scenes, "Names of scenes or scene files, with commas between")
      ->delimiter(',');
  addArgumentOptions(*command, options->job);
  addSolverOptions(*command, options->job);
  command->add_option("-b,--backend", options->job.backend, "Where the step runs (see 'rubble info build')")
      ->capture_default_str();
  addRankOptions(*command, options->job);
  command
      ->add_option("-t,--threads", options->threads,
                   "Numbers of worker threads, with commas between; one run for each; 0 is one a core")
      ->delimiter(',')
      ->check(wholeNumber(0))
      ->capture_default_str();
  command->add_flag("--search-60hz", options->search,
                    "Instead of scenes: find the most walls ('walls', 1,620 bricks each) whose mean step, "
                    "settled and smash, stays under --limit");
  command->add_option("--limit", options->limitMs, "For --search-60hz [ms]")
      ->check(aboveZero())
      ->capture_default_str();
  command->add_flag("--edits", options->edits,
                    "Instead of phases: what an edit or a query before every step costs. --steps: for each "
                    "kind of edit");
  command->add_flag("--making", options->making,
                    "Instead of phases: what it takes to make the world and to write and read its file. "
                    "--steps: rounds, of which the table has the medians (default 5)");
  command
      ->add_option("--worlds", options->worlds,
                   "Instead of phases: that many worlds of each scene in one batch (rubble/worlds.h)")
      ->check(wholeNumber(1));
  command->add_flag(
      "--no-stages", options->noStages,
      "Without the clocks of stages, which cost a GPU some percent of a small step: the whole step only");
  command
      ->add_option("--json", options->jsonFile,
                   "Write a list with one record for each run as JSON; '-' is standard output")
      ->type_name("FILE");
  command->add_flag("-q,--quiet", options->quiet, "No progress, and only the table at the end");
  command->footer("The verdict is in the records; it does not change the exit status.");
  command->callback([options, &status] { status = bench(*options); });
}

}  // namespace rubble::cli
