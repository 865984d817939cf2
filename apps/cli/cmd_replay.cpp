#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rubble/info.h>

#include "apps/cli/command.h"
#include "io/input_log.h"

namespace rubble::cli {
namespace {

struct ReplayOptions {
  std::string file;
  io::ReplayOptions replay;
  bool check = false, json = false;
};

int run(const ReplayOptions& options) {
  const io::Replay replay = io::replayInputs(options.file, options.replay);
  const BuildInfo build = buildInfo();
  const int status = replay.difference && options.check ? kDoesNotHold : kHolds;
  if (options.json) {
    nlohmann::ordered_json record{
        {"recorded_by", replay.recordedBy}, {"steps", replay.steps}, {"identical", !replay.difference}};
    record["hash"] = fmt::format("{:016x}", replay.hash);
    if (replay.difference)
      record["first_difference"] = {{"step", replay.difference->step}, {"table", replay.difference->table}};
    fmt::print("{}\n", record.dump(2));
    return status;
  }
  fmt::print("recorded by {}\nreplayed by {}, {}, {}\n", replay.recordedBy, build.version, build.commit,
             build.compiler);
  if (!replay.difference) {
    fmt::print("{} steps, the same bits, hash {:016x}\n", replay.steps, replay.hash);
    return kHolds;
  }
  const auto& [step, table] = *replay.difference;
  fmt::print("first difference: {}, table {}\n",
             step == 0 ? std::string("before the first step") : fmt::format("after step {}", step), table);
  return status;
}

}  // namespace

void addReplay(CLI::App& app, int& status) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand(
      "replay",
      "Repeat the calls of 'rubble run --record-inputs', and find the first step and table that differ");
  command->add_option("file", options->file, "A log of inputs")->required();
  command->add_option("--backend", options->replay.backend, "Another backend than the recorded one");
  command->add_option("--threads", options->replay.threads, "Threads of the cpu backend; 0: one per core")
      ->check(CLI::Range(0, 1024));
  command
      ->add_option("--record-inputs", options->replay.record,
                   "Write the log of the replay: with the same build, the same bytes")
      ->type_name("FILE");
  command->add_flag("--check", options->check, "Exit with 1 if anything differs");
  command->add_flag("--json", options->json, "As JSON");
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace rubble::cli
