#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "apps/cli/command.h"
#include "apps/cli/output.h"
#include "apps/cli/processes.h"
#include "apps/cli/session.h"
#include "apps/cli/text_report.h"

namespace rubble::cli {
namespace {

struct RunOptions {
  JobOptions job;
  std::string jsonFile, recordFile, inputsFile, sensorFile, checkpointFile, resumeFile;
  std::vector<std::string> controls;  ///< "NAME=VALUE"
  int checkpointInterval = 0;
  PictureOptions picture;
  bool quiet = false;
  bool series = false;
  bool noStages = false;
  bool hash = false;
};

void setControls(std::vector<ActuatorDef>& actuators, const std::vector<std::string>& controls) {
  for (const std::string& each : controls) {
    const std::size_t split = each.find('=');
    const std::string name = each.substr(0, split);
    const auto found = std::ranges::find(actuators, name, &ActuatorDef::name);
    if (name.empty() || found == actuators.end())
      throw Error("--control", "the name of an actuator, '=' and a number", "\"" + each + "\"");
    const char *const begin = each.data() + std::min(split, each.size() - 1) + 1, *const end = each.data() +
                                                                                               each.size();
    if (const auto [last, error] = std::from_chars(begin, end, found->control);
        error != std::errc{} || last != end || !std::isfinite(found->control))
      throw Error("--control", "a number after \"" + name + "=\"", "\"" + each + "\"");
  }
}

int run(RunOptions options) {
  for (std::string* file :
       {&options.jsonFile, &options.inputsFile, &options.sensorFile, &options.picture.file})
    *file = outputOfProcess(*file);
  if (options.checkpointFile.empty() != (options.checkpointInterval == 0))
    throw Error("--checkpoint", "a file and --every N", "one of them");
  if (!Processes::isFirst()) options.checkpointFile.clear();
  for (const std::string& file :
       {options.jsonFile, options.inputsFile, options.sensorFile, options.checkpointFile})
    requireWritable(file);
  // all processes pack the recording, and the first one writes it
  if (Processes::isFirst()) requireWritable(options.recordFile);
  PreparedJob prepared = prepareJob(options.job);
  prepared.world.timings = !options.noStages;
  setControls(prepared.job.actuators, options.controls);
  SessionOptions session;
  session.quiet = options.quiet || !Processes::isFirst();
  session.hash = options.hash;
  session.checkpointFile = options.checkpointFile;
  session.checkpointInterval = options.checkpointInterval;
  session.resumeFile = options.resumeFile;
  session.series = options.series;
  session.recordFile = options.recordFile;
  session.inputsFile = options.inputsFile;
  session.sensorFile = options.sensorFile;
  session.look = lookOf(options.picture);
  session.pictures = picturesOf(options.picture, prepared.steps);
  const SessionResult result = runSession(std::move(prepared), session);
  // JSON on standard output excludes all other text.
  if (!options.quiet)
    fmt::print(options.jsonFile == "-" ? stderr : stdout, "{}", textReport(result.record, result.reports));
  if (!options.jsonFile.empty()) writeOutput(options.jsonFile, io::toJson(result.record));
  return result.record.holds ? kHolds : kDoesNotHold;
}

}  // namespace

int runJob(const JobOptions& job) {
  RunOptions options;
  options.job = job;
  return run(options);
}

void addRun(CLI::App& app, int& status) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run",
                                         "Run a scene, report times and quality, and judge its verdict");
  command
      ->add_option("scene", options->job.scene,
                   "Name of a scene (see 'rubble info scenes'), a scene file (.json) or a model (.xml, "
                   ".urdf, .usd, .glb)")
      ->required();
  addArgumentOptions(*command, options->job);
  addSolverOptions(*command, options->job);
  addBackendOptions(*command, options->job);
  command->add_option("--json", options->jsonFile, "Write the report as JSON; '-' is standard output")
      ->type_name("FILE");
  command->add_flag("--series", options->series,
                    "Have time, step time, energy and errors of every step in the report, for 'rubble plot'");
  command->add_flag("--hash", options->hash, "Have the hash of the state at the end in the report");
  command->add_flag("--no-stages", options->noStages, "Without the clocks of stages, as in 'rubble bench'");
  command
      ->add_option("--record", options->recordFile,
                   "Write the trajectory of every body and vertex (.rubble); 'rubble export' makes other "
                   "formats of it")
      ->type_name("FILE");
  command
      ->add_option("--record-inputs", options->inputsFile,
                   "Write every call that changes the world, and hashes of its tables, for 'rubble replay'")
      ->type_name("FILE");
  command
      ->add_option("--sensors", options->sensorFile,
                   "Write the readings of the sensors of the scene after each step, as CSV")
      ->type_name("FILE");
  command
      ->add_option("--control", options->controls,
                   "Control of an actuator of the scene, in place of that at its beginning; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command
      ->add_option("--checkpoint", options->checkpointFile,
                   "Write the state after every N steps (--every), in place of the one before")
      ->type_name("FILE");
  command->add_option("--every", options->checkpointInterval, "Steps between checkpoints")
      ->type_name("N")
      ->check(wholeNumber(1));
  command
      ->add_option(
          "--resume", options->resumeFile,
          "Go on from a checkpoint of the same scene, arguments and parameters, on any number of ranks; "
          "--steps counts from the start of its run")
      ->type_name("FILE");
  addPictureOptions(*command, options->picture, "--picture");
  command->add_flag("-q,--quiet", options->quiet,
                    "No progress and no text report; the exit status is the verdict");
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace rubble::cli
