#include <fmt/format.h>

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
};

std::string clockText(double seconds) {
  return fmt::format("{}:{:02}", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
}

nlohmann::ordered_json jsonOf(const SoakCommand& command, const scenes::Soak& soak, double seconds,
                              double rssBefore) {
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
          {"engine_mb", static_cast<double>(c.memory) / 1e6},
          {"rss_mb", {{"start", rssBefore}, {"end", residentMb()}}},
          {"faults", soak.faults()},
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
  double shown = start, rssBefore = 0;
  const auto line = [&] {
    const scenes::SoakCounts& c = soak.counts();
    fmt::print(out,
               "{:>7}  {} steps, {} bodies, {} added, {} removed, {} disturbed, {} snapshots, {} restores, "
               "{} replays, {:.1f} MB tables, "
               "{:.0f} MB resident, {} faults\n",
               clockText(secondsNow() - start), c.steps, c.bodies, c.added, c.removed,
               c.pushed + c.forced + c.placed, c.snapshots, c.restores, c.replays,
               static_cast<double>(c.memory) / 1e6, residentMb(), soak.faults().size());
    std::fflush(out);
  };
  const auto goesOn = [&] {
    return command.steps > 0 ? soak.counts().steps < command.steps
                             : secondsNow() - start < 60 * command.minutes;
  };
  while (goesOn()) {
    soak.step();
    // allocations of the first steps do not count as growth
    constexpr int kWarm = 100;
    if (rssBefore == 0 && soak.counts().steps >= kWarm) rssBefore = residentMb();
    if (secondsNow() - shown < kEvery) continue;
    shown = secondsNow();
    line();
  }
  line();
  for (const std::string& fault : soak.faults()) fmt::print(out, "fault: {}\n", fault);
  fmt::print(out, "verdict: {}\n", soak.faults().empty() ? "holds" : "does not hold");
  if (!command.jsonFile.empty())
    writeOutput(command.jsonFile, io::prettyJson(jsonOf(command, soak, secondsNow() - start, rssBefore)));
  return soak.faults().empty() ? kHolds : kDoesNotHold;
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
  command->add_option("--json", options->jsonFile, "Write what happened as JSON; '-' is standard output")
      ->type_name("FILE");
  command->footer(
      "Checked: counts and ids of bodies, finite states, nothing lost or below the ground, no clashes, "
      "tables that grow for a reason\n"
      "only, restored snapshots, and stretches that are run twice and must have the same bits. Exit status 1 "
      "if something did not hold.");
  command->callback([options, &status] { status = soak(*options); });
}

}  // namespace rubble::cli
