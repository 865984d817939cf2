#include <fmt/format.h>

#include "apps/cli/command.h"
#include "apps/cli/file_job.h"

namespace rubble::cli {
namespace {

struct CheckOptions {
  std::vector<std::string> files;
  bool quiet = false;
};

int check(const CheckOptions& options) {
  int status = kHolds;
  for (const std::string& file : options.files) {
    io::SceneFile scene;
    std::vector<io::Fault> faults = checkFile(file, scene);
    if (faults.empty()) faults = worldFaults(scene.scene);
    if (!faults.empty()) {
      fmt::print(stderr, "{}\n", io::faultText(file, faults));
      status = kBadInput;
    } else if (!options.quiet) {
      fmt::print("{}: good: {} bodies, {} joints, {} events, {} claims\n", file, scene.scene.bodies.size(),
                 scene.scene.joints.size(), scene.scene.events.size(), scene.claims.size());
    }
  }
  return status;
}

}  // namespace

void addCheck(CLI::App& app, int& status) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand("check", "Read scene files and explain every fault with its place");
  command->add_option("files", options->files, "Scene files (.json)")->required();
  command->add_flag("-q,--quiet", options->quiet, "Say nothing of files that are good");
  command->footer("Exit status: 0 every file is good, 2 one is not.");
  command->callback([options, &status] { status = check(*options); });
}

}  // namespace rubble::cli
