#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rubble/error.h>

#include "apps/cli/command.h"
#include "apps/cli/output.h"
#if defined(RUBBLE_HAS_CAIRO)
#include "render/plot.h"
#endif

namespace rubble::cli {
namespace {

struct PlotCommand {
  std::vector<std::string> reports;
  std::string out;
  std::string kind = "all";
  bool json = false;
};

#if defined(RUBBLE_HAS_CAIRO)
const std::vector<std::string>& plotKinds() { return render::plotKinds(); }
void plot(const PlotCommand& options) {
  render::writeFigure(render::Figure(render::readReports(options.reports), options.kind), options.out);
}
#else
std::vector<std::string> plotKinds() { return {"none in this build"}; }
void plot(const PlotCommand&) {
  throw Error("plot", "a build with Cairo (Debian: apt-get install libcairo2-dev fonts-dejavu-core)",
              "one without");
}
#endif

}  // namespace

void addPlot(CLI::App& app, int& status) {
  auto options = std::make_shared<PlotCommand>();
  CLI::App* command = app.add_subcommand("plot",
                                         "Plot times, errors and energy of reports (JSON of run or bench)");
  command->add_option("reports", options->reports, "Files written by run --json or bench --json")
      ->required()
      ->type_name("REPORT.json");
  command->add_option("-o,--out", options->out, "plot.svg or plot.png")->required()->type_name("FILE");
  command->add_option("--kind", options->kind, fmt::format("{}", fmt::join(plotKinds(), ", ")))
      ->capture_default_str();
  addWrittenOption(*command, options->json);
  command->callback([options, &status] {
    plot(*options);
    if (options->json) printWritten({options->out}, {{"reports", options->reports}});
    status = kHolds;
  });
}

}  // namespace rubble::cli
