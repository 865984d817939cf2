#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>

#include <CLI/CLI.hpp>

#include <rubble/error.h>

#include "apps/cli/command.h"
#include "apps/cli/processes.h"
#include "apps/cli/program.h"

namespace {

int runProgram(int argc, char** argv) {
  CLI::App app;
  int status = rubble::cli::kHolds;
  rubble::cli::addProgram(app, status);
  return rubble::cli::parse(app, argc, argv) ? status : rubble::cli::kHolds;
}

/// Flushes standard output; a full disk is detected here.
void flushOutput() {
  const bool streamGood = static_cast<bool>(std::cout.flush());
  if (std::fflush(stdout) != 0 || std::ferror(stdout) || !streamGood)
    throw rubble::Error("standard output", "to be written in full", std::strerror(errno));
}

}  // namespace

int main(int argc, char** argv) {
  rubble::cli::Processes processes;
  try {
    processes.join();
    const int status = runProgram(argc, argv);
    flushOutput();
    return status;
  } catch (const std::exception& error) {
    processes.fail(error.what());
    std::fprintf(stderr, "rubble: %s\n", error.what());
    return rubble::cli::kBadInput;
  }
}
