#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rubble/error.h>
#include <rubble/info.h>

#include "apps/cli/command.h"

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

std::string messageOf(const CLI::App& app, const CLI::ParseError& error) {
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

int runProgram(int argc, char** argv) {
  using namespace rubble::cli;
  CLI::App app(kDescription, "rubble");
  app.footer(kFooter);
  app.require_subcommand(1);
  app.set_version_flag("--version", [] { return "rubble " + rubble::buildInfo().version; });
  int status = kHolds;
  addRun(app, status);
  addBench(app, status);
  addCheck(app, status);
  addCompare(app, status);
  addDemo(app, status);
  addImport(app, status);
  addInfo(app, status);
  addPicture(app, status);
  addSoak(app, status);
  addPlot(app, status);
  addRender(app, status);
  addView(app, status);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    throw std::runtime_error(messageOf(app, error));
  }
  return status;
}

}  // namespace

/// Flushes standard output; a full disk is detected here.
void flushOutput() {
  const bool streamGood = static_cast<bool>(std::cout.flush());
  if (std::fflush(stdout) != 0 || std::ferror(stdout) || !streamGood)
    throw rubble::Error("standard output", "to be written in full", std::strerror(errno));
}

int main(int argc, char** argv) {
  try {
    const int status = runProgram(argc, argv);
    flushOutput();
    return status;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rubble: %s\n", error.what());
    return rubble::cli::kBadInput;
  }
}
