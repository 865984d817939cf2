#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/command.h"
#include "render/plot.h"

namespace rubble::cli {
namespace {

struct PlotCommand {
  std::vector<std::string> reports;
  std::string out;
  std::string kind = "all";
};

}  // namespace

void addPlot(CLI::App& app, int& status) {
  auto options = std::make_shared<PlotCommand>();
  CLI::App* command = app.add_subcommand("plot", "Plot times, errors and energy of reports (JSON of run or bench)");
  command->add_option("reports", options->reports, "Files written by run --json or bench --json")->required()->type_name("REPORT.json");
  command->add_option("-o,--out", options->out, "plot.svg or plot.png")->required()->type_name("FILE");
  command->add_option("--kind", options->kind, fmt::format("{}", fmt::join(render::plotKinds(), ", ")))->capture_default_str();
  command->callback([options, &status] {
    render::writeFigure(render::Figure(render::readReports(options->reports), options->kind), options->out);
    status = kHolds;
  });
}

}  // namespace rubble::cli
