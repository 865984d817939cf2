#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/command.h"
#include "apps/cli/mesh_options.h"
#include "apps/cli/output.h"

#if defined(RUBBLE_HAS_CONVERT)
#include "convert/import.h"
#endif

namespace rubble::cli {
namespace {

struct ImportCommand {
  JobOptions job;
  SceneOutput output;
  convert::MeshOptions mesh;
  std::string jsonFile, key, srdf, as = convert::meshKinds().front();
  std::vector<std::string> packages, folders;
  bool floatingBase = false, strict = false;
};

#if defined(RUBBLE_HAS_CONVERT)
convert::ImportOptions optionsOf(const ImportCommand& command) {
  convert::ImportOptions options;
  for (const std::string& text : command.packages) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) throw Error("--package", "NAME=PATH", text);
    options.packages[text.substr(0, equals)] = text.substr(equals + 1);
  }
  options.folders = command.folders;
  options.key = command.key;
  options.srdf = command.srdf;
  options.floatingBase = command.floatingBase;
  return options;
}

int importRobot(const ImportCommand& command) {
  convert::Import import = convert::importModel(command.job.scene, optionsOf(command));
  const bool refused = command.strict && !import.report.exact();
  const bool toStandardOutput = command.jsonFile == "-" || command.output.sceneFile == "-";
  if (!command.output.quiet || refused)
    fmt::print(toStandardOutput ? stderr : stdout, "{}",
               convert::textOf(import.report, !command.output.quiet));
  if (!command.jsonFile.empty()) writeOutput(command.jsonFile, convert::jsonOf(import.report));
  if (refused) {
    fmt::print(stderr,
               "rubble: {}: not imported, because --strict wants nothing lost and nothing approximate\n",
               command.job.scene);
    return kBadInput;
  }
  if (!command.output.sceneFile.empty()) writeOutput(command.output.sceneFile, io::toJson(import.file));
  JobOptions job = command.job;
  job.file = std::make_shared<const io::SceneFile>(std::move(import.file));
  if (command.output.view) return viewJob(job);
  return command.output.run ? runJob(job) : kHolds;
}
/// glTF files may hold a mesh or a model.
bool isModel(const std::string& file) { return convert::isModelFile(file); }
#else
bool isModel(const std::string&) { return false; }
int importRobot(const ImportCommand&) {
  throw Error("import", "a build with pugixml (Debian: apt-get install libpugixml-dev)", "one without");
}
#endif

int import(ImportCommand& command) {
  if (!convert::isMeshFile(command.job.scene) || isModel(command.job.scene)) return importRobot(command);
  if (!command.jsonFile.empty() || command.strict)
    throw Error("--json, --strict", "a robot model, which has a report of its elements", command.job.scene);
  const std::vector<std::string>& kinds = convert::meshKinds();
  const auto kind = std::find(kinds.begin(), kinds.end(), command.as);
  if (kind == kinds.end()) throw Error("--as", fmt::format("{}", fmt::join(kinds, ", ")), command.as);
  command.mesh.as = static_cast<convert::MeshAs>(kind - kinds.begin());
  return finishMesh(convert::importMesh(command.job.scene, command.mesh), command.job, command.output);
}

}  // namespace

void addImport(CLI::App& app, int& status) {
  auto command = std::make_shared<ImportCommand>();
  CLI::App* sub = app.add_subcommand(
      "import", "Make a scene of a model (MJCF, URDF, USD, glTF) or a mesh, and report what is in it");
  sub->add_option(
         "file", command->job.scene,
         "A model: MJCF (.xml), URDF (.urdf), USD (.usda, .usdc), glTF with physics, or a mesh: .obj, .stl, "
         ".ply, .msh; with assimp also .dae, .gltf")
      ->required();
  addSceneOutput(*sub, command->output);
  sub->add_option("--json", command->jsonFile, "Write the report as JSON; '-' is standard output")
      ->type_name("FILE");
  sub->add_flag("--strict", command->strict, "Refuse a model of which anything would be lost or approximate");
  sub->add_option("--key", command->key, "MJCF: keyframe to start in, by name or index")->type_name("NAME");
  sub->add_option("--package", command->packages, "URDF: folder of a ROS package; may be repeated")
      ->type_name("NAME=PATH")
      ->allow_extra_args(false);
  sub->add_option("--folder", command->folders,
                  "A further folder that files may be read from; may be repeated")
      ->type_name("PATH")
      ->allow_extra_args(false);
  sub->add_option("--srdf", command->srdf, "URDF: an SRDF file with pairs that do not collide")
      ->type_name("FILE");
  sub->add_flag("--floating-base", command->floatingBase, "URDF: the root link moves freely");
  sub->add_option("--as", command->as,
                  fmt::format("Mesh: what it becomes: {}", fmt::join(convert::meshKinds(), ", ")))
      ->capture_default_str();
  addMeshOptions(*sub, command->mesh);
  sub->add_option("--concavity", command->mesh.concavity,
                  "Mesh as parts: volume of the hulls beyond that of the mesh, as a share of it")
      ->capture_default_str();
  sub->add_option("--parts", command->mesh.parts, "Mesh as parts: at most")->capture_default_str();
  sub->add_option("--cells", command->mesh.cells, "Mesh as distance or solid: cells along its longest side")
      ->check(CLI::Range(4, 256))
      ->capture_default_str();
  sub->add_flag("-q,--quiet", command->output.quiet,
                "Report only what is lost or approximate, and only with --strict");
  addSolverOptions(*sub, command->job);
  addBackendOptions(*sub, command->job);
  sub->footer("Exit status: 0 imported, 2 the model is wrong or --strict refuses it.");
  sub->callback([command, &status] { status = import(*command); });
}

}  // namespace rubble::cli
