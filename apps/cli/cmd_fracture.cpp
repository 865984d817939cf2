#include "apps/cli/command.h"
#include "apps/cli/job.h"
#include "apps/cli/mesh_options.h"
#include "apps/cli/output.h"

namespace rubble::cli {
namespace {

struct FractureCommand {
  JobOptions job;
  convert::MeshOptions mesh;
  convert::FractureOptions fracture;
  SceneOutput output;
};

}  // namespace

void addFracture(CLI::App& app, int& status) {
  auto command = std::make_shared<FractureCommand>();
  CLI::App* sub = app.add_subcommand("fracture",
                                     "Break a closed mesh into convex pieces with joints that break");
  sub->add_option("file", command->job.scene,
                  "A mesh: .obj, .stl, .ply, .msh; with assimp also .dae, .gltf and more")
      ->required();
  sub->add_option("--pieces", command->fracture.pieces, "Number of pieces; concave ones are cut further")
      ->check(wholeNumber(1))
      ->capture_default_str();
  sub->add_option("--seed", command->fracture.seed, "Another one gives other pieces")->capture_default_str();
  sub->add_option("--strength", command->fracture.strength, "Tensile strength of the joints [Pa]")
      ->capture_default_str();
  sub->add_option("--strike", command->fracture.strike, "A ball of this speed hits it after one second [m/s]")
      ->check(aboveZero());
  addMeshOptions(*sub, command->mesh);
  addSceneOutput(*sub, command->output);
  sub->add_flag("-q,--quiet", command->output.quiet, "No report");
  addWrittenOption(*sub, command->output.json);
  addSolverOptions(*sub, command->job);
  addBackendOptions(*sub, command->job);
  sub->callback([command, &status] {
    status = finishMesh(convert::importFracture(command->job.scene, command->mesh, command->fracture),
                        command->job, command->output);
  });
}

}  // namespace rubble::cli
