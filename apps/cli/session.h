#pragma once
/// One run with everything that it may leave behind: a progress bar, a recording, pictures, a record.
#include <string>
#include <vector>

#include "apps/cli/job.h"
#include "apps/cli/output.h"
#include "io/report_json.h"

namespace rubble::cli {

struct SessionOptions {
  bool quiet = false;      ///< no progress on standard error
  std::string recordFile;  ///< "" for none
  std::string inputsFile;  ///< of the log of inputs; "" for none
  std::string sensorFile;  ///< of the readings of sensors, as CSV; "" for none
  std::vector<PictureRequest> pictures;
  Look look;
  std::string checkpointFile;  ///< of the state; "" for none
  int checkpointInterval = 0;  ///< steps between checkpoints
  std::string resumeFile;      ///< checkpoint to go on from; "" for none
  bool hash = false;           ///< the record gets the hash of the state at the end
  bool series = false;         ///< the record gets the time, step time and energy of every step
};

struct SessionResult {
  io::RunRecord record;
  std::vector<StepReport> reports;
};

/// Runs a job to its end.
SessionResult runSession(PreparedJob prepared, const SessionOptions& options);

}  // namespace rubble::cli
