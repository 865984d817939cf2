#pragma once
/// The one table of recorded hashes, tests/golden.txt.
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/registry.h"

namespace rubble::test {

/// A run whose hash is recorded: a scene of the registry at the size of its tests.
struct Golden {
  std::string platform;  ///< "cpu", or "cuda-90-13000": compute capability and toolkit
  std::string scene;
  int steps = 0;
  bool sorts = false;  ///< with the bodies sorted in the middle
  std::uint64_t hash = 0;

  /// A name for GoogleTest.
  std::string name() const {
    std::string out = scene + "_" + std::to_string(steps) + (sorts ? "_sorted" : "");
    for (char& c : out)
      if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return out;
  }
  friend std::ostream& operator<<(std::ostream& out, const Golden& g) { return out << g.name(); }
};

/// The rows of a platform with so many steps, or with any number.
inline std::vector<Golden> goldens(const std::string& platform, int steps = 0) {
  std::ifstream in(RUBBLE_SOURCE_DIR "/tests/golden.txt");
  std::vector<Golden> out;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    Golden row;
    std::string order;
    std::istringstream words(line);
    if (!(words >> row.platform >> row.scene >> row.steps >> order >> std::hex >> row.hash))
      throw std::runtime_error("tests/golden.txt: " + line);
    row.sorts = order == "sorted";
    if (row.platform == platform && (steps == 0 || row.steps == steps)) out.push_back(row);
  }
  return out;
}

/// The hash that a run has with these options.
inline std::uint64_t hashOf(const Golden& golden, WorldOptions options) {
  const scenes::Spec& spec = scenes::find(golden.scene);
  scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
  job.probes.clear();
  options.timings = false;
  options.params.iterations = job.iterations, options.params.substeps = job.substeps;
  scenes::Runner runner(std::move(job), options);
  for (int step = 0; step < golden.steps; ++step) {
    if (golden.sorts && step == golden.steps / 2) runner.world().sortBodies();
    runner.step();
  }
  return runner.world().hash();
}

/// A row with the hash that was found, as the table has it.
inline std::string rowOf(const Golden& golden, std::uint64_t hash) {
  std::ostringstream out;
  out << golden.platform << ' ' << golden.scene << ' ' << golden.steps << ' '
      << (golden.sorts ? "sorted" : "plain") << ' ' << std::hex << hash;
  return out.str();
}

}  // namespace rubble::test
