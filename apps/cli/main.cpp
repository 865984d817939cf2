#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <rubble/info.h>

#include "apps/cli/command.h"

namespace {

constexpr const char* kDescription = "Rubble: rigid-body physics by augmented vertex block descent.\n"
                                     "Runs, measures and checks scenes, from the built-in registry or from JSON files.";
constexpr const char* kFooter = "Exit status: 0 the verdict holds, 1 it does not, 2 bad input or usage.\n"
                                "Start with: rubble info scenes; rubble run pyramid --picture pyramid.png";

}  // namespace

int main(int argc, char** argv) {
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
  addInfo(app, status);
  addPicture(app, status);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kHolds : kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "rubble: {}\n", error.what());
    return kBadInput;
  }
  return status;
}
