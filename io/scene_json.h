#pragma once
/// Scenes as JSON files. docs/scene_format.md is the description for authors.
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <rubble/actuators.h>
#include <rubble/appearance.h>
#include <rubble/error.h>
#include <rubble/scene.h>
#include <rubble/sensors.h>

namespace rubble::io {

/// One line of a file's verdict: the metric lies in [min, max].
struct FileClaim {
  std::string metric;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string why;
};

/// Where a picture of the scene is taken from [m].
struct FileCamera {
  Vec3 eye{8, -12, 6};
  Vec3 target{0, 0, 1};
};

/// Everything that a scene file says.
struct SceneFile {
  Scene scene;
  std::vector<FileClaim> claims;
  std::optional<FileCamera> camera;
  Appearance appearance;
  std::vector<SensorDef> sensors;
  std::vector<ActuatorDef> actuators;
  int steps = 600;       ///< of a full run
  int iterations = 4;    ///< that the verdict is stated for
  int substeps = 1;      ///< likewise
  int smashStep = -1;    ///< first step of the smash phase, or -1
  double dt = 1.0 / 60;  ///< time step that steps and events are counted in [s]
};

/// One fault of a file.
struct Fault {
  std::string path;  ///< "bodies[3].mass"; empty for a fault of the syntax
  int line = 0;      ///< of a fault of the syntax, from 1; else 0
  int column = 0;
  std::string message;  ///< "expected a number above 0 [kg], got -1"

  /// "bodies[3].mass: expected ..." or "line 3, column 7: ..."
  std::string text() const;
};

/// Reads a scene from JSON text and collects every fault. The scene is complete only if there is none. Mesh
/// files that it names lie in `folder`, unless it gives their full path.
SceneFile parseScene(const std::string& text, std::vector<Fault>& faults, const std::string& folder = "");
/// The folder that a file lies in.
std::string folderOf(const std::string& file);

/// "scene.json: 2 faults", and then each fault on its line.
std::string faultText(const std::string& file, const std::vector<Fault>& faults);

/// Reads a scene file. Throws Error that names the file and every fault, one a line.
SceneFile readScene(const std::string& file);

/// Writes a scene so that reading it gives back the same numbers, bit for bit.
std::string toJson(const SceneFile& scene);

/// Writes `text` to a file, or throws Error.
void writeText(const std::string& file, const std::string& text);

}  // namespace rubble::io
