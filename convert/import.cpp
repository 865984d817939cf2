#include "convert/import.h"

#include <filesystem>

#include <rubble/error.h>

#include "convert/assemble.h"
#include "convert/mjcf.h"
#include "convert/urdf.h"

namespace rubble::convert {
namespace {

/// Steps of 1/240 s and 8 iterations resolve the fast links of robots; a run is 5 s.
constexpr double kDt = 1. / 240;
constexpr int kSteps = 1200, kIterations = 8;

}  // namespace

Import importModel(const std::string& file, const ImportOptions& options) {
  Folders folders;
  for (const std::string& folder : options.folders) folders.allow(folder);
  Source source(folders);
  Import out;
  out.report.file = file;
  const pugi::xml_node root = source.load(file, file);
  folders.allow(source.home());
  const std::string type = root.name();
  Model model;
  if (type == "mujoco") {
    out.report.format = "MJCF";
    model = readMjcf(source, root, options, out.report);
  } else if (type == "robot") {
    out.report.format = "URDF";
    model = readUrdf(source, root, options, out.report);
  } else {
    throw Error(source.path(root), "<mujoco> (MJCF) or <robot> (URDF)", "<" + type + ">");
  }
  out.file.scene = assemble(model, out.report);
  out.file.scene.description = "imported from " + std::filesystem::path(file).filename().string();
  out.file.dt = kDt;
  out.file.steps = kSteps;
  out.file.iterations = kIterations;
  validate(out.file.scene);
  return out;
}

}  // namespace rubble::convert
