#include <fmt/format.h>

#include <algorithm>

#include "apps/cli/command.h"
#include "apps/cli/job.h"
#include "apps/cli/output.h"
#include "apps/cli/system.h"
#include "io/json_text.h"
#include "scenes/soak.h"

namespace rubble::cli {
namespace {

struct SoakCommand {
  std::string backend = "cpu", jsonFile;
  int threads = 0, bodies = 500, iterations = 4;
  std::uint64_t seed = 1;
  bool joints = false;
  double minutes = 10;
  std::int64_t steps = 0;  ///< 0: as many as the time allows
  double growth = 8;       ///< of resident memory, allowed after the first tenth [MB]
};

/// Memory at moments of a run [MB].
struct SoakMemory {
  double start = 0;        ///< resident, when the first steps have made their allocations
  double tenth = 0;        ///< resident, after the first tenth of the run
  double tenthTables = 0;  ///< of the engine's tables, after the first tenth of the run
  double end = 0;          ///< resident, after the last step
  double growth = 0;       ///< after the first tenth, without that of the tables
};

double tablesMb(const scenes::Soak& soak) { return static_cast<double>(soak.counts().memory) / 1e6; }

std::string clockText(double seconds) {
  return fmt::format("{}:{:02}", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
}

nlohmann::ordered_json jsonOf(const SoakCommand& command, const scenes::Soak& soak, double seconds,
                              const SoakMemory& memory, const std::vector<std::string>& faults) {
  const scenes::SoakCounts& c = soak.counts();
  return {{"backend", command.backend},
          {"seed", command.seed},
          {"seconds", seconds},
          {"steps", c.steps},
          {"bodies", {{"wanted", command.bodies}, {"at_end", c.bodies}, {"most", c.mostBodies}}},
          {"edits",
           {{"added", c.added},
            {"removed", c.removed},
            {"pushed", c.pushed},
            {"forced", c.forced},
            {"placed", c.placed},
            {"joined", c.joined},
            {"parted", c.parted}}},
          {"snapshots", c.snapshots},
          {"sorts", c.sorts},
          {"restores", c.restores},
          {"replays", c.replays},
          {"growths", c.growths},
          {"engine_mb", tablesMb(soak)},
          {"rss_mb",
           {{"start", memory.start},
            {"tenth", memory.tenth},
            {"end", memory.end},
            {"growth", memory.growth},
            {"allowed", command.growth}}},
          {"faults", faults},
          {"machine", machineName()},
          {"date", timestamp()}};
}

int soak(const SoakCommand& command) {
  checkBackend(command.backend);
  requireWritable(command.jsonFile);
  scenes::SoakOptions options;
  options.world.backend = command.backend;
  options.world.threads = command.threads;
  options.world.params.iterations = command.iterations;
  options.seed = command.seed;
  options.bodies = command.bodies;
  options.joints = command.joints;
  scenes::Soak soak(options);
  std::FILE* const out = command.jsonFile == "-" ? stderr : stdout;
  constexpr double kEvery = 10;  // between lines [s]
  const double start = secondsNow();
  double shown = start;
  SoakMemory memory;
  const auto line = [&] {
    const scenes::SoakCounts& c = soak.counts();
    fmt::print(out,
               "{:>7}  {} steps, {} bodies, {} added, {} removed, {} disturbed, {} snapshots, {} restores, "
               "{} replays, {:.1f} MB tables, "
               "{:.0f} MB resident, {} faults\n",
               clockText(secondsNow() - start), c.steps, c.bodies, c.added, c.removed,
               c.pushed + c.forced + c.placed, c.snapshots, c.restores, c.replays, tablesMb(soak),
               residentMb(), soak.faults().size());
    std::fflush(out);
  };
  const auto done = [&] {
    return command.steps > 0 ? static_cast<double>(soak.counts().steps) / static_cast<double>(command.steps)
                             : (secondsNow() - start) / (60 * command.minutes);
  };
  while (done() < 1) {
    soak.step();
    // allocations of the first steps do not count as growth
    constexpr int kWarm = 100;
    if (memory.start == 0 && soak.counts().steps >= kWarm) memory.start = residentMb();
    if (memory.tenth == 0 && done() >= .1) {
      memory.tenth = residentMb();
      memory.tenthTables = tablesMb(soak);
    }
    if (secondsNow() - shown < kEvery) continue;
    shown = secondsNow();
    line();
  }
  line();
  memory.end = residentMb();
  // tables that grow have a reason, or are a fault of their own
  memory.growth = memory.end - memory.tenth - std::max(0., tablesMb(soak) - memory.tenthTables);
  std::vector<std::string> faults = soak.faults();
  if (memory.growth > command.growth)
    faults.push_back(fmt::format(
        "resident memory, without tables, grew by {:.1f} MB after the first tenth; allowed are {} MB",
        memory.growth, command.growth));
  fmt::print(out, "memory: {:+.1f} MB after the first tenth, without tables\n", memory.growth);
  for (const std::string& fault : faults) fmt::print(out, "fault: {}\n", fault);
  fmt::print(out, "verdict: {}\n", faults.empty() ? "holds" : "does not hold");
  if (!command.jsonFile.empty())
    writeOutput(command.jsonFile,
                io::prettyJson(jsonOf(command, soak, secondsNow() - start, memory, faults)));
  return faults.empty() ? kHolds : kDoesNotHold;
}

}  // namespace

void addSoak(CLI::App& app, int& status) {
  auto options = std::make_shared<SoakCommand>();
  CLI::App* command = app.add_subcommand("soak",
                                         "Step a heap for minutes while bodies come, go and are pushed at "
                                         "random, and check what must stay true");
  command->add_option("-m,--minutes", options->minutes, "How long")
      ->check(aboveZero())
      ->capture_default_str();
  command->add_option("-n,--steps", options->steps, "So many steps instead of minutes")
      ->check(wholeNumber(1));
  command->add_option("--seed", options->seed, "Of the random edits: the same seed gives the same run")
      ->capture_default_str();
  command->add_option("--bodies", options->bodies, "That the heap varies about")
      ->check(CLI::Range(2, 1000000))
      ->capture_default_str();
  command->add_flag("--joints", options->joints, "Also pairs of cubes on joints, made and removed");
  command->add_option("-i,--iterations", options->iterations, "Solver iterations per step")
      ->check(wholeNumber(1))
      ->capture_default_str();
  command->add_option("-b,--backend", options->backend, "Where the step runs (see 'rubble info build')")
      ->capture_default_str();
  command->add_option("-t,--threads", options->threads, "Worker threads; 0 is one a core")
      ->check(wholeNumber(0))
      ->capture_default_str();
  command
      ->add_option("--growth", options->growth,
                   "Megabytes of resident memory that may come after the first tenth of the run, besides "
                   "those of the engine's tables")
      ->check(CLI::Number)
      ->capture_default_str();
  command->add_option("--json", options->jsonFile, "Write what happened as JSON; '-' is standard output")
      ->type_name("FILE");
  command->footer(
      "Checked: counts and ids of bodies, finite states, nothing lost or below the ground, no clashes, "
      "tables that grow for a reason\n"
      "only, restored snapshots, stretches that are run twice and must have the same bits, and memory that "
      "stays flat.\n"
      "Exit status 1 if something did not hold.");
  command->callback([options, &status] { status = soak(*options); });
}

}  // namespace rubble::cli
