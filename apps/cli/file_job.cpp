#include "apps/cli/file_job.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <fmt/format.h>

#include "apps/cli/file_probe.h"
#include "apps/cli/job.h"
#include "scenes/probes.h"

#if defined(RUBBLE_HAS_CONVERT)
#include "convert/import.h"
#endif

namespace rubble::cli {
namespace {

scenes::Probes probesFor(const io::SceneFile& file) {
  const bool smashes = file.smashStep >= 0;
  const double moment = smashes ? file.smashStep * file.dt : std::numeric_limits<double>::infinity();
  scenes::Probes probes;
  if (smashes) probes = scenes::smashProbes(file.scene, moment);
  // A scene without joints is a stack. Others have a top level only if their verdict names one.
  const auto isStackMetric = [](const io::FileClaim& claim) {
    return claim.metric.starts_with("top_drop") || claim.metric == "max_drift_m" ||
           claim.metric == "bricks_lost" || claim.metric == "lowest_m";
  };
  if (file.scene.joints.empty() || std::any_of(file.claims.begin(), file.claims.end(), isStackMetric))
    probes.push_back(scenes::stackProbe(file.scene, moment));
  probes.push_back(scenes::qualityProbe(moment));
  probes.push_back(namedProbe(file.claims));
  return probes;
}

}  // namespace

std::vector<io::Fault> checkFile(const std::string& file, io::SceneFile& scene) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (!in) throw Error(file, "a file that can be read", "none");
  if (in.peek() == std::ifstream::traits_type::eof())
    throw Error(file, "a scene", std::filesystem::is_directory(file) ? "a folder" : "an empty file");
  text << in.rdbuf();
  std::vector<io::Fault> faults;
  scene = io::parseScene(text.str(), faults, io::folderOf(file));
  for (std::size_t i = 0; i < scene.claims.size(); ++i) {
    const std::string wrong = metricFault(scene, scene.claims[i].metric);
    if (!wrong.empty() && !scene.claims[i].metric.empty())
      faults.push_back({fmt::format("verdict[{}].metric", i), 0, 0, wrong});
  }
  return faults;
}

std::string messageOf(const Error& error) {
  return error.expected().empty() ? error.what()
                                  : fmt::format("expected {}, got {}", error.expected(), error.found());
}

std::vector<io::Fault> worldFaults(const Scene& scene) {
  std::vector<io::Fault> faults;
  const auto make = [&](const Scene& one, const std::string& path) {
    try {
      WorldOptions options;
      options.threads = 1;
      World world(one, options);
    } catch (const Error& error) {
      // "bodies[2].mass" of bodies that an event adds is "events[0].add[2].mass"
      constexpr std::string_view kBodies = "bodies[";
      std::string where = error.path();
      if (!path.empty() && where.starts_with(kBodies)) where = path + where.substr(kBodies.size() - 1);
      faults.push_back({where.empty() ? path : where, 0, 0, messageOf(error)});
    }
  };
  make(scene, "");
  for (std::size_t i = 0; i < scene.events.size(); ++i) {
    Scene added;
    added.bodies = scene.events[i].add;
    if (!added.bodies.empty()) make(added, fmt::format("events[{}].add", i));
  }
  return faults;
}

#if defined(RUBBLE_HAS_CONVERT)
io::SceneFile importScene(const std::string& file) {
  convert::Import import = convert::importModel(file);
  fmt::print(stderr, "{}", convert::textOf(import.report, false));
  return std::move(import.file);
}
#else
io::SceneFile importScene(const std::string& file) {
  throw Error(file, "a build with pugixml (Debian: apt-get install libpugixml-dev)", "one without");
}
#endif

scenes::Job loadFileJob(const std::string& file) {
  if (isModelFile(file)) return jobOf(importScene(file));
  io::SceneFile scene;
  const std::vector<io::Fault> faults = checkFile(file, scene);
  if (!faults.empty()) throw Error(io::faultText(file, faults));
  return jobOf(std::move(scene));
}

scenes::Job jobOf(io::SceneFile scene) {
  scenes::Job job;
  for (const io::FileClaim& claim : scene.claims)
    job.claims.push_back({claim.metric, claim.min, claim.max, claim.why});
  job.probes = probesFor(scene);
  job.camera = scene.camera ? scenes::Camera{scene.camera->eye, scene.camera->target}
                            : cameraShowing(scene.scene, {}, scene.smashStep >= 0);
  job.appearance = std::move(scene.appearance);
  job.sensors = std::move(scene.sensors);
  job.actuators = std::move(scene.actuators);
  job.steps = scene.steps;
  job.iterations = scene.iterations;
  job.substeps = scene.substeps;
  job.smashStep = scene.smashStep;
  job.dt = scene.dt;
  job.scene = std::move(scene.scene);
  return job;
}

io::SceneFile fileOf(const scenes::Job& job) {
  io::SceneFile file;
  file.scene = job.scene;
  file.smashStep = job.smashStep;
  for (const scenes::Claim& claim : job.claims)
    if (metricFault(file, claim.metric).empty())
      file.claims.push_back({claim.metric, claim.min, claim.max, claim.why});
  file.camera = io::FileCamera{job.camera.eye, job.camera.target};
  file.appearance = job.appearance;
  file.sensors = job.sensors;
  file.actuators = job.actuators;
  file.steps = job.steps;
  file.iterations = job.iterations;
  file.substeps = job.substeps;
  file.dt = job.dt;
  return file;
}

}  // namespace rubble::cli
