#pragma once
/// Options and small helpers for what a run writes.
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "io/picture.h"
#include "scenes/registry.h"

namespace rubble::cli {

/// A picture to be taken after so many steps (0: of the start).
struct PictureRequest {
  int afterSteps = 0;
  std::string file;
};

struct PictureOptions {
  std::string file;
  std::vector<int> at;              ///< after how many steps; none: at the end
  std::vector<double> eye, target;  ///< none: the camera of the scene
  std::string size = "1280x720";
  std::string colorBy = "body";
  double fieldOfView = 34;  ///< [degrees]
};

/// How pictures are taken; what is empty is up to the scene.
struct Look {
  std::optional<Vec3> eye, target;
  int width = 1280, height = 720;
  double fieldOfView = .6;  ///< [rad]
  io::ColorBy colorBy = io::ColorBy::Body;
};

/// Adds the picture options; `fileOption` names the one that takes the file.
void addPictureOptions(CLI::App& app, PictureOptions& options, const std::string& fileOption);
/// Those of them that say how the picture looks.
void addViewOptions(CLI::App& app, PictureOptions& options);
/// Names for --color-by.
std::vector<std::string> colorKeys();
/// Throws Error for a quantity that is not known of a trajectory.
void requireWorldless(io::ColorBy colorBy);
/// Throws Error for a size or a point that is none.
Look lookOf(const PictureOptions& options);
/// One request for each step of --at; files are numbered if there are several. Throws Error for a step beyond
/// the run.
std::vector<PictureRequest> picturesOf(const PictureOptions& options, int steps);

/// Throws Error if a file that is to be written at the end could not be written now; "" and "-" are good.
void requireWritable(const std::string& file);
/// Writes text to a file, or to standard output for "-".
void writeOutput(const std::string& file, const std::string& text);

/// Adds --json to a command that writes files: it says what it wrote as JSON in place of text.
void addWrittenOption(CLI::App& app, bool& json);
/// Prints an object: "files", each with its name and its size in bytes (null for the name of a numbered
/// sequence), then the facts.
void printWritten(const std::vector<std::string>& files, const nlohmann::ordered_json& facts);

}  // namespace rubble::cli
