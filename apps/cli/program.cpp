#include "apps/cli/program.h"

#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <rubble/info.h>

#include "apps/cli/command.h"

namespace rubble::cli {
namespace {

constexpr const char* kDescription =
    "Rubble: rigid-body physics by augmented vertex block descent.\n"
    "Runs, measures and checks scenes, from the built-in registry or from JSON files.";
constexpr const char* kFooter =
    "Exit status: 0 the verdict holds, 1 it does not, 2 bad input or usage.\n"
    "Start with: rubble info scenes; rubble run pyramid --picture pyramid.png";

/// The subcommands that were chosen, the program itself first.
std::vector<const CLI::App*> chosenCommands(const CLI::App& app) {
  std::vector<const CLI::App*> chosen{&app};
  while (!chosen.back()->get_subcommands().empty())
    chosen.push_back(chosen.back()->get_subcommands().front());
  return chosen;
}

}  // namespace

std::string usageMessage(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<const CLI::App*> chosen = chosenCommands(app);
  std::string message = error.what();
  // The library reports an unknown subcommand as a missing one.
  const std::vector<std::string> unknown = app.remaining(true);
  if (chosen.back()->get_require_subcommand_min() > 0 && !unknown.empty())
    message = fmt::format("there is no subcommand '{}'", unknown.front());
  std::string name;
  for (const CLI::App* command : chosen) name += command->get_name() + " ";
  return fmt::format("{}\nRun '{}--help' for what there is.", message, name);
}

void addProgram(CLI::App& app, int& status) {
  app.name("rubble");
  app.description(kDescription);
  app.footer(kFooter);
  app.require_subcommand(1);
  app.set_version_flag("--version", [] { return "rubble " + buildInfo().version; });
  addRun(app, status);
  addBench(app, status);
  addCheck(app, status);
  addCompare(app, status);
  addDemo(app, status);
  addExport(app, status);
  addFracture(app, status);
  addImport(app, status);
  addInfo(app, status);
  addPicture(app, status);
  addSoak(app, status);
  addPlot(app, status);
  addRender(app, status);
  addReplay(app, status);
  addView(app, status);
}

bool parse(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) throw std::runtime_error(usageMessage(app, error));
    app.exit(error);
    return false;
  }
  return true;
}

}  // namespace rubble::cli
