#pragma once
/// The command line program: its subcommands and options, and what it says to words that are none of them.
#include <string>

#include <CLI/CLI.hpp>

namespace rubble::cli {

/// Adds description, version and all subcommands, which set `status` when they run.
void addProgram(CLI::App& app, int& status);
/// What is wrong with words that the program does not take, with a hint at --help.
std::string usageMessage(const CLI::App& app, const CLI::ParseError& error);
/// Parses the words and runs the subcommand that they choose. Throws std::runtime_error for words that the
/// program does not take, with usageMessage(). Returns false if help or version was asked for, and printed.
bool parse(CLI::App& app, int argc, const char* const* argv);

}  // namespace rubble::cli
