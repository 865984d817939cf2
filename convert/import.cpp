#include "convert/import.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <rubble/error.h>

#include "convert/assemble.h"
#include "convert/gltf.h"
#include "convert/mjcf.h"
#include "convert/names.h"
#include "convert/urdf.h"
#include "convert/usd_reader.h"

namespace rubble::convert {
namespace {

/// Steps of 1/240 s and 8 iterations resolve the fast links of robots; a run is 5 s.
constexpr double kDt = 1. / 240;
constexpr double kSeconds = 5;
constexpr int kIterations = 8;

/// MJCF or URDF, by the root element.
Model modelOf(Source& source, const pugi::xml_node& root, const ImportOptions& options, Report& report) {
  const std::string type = root.name();
  report.format = type == "mujoco" ? "MJCF" : "URDF";
  if (type == "mujoco") return readMjcf(source, root, options, report);
  if (type == "robot") return readUrdf(source, root, options, report);
  throw Error(source.path(root), "<mujoco> (MJCF) or <robot> (URDF)", "<" + type + ">");
}

Model modelOf(const std::string& bytes, const std::string& file, bool isUsd, Folders& folders,
              Report& report) {
  report.format = isUsd ? "USD" : "glTF";
  return isUsd ? readUsd(bytes, file, folders, report) : readGltf(bytes, file, folders, report);
}

/// They look at the planes, square to their directions, that the middle of the bodies is in.
void addCameras(const Model& model, io::SceneFile& file) {
  Vec3 middle;
  for (const BodyDef& body : file.scene.bodies)
    middle += body.position / static_cast<double>(file.scene.bodies.size());
  Names names;
  for (const ModelCamera& camera : model.cameras) {
    const Vec3 ahead = rotate(camera.pose.q, Vec3{0, 0, -1}), eye = camera.pose.p;
    file.appearance.cameras.push_back({names.unique(camera.name.empty() ? "camera" : camera.name), eye,
                                       eye + std::max(dot(middle - eye, ahead), 1.) * ahead,
                                       camera.fieldOfView});
  }
  if (model.cameras.empty()) return;
  const NamedCamera& first = file.appearance.cameras.front();
  file.camera = {first.eye, first.target};
}

Import finished(const Model& model, Report report) {
  Import out;
  out.report = std::move(report);
  assemble(model, out.file, out.report);
  out.file.scene.description = "imported from " + std::filesystem::path(out.report.file).filename().string();
  out.file.dt = model.timeStep.value_or(kDt);
  out.file.steps = static_cast<int>(std::clamp(std::ceil(kSeconds / out.file.dt - 1e-9), 1., 1e7));
  out.file.iterations = kIterations;
  addCameras(model, out.file);
  out.file.appearance.daylight.toSun = model.toSun;
  validate(out.file.scene);
  for (std::size_t i = 0; i < out.file.actuators.size(); ++i)
    validate(out.file.actuators[i], "actuators[" + std::to_string(i) + "]");
  return out;
}

}  // namespace

bool isModelFile(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  return ending == ".xml" || ending == ".mjcf" || ending == ".urdf" || ending == ".xacro" ||
         isUsdFile(file) || isGltfFile(file);
}

Import importModel(const std::string& file, const ImportOptions& options) {
  Folders folders;
  for (const std::string& folder : options.folders) folders.allow(folder);
  Report report;
  report.file = file;
  if (isUsdFile(file) || isGltfFile(file)) {
    folders.allow(packageOf(std::filesystem::path(file).parent_path()));
    const Model model = modelOf(bytesOf(file, file), file, isUsdFile(file), folders, report);
    return finished(model, std::move(report));
  }
  Source source(folders);
  const pugi::xml_node root = source.load(file, file);
  folders.allow(packageOf(source.home()));
  const Model model = modelOf(source, root, options, report);
  return finished(model, std::move(report));
}

Import importContent(const std::string& content, const std::string& name, const ImportOptions& options) {
  Folders none;
  Report report;
  report.file = name;
  const bool isUsd = content.starts_with("#usda") || content.starts_with("PXR-USDC") ||
                     usd::isPackage(content);
  Model model;
  if (isUsd || content.starts_with("{") || content.starts_with("glTF")) {
    model = modelOf(content, name, isUsd, none, report);
  } else {
    Source source(none);
    const pugi::xml_node root = source.loadText(content, name);
    model = modelOf(source, root, options, report);
  }
  return finished(model, std::move(report));
}

}  // namespace rubble::convert
