#pragma once
/// Subcommands. Each adds itself to the program and, when chosen, runs and sets the exit status.
#include <CLI/CLI.hpp>

namespace rubble::cli {

/// Exit status of the program.
enum Status : int {
  kHolds = 0,        ///< done; the verdict holds
  kDoesNotHold = 1,  ///< done; the verdict does not hold
  kBadInput = 2,     ///< the input or the command line is wrong
};

struct JobOptions;
/// What `rubble run` and `rubble view` do with a job; the exit status.
int runJob(const JobOptions& job);
int viewJob(const JobOptions& job);

void addRun(CLI::App& app, int& status);
void addBench(CLI::App& app, int& status);
void addCheck(CLI::App& app, int& status);
void addCompare(CLI::App& app, int& status);
void addCompletion(CLI::App& app, int& status);
void addDemo(CLI::App& app, int& status);
void addExport(CLI::App& app, int& status);
void addFracture(CLI::App& app, int& status);
void addImport(CLI::App& app, int& status);
void addInfo(CLI::App& app, int& status);
void addPicture(CLI::App& app, int& status);
void addSoak(CLI::App& app, int& status);
void addPlot(CLI::App& app, int& status);
void addRender(CLI::App& app, int& status);
void addReplay(CLI::App& app, int& status);
void addView(CLI::App& app, int& status);

}  // namespace rubble::cli
