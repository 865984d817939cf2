#include "apps/cli/program.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <rubble/info.h>

#include "apps/cli/command.h"
#include "apps/cli/suggest.h"
#include "scenes/registry.h"

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

bool isOption(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && !std::isdigit(static_cast<unsigned char>(word[1]));
}

std::vector<const CLI::App*> commandsOf(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}
std::vector<std::string> namesOf(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

/// What a word may stand for that is no subcommand of `app`: one of them, one of theirs, or a scene.
std::string nearCommand(const std::string& word, const CLI::App& app) {
  std::string near = suggestion(word, namesOf(commandsOf(app)));
  for (const CLI::App* command : commandsOf(app))
    if (near.empty()) near = suggestion(word, namesOf(commandsOf(*command)), command->get_name() + " ");
  std::vector<std::string> names;
  for (const scenes::Spec& spec : scenes::registry()) names.push_back(spec.name);
  return near.empty() ? suggestion(word, names, "run ") : near;
}

/// At most so many bytes, with a mark where the rest is left out.
std::string shortened(const std::string& text, std::size_t most = 200) {
  return text.size() <= most ? text : text.substr(0, most) + "...";
}

}  // namespace

std::string usageMessage(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<const CLI::App*> chosen = chosenCommands(app);
  const CLI::App& last = *chosen.back();
  std::string name;
  for (const CLI::App* command : chosen) name += (name.empty() ? "" : " ") + command->get_name();
  std::string message = error.what();
  const std::vector<std::string> unknown = app.remaining(true);
  // The library reports an unknown subcommand as a missing one.
  if (last.get_require_subcommand_min() > 0 && !unknown.empty()) {
    message = fmt::format("there is no subcommand '{}'{}", shortened(unknown.front()),
                          nearCommand(unknown.front(), last));
  } else if (const auto option = std::ranges::find_if(unknown, isOption); option != unknown.end()) {
    std::vector<std::string> names;
    for (const CLI::Option* known : last.get_options())
      for (const std::string& own : known->get_lnames()) names.push_back("--" + own);
    const std::string own = option->substr(0, option->find('='));
    message = fmt::format("'{}' has no option '{}'{}", name, shortened(own), suggestion(own, names));
  }
  return fmt::format("{}\nRun '{} --help' for what there is.", shortened(message, 1500), name);
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
  addCompletion(app, status);
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
