/// Command lines: the parser of the program, with subcommands that do not run, and what makes settings of
/// words. Each line of the input is a word.
#include <algorithm>
#include <cmath>
#include <span>
#include <sstream>

#include <rubble/rubble.h>

#include "apps/cli/job.h"
#include "apps/cli/output.h"
#include "apps/cli/program.h"
#include "scenes/registry.h"
#include "tests/fuzz/target.h"

namespace rubble::fuzz {
namespace {

/// Words of a command line, and those of them that are read as settings as well, which takes longer.
constexpr std::size_t kMostWords = 40, kMostSettings = 6;

std::vector<std::string> wordsOf(std::span<const std::uint8_t> bytes) {
  std::istringstream lines(std::string(bytes.begin(), bytes.end()));
  std::vector<std::string> words;
  for (std::string line; words.size() < kMostWords && std::getline(lines, line);) {
    // the arguments of a program end at a zero byte
    words.push_back(line.substr(0, line.find('\0')));
  }
  return words;
}

/// Thrown where a subcommand has its words and would run.
struct Parsed {};

/// Stops each subcommand before it runs. Its own callback stays, since it owns the options.
void stopBeforeRun(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    command->parse_complete_callback([] { throw Parsed{}; });
    stopBeforeRun(*command);
  }
}

/// The parser of the program. It takes far longer to make than to use, and clears itself before it parses.
struct Program {
  CLI::App app;
  int status = 0;
  Program() {
    cli::addProgram(app, status);
    stopBeforeRun(app);
  }
};

void parseAsProgram(const std::vector<std::string>& words) {
  static Program program;
  std::vector<const char*> argv{"rubble"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  try {
    program.app.parse(static_cast<int>(argv.size()), argv.data());
  } catch (const Parsed&) {
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0)
      expect(!cli::usageMessage(program.app, error).empty(), "bad usage without a message");
  }
  expect(program.status == 0, "a subcommand ran");
}

template <class F> void orError(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    expect(std::string(error.what()).find(": expected ") != std::string::npos,
           std::string("an Error that does not say what was expected: ") + error.what());
  }
}

void readAsSettings(const std::vector<std::string>& words) {
  for (const std::string& word : std::span(words).first(std::min(words.size(), kMostSettings))) {
    orError([&] {
      const auto [name, number] = cli::parseAssignment(word, "--param");
      expect(std::isfinite(number), "a setting is not finite");
      Params params;
      setParam(params, name, number);
    });
    orError([&] {
      const scenes::Spec& spec = scenes::find(word);
      for (const std::string& other : words) {
        orError([&] {
          const auto [name, number] = cli::parseAssignment(other, "--arg");
          scenes::resolve(spec, {{name, number}});
        });
      }
    });
    orError([&] {
      cli::PictureOptions options;
      options.size = word;
      const cli::Look look = cli::lookOf(options);
      expect(look.width > 0 && look.height > 0, "a picture has no size");
    });
    orError([&] { cli::checkBackend(word); });
  }
  orError([&] {
    for (const cli::JobOptions& job : cli::comparedJobs({}, words))
      expect(job.iterations.value_or(1) > 0, "a job has no iterations");
  });
}

}  // namespace

void testInput(std::span<const std::uint8_t> bytes) {
  const std::vector<std::string> words = wordsOf(bytes);
  parseAsProgram(words);
  readAsSettings(words);
}

}  // namespace rubble::fuzz
