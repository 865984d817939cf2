#pragma once
/// From command-line arguments to a job that is ready to run. All subcommands that run a scene share these
/// options.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <rubble/ranks.h>

#include "io/scene_json.h"
#include "scenes/registry.h"

namespace rubble::cli {

struct JobOptions {
  std::string scene;  ///< name in the registry, or path of a scene file
  /// The scene, in place of the one that `scene` names.
  std::shared_ptr<const io::SceneFile> file = nullptr;
  std::vector<std::string> arguments;   ///< "name=value"
  std::vector<std::string> parameters;  ///< "name=value", of rubble::paramFields()
  std::optional<int> steps, iterations, substeps;
  std::optional<double> dt;     ///< [s]
  std::string backend = "cpu";  ///< "": bestBackend()
  std::string preset = "engine";
  int threads = 0, ranks = 0, gpus = 0;
  /// Nothing: stores between ranks that are threads, and else as RankOptions says.
  std::optional<RankExchange> exchange;
};

/// Adds the options to a subcommand. `scene` is left to the caller, which knows whether it takes one or
/// several.
void addArgumentOptions(CLI::App& app, JobOptions& options);
void addSolverOptions(CLI::App& app, JobOptions& options);
void addBackendOptions(CLI::App& app, JobOptions& options);
/// --ranks and --gpus, for commands that name their backend in another way.
void addRankOptions(CLI::App& app, JobOptions& options);

/// Throws Error if this machine or build has no such backend.
void checkBackend(const std::string& backend);
/// cuda where there is a device, else cpu.
std::string bestBackend();

/// A job with everything that its run needs.
struct PreparedJob {
  std::string title;  ///< scene with the arguments that were given
  scenes::Job job;
  WorldOptions world;
  int steps = 0;
};

/// Throws Error for arguments that are invalid or name nothing.
PreparedJob prepareJob(const JobOptions& options);

/// The same without its probes, which visit every body in every step: for drawing without a verdict.
PreparedJob withoutProbes(PreparedJob prepared);

/// One job, or two that differ in what `compare` names: two backends or two numbers of iterations. Throws
/// Error for anything else.
std::vector<JobOptions> comparedJobs(const JobOptions& options, const std::vector<std::string>& compare);

/// The scene of a registry name or file, with its camera and claims.
scenes::Job loadJob(const std::string& scene, const std::vector<std::string>& arguments);

/// A camera that shows everything that the scene holds or will hold, along `direction` (zero: a usual one),
/// with room for rubble if it is smashed.
scenes::Camera cameraShowing(const Scene& scene, const Vec3& direction, bool smashed);

/// Does this name a model that has to be imported (MJCF, URDF, USD, or glTF with physics)?
bool isModelFile(const std::string& scene);

/// Does this name a file rather than a scene of the registry?
bool isSceneFile(const std::string& scene);

/// Checks of numbers for options, whose messages say what was expected.
CLI::Validator aboveZero();
CLI::Validator notBelowZero();
CLI::Validator wholeNumber(int least);

/// Splits "name=value"; `option` is named in the Error.
std::pair<std::string, double> parseAssignment(const std::string& text, const std::string& option);

}  // namespace rubble::cli
