#pragma once
/// Logs of all calls that change a world, with the hashes of its tables after each step. Another build that
/// replays the log finds the first step and the first table that differ (docs/determinism.md).
///
/// A log is text. Each line is a JSON value: first the build, the options and the scene, then the calls.
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rubble/inputs.h>
#include <rubble/world.h>

#include "io/output_file.h"

namespace rubble::io {

class InputLog {
 public:
  /// Begins with `world` as it is after it was made of the scene with the options. Takes its input sink.
  /// Throws Error if the file cannot be written.
  InputLog(const std::string& file, const Scene& scene, const WorldOptions& options, World& world);
  ~InputLog();
  InputLog(const InputLog&) = delete;
  InputLog& operator=(const InputLog&) = delete;
  /// Ends the log. Without it the file is as it was before.
  void finish();

 private:
  void writeLine(const nlohmann::ordered_json& json);

  OutputFile out_;
  World& world_;
  std::vector<Snapshot> snapshots_;  ///< taken, by number
};

/// Where a replay parts from its log.
struct ReplayDifference {
  std::int64_t step = 0;  ///< steps taken; 0: the worlds differ from the start
  std::string table;      ///< the first table that differs, in the order of World::tableHashes()
};

struct Replay {
  std::string recordedBy;  ///< version, commit and compiler
  std::int64_t steps = 0;  ///< steps replayed
  std::uint64_t hash = 0;  ///< World::hash() at the end
  std::optional<ReplayDifference> difference;
};

struct ReplayOptions {
  std::string backend = {};  ///< "": as recorded
  int threads = 0;           ///< of the CPU backends; 0: one per core
  /// The log of the replay goes to this file, to its end or to the first difference; "": to none. A log that
  /// is replayed by the build that wrote it is written again with the same bytes.
  std::string record = {};
};

/// Replays a log, to its end or to the first difference. Throws Error, with the line, for a file that is no
/// log and for a call that the world refuses.
Replay replayInputs(const std::string& file, const ReplayOptions& options = {});

}  // namespace rubble::io
