#pragma once
#include <CLI/CLI.hpp>

#include "apps/cli/job.h"
#include "convert/mesh/mesh_import.h"

namespace rubble::cli {

/// What all subcommands take that read a mesh.
void addMeshOptions(CLI::App& app, convert::MeshOptions& options);

/// What is done with an imported scene.
struct SceneOutput {
  std::string sceneFile;  ///< "" for none
  bool run = false, view = false, quiet = false, json = false;
};
void addSceneOutput(CLI::App& app, SceneOutput& output);

/// Prints what became of a mesh, and writes, runs or shows its scene; the exit status. `job` has the file and
/// the options of a run.
int finishMesh(convert::MeshScene scene, JobOptions job, const SceneOutput& output);

}  // namespace rubble::cli
