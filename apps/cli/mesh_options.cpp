#include "apps/cli/mesh_options.h"

#include <filesystem>

#include <fmt/format.h>

#include "apps/cli/command.h"
#include "apps/cli/output.h"

namespace rubble::cli {

void addMeshOptions(CLI::App& app, convert::MeshOptions& options) {
  app.add_option("--scale", options.scale, "Mesh: meters per unit of the file")->capture_default_str();
  app.add_option("--up", options.up, "Mesh: axis of the file that points up, y or z")->type_name("AXIS");
  app.add_option("--density", options.density, "Mesh: density [kg/m3]")->capture_default_str();
  app.add_flag("!--no-ground", options.ground, "Mesh: no ground plane");
}

void addSceneOutput(CLI::App& app, SceneOutput& output) {
  app.add_option("-o,--output", output.sceneFile, "Write the scene; '-' is standard output")
      ->type_name("FILE");
  app.add_flag("--run", output.run, "Run the scene as 'rubble run' does");
  app.add_flag("--view", output.view, "Open a window on it as 'rubble view' does");
}

int finishMesh(convert::MeshScene scene, JobOptions job, const SceneOutput& output) {
  if (output.json && (output.run || output.view || output.sceneFile == "-"))
    throw Error("--json", "standard output for itself", "--run, --view or '-o -' as well");
  if (!output.quiet && !output.json) {
    const std::string name = std::filesystem::path(job.scene).filename().string();
    for (const std::string& fact : scene.facts)
      fmt::print(output.sceneFile == "-" ? stderr : stdout, "{}: {}\n", name, fact);
  }
  if (!output.sceneFile.empty()) writeOutput(output.sceneFile, io::toJson(scene.file));
  if (output.json)
    printWritten({output.sceneFile}, {{"bodies", scene.file.scene.bodies.size()},
                                      {"joints", scene.file.scene.joints.size()},
                                      {"facts", scene.facts}});
  job.file = std::make_shared<const io::SceneFile>(std::move(scene.file));
  if (output.view) return viewJob(job);
  return output.run ? runJob(job) : kHolds;
}

}  // namespace rubble::cli
