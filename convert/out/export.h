#pragma once
/// Recordings as files of other programs: USD, glTF, OBJ, CSV and NumPy. docs/exporting.md lists what each
/// holds.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/recording.h"

namespace rubble::convert {

struct ExportCamera {
  Vec3 eye, target;          ///< [m]
  double fieldOfView = 0.6;  ///< full vertical angle [rad]
};

struct ExportOptions {
  int from = 0;   ///< first frame
  int to = -1;    ///< last frame; -1: that of the recording
  int every = 1;  ///< one frame of so many
  std::optional<ExportCamera> camera;
  /// Linear color of a body or deformable object, each channel 0 to 1; the same in all frames. None: gray.
  std::function<Vec3(const io::PictureBody&)> color;
  bool resume = false;  ///< goes on with what an export that was cut off has left
  /// Called after each frame that was written, with the number of frames done and that of all.
  std::function<void(int done, int all)> progress;
};

struct ExportResult {
  int frames = 0;                  ///< written by this call
  int kept = 0;                    ///< of an earlier call, with `resume`
  double writeSeconds = 0;         ///< wall clock of writing alone; reading goes on beside it [s]
  std::vector<std::string> notes;  ///< parts of the recording that the format does not hold
};

/// Endings of the formats: ".usda", ".usdc", ".glb", ".obj", ".csv", ".npz".
const std::vector<std::string>& exportEndings();

/// Writes frames of a recording into a file, in the format that its name ends in. A sequence of OBJ files has
/// a number in its name ("frame_%04d.obj"). Memory holds a few frames, never all of them. A file is
/// there completely or not at all, except CSV files and sequences, which `resume` goes on with.
/// Throws Error for an unknown ending, for frames that the recording lacks, for a recording that the format
/// cannot hold, and if the file cannot be written.
ExportResult exportRecording(io::RecordingReader& recording, const std::string& file,
                             const ExportOptions& options = {});

}  // namespace rubble::convert
