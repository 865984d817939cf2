#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/cli/command.h"
#include "apps/cli/file_job.h"

namespace rubble::cli {
namespace {

struct CheckOptions {
  std::vector<std::string> files;
  bool quiet = false, json = false;
};

/// Faults of a file, also of one that cannot be read at all.
std::vector<io::Fault> faultsOf(const std::string& file, io::SceneFile& scene) {
  try {
    std::vector<io::Fault> faults = checkFile(file, scene);
    return faults.empty() ? worldFaults(scene.scene) : faults;
  } catch (const Error& error) {
    return {{"", 0, 0, messageOf(error)}};
  }
}

int check(const CheckOptions& options) {
  int status = kHolds;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const std::string& file : options.files) {
    io::SceneFile scene;
    const std::vector<io::Fault> faults = faultsOf(file, scene);
    if (options.json) {
      nlohmann::ordered_json entry{{"file", file}, {"good", faults.empty()}};
      for (const io::Fault& fault : faults)
        entry["faults"].push_back({{"path", fault.path},
                                   {"line", fault.line},
                                   {"column", fault.column},
                                   {"message", fault.message}});
      if (!faults.empty()) status = kBadInput;
      list.push_back(std::move(entry));
    } else if (!faults.empty()) {
      fmt::print(stderr, "{}\n", io::faultText(file, faults));
      status = kBadInput;
    } else if (!options.quiet) {
      fmt::print("{}: good: {} bodies, {} joints, {} events, {} claims\n", file, scene.scene.bodies.size(),
                 scene.scene.joints.size(), scene.scene.events.size(), scene.claims.size());
    }
  }
  if (options.json) fmt::print("{}\n", list.dump(2));
  return status;
}

}  // namespace

void addCheck(CLI::App& app, int& status) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand("check", "Read scene files and explain every fault with its place");
  command->add_option("files", options->files, "Scene files (.json)")->required();
  command->add_flag("-q,--quiet", options->quiet, "Say nothing of files that are good");
  command->add_flag("--json", options->json, "As JSON: a list with an entry for each file");
  command->footer("Exit status: 0 every file is good, 2 one is not.");
  command->callback([options, &status] { status = check(*options); });
}

}  // namespace rubble::cli
