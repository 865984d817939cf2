#include "apps/cli/job.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rubble/info.h>

#include "apps/cli/file_job.h"
#include "apps/cli/processes.h"
#include "render/framing.h"

namespace rubble::cli {
namespace {

/// How far rubble lies from a smashed stack, over its height.
constexpr double kRubbleSpread = .4;

Preset presetNamed(const std::string& name) {
  if (name == "engine") return Preset::Engine;
  if (name == "paper") return Preset::Paper;
  if (name == "demo3d") return Preset::Demo3d;
  throw Error("--preset", "engine, paper or demo3d", name);
}

scenes::Arguments parseArguments(const std::vector<std::string>& texts) {
  scenes::Arguments arguments;
  for (const std::string& text : texts) {
    const auto [name, value] = parseAssignment(text, "--arg");
    arguments[name] = value;
  }
  return arguments;
}

const std::map<std::string, RankExchange>& exchangeNames() {
  static const std::map<std::string, RankExchange> names{{"messages", RankExchange::Messages},
                                                         {"stores", RankExchange::Stores},
                                                         {"letters", RankExchange::Letters}};
  return names;
}

bool isNumber(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// Throws Error for a number of iterations beyond int.
int iterationsOf(const std::string& text) {
  int number = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), number).ec != std::errc{})
    throw Error("--compare", fmt::format("at most {} iterations", std::numeric_limits<int>::max()), text);
  return std::max(1, number);
}

/// Steps that take as long as the job does at its own time step.
int stepsOf(const scenes::Job& job, double dt) {
  const double steps = std::round(job.steps * job.dt / dt);
  if (!(steps <= std::numeric_limits<int>::max()))
    throw Error("--dt", fmt::format("a time step for at most {} steps", std::numeric_limits<int>::max()),
                fmt::format("{}, which makes {}", dt, steps));
  return std::max(1, static_cast<int>(steps));
}

Params paramsOf(const JobOptions& options, const scenes::Job& job) {
  Params params = Params::of(presetNamed(options.preset));
  params.iterations = options.iterations.value_or(job.iterations);
  params.substeps = options.substeps.value_or(job.substeps);
  params.dt = options.dt.value_or(job.dt);
  for (const std::string& text : options.parameters) {
    const auto [name, value] = parseAssignment(text, "--param");
    setParam(params, name, value);
  }
  validate(params);
  return params;
}

}  // namespace

namespace {

template <class Number> CLI::Validator numberCheck(std::string expected, std::function<bool(Number)> good) {
  return CLI::Validator(
      [expected = std::move(expected), good = std::move(good)](std::string& text) -> std::string {
        Number number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        const bool read = error == std::errc{} && end == text.data() + text.size();
        return read && good(number) ? "" : fmt::format("expected {}, got {}", expected, text.substr(0, 40));
      },
      "", "");
}

}  // namespace

CLI::Validator aboveZero() {
  return numberCheck<double>("a number above 0", [](double a) { return a > 0 && std::isfinite(a); });
}
CLI::Validator notBelowZero() {
  return numberCheck<double>("a number of at least 0", [](double a) { return a >= 0 && std::isfinite(a); });
}
CLI::Validator wholeNumber(int least) {
  return numberCheck<int>(fmt::format("a whole number from {} to {}", least, std::numeric_limits<int>::max()),
                          [least](int a) { return a >= least; });
}

void checkBackend(const std::string& backend) {
  const std::vector<std::string> known = backends();
  if (std::find(known.begin(), known.end(), backend) == known.end())
    throw Error("--backend", fmt::format("one of {}", fmt::join(known, ", ")),
                backend.find("cuda") == std::string::npos
                    ? backend
                    : fmt::format("{}, which is {}", backend, cudaStatus()));
}

std::string bestBackend() {
  const std::vector<std::string> all = backends();
  return std::find(all.begin(), all.end(), "cuda") == all.end() ? "cpu" : "cuda";
}

scenes::Camera cameraShowing(const Scene& scene, const Vec3& direction, bool smashed) {
  const render::Framing framing{direction, smashed ? kRubbleSpread : 0};
  const render::Camera camera = render::cameraShowing(io::pictureBodies(scene, true), scene.gravity, framing);
  return {camera.eye, camera.target};
}

void addArgumentOptions(CLI::App& app, JobOptions& options) {
  app.add_option("-a,--arg", options.arguments,
                 "Set an argument of the scene (see 'rubble info scene NAME'); may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
}

void addSolverOptions(CLI::App& app, JobOptions& options) {
  app.add_option("-n,--steps", options.steps, "Number of steps (default: as the scene says)")
      ->check(wholeNumber(1));
  app.add_option("-i,--iterations", options.iterations,
                 "Solver iterations per step (default: as the scene says)")
      ->check(wholeNumber(1));
  app.add_option("--substeps", options.substeps,
                 "Full steps that a time step is divided into (default: as the scene says)")
      ->check(wholeNumber(1));
  app.add_option("--dt", options.dt, "Time step [s] (default: 1/60)")->check(aboveZero());
  app.add_option("--preset", options.preset, "Parameter set: engine, paper or demo3d")->capture_default_str();
  app.add_option("--param", options.parameters,
                 "Set a parameter of the method, for study (see 'rubble info params'); may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
}

void addBackendOptions(CLI::App& app, JobOptions& options) {
  options.backend.clear();
  app.add_option(
      "-b,--backend", options.backend,
      "Where the step runs (see 'rubble info build'; default: cuda where there is a GPU, else cpu)");
  app.add_option(
         "-t,--threads", options.threads,
         "Worker threads, of all ranks of this process together; 0 is one a core (of torchrun: its share)")
      ->check(wholeNumber(0))
      ->capture_default_str();
  addRankOptions(app, options);
}

void addRankOptions(CLI::App& app, JobOptions& options) {
  app.add_option(
         "--ranks", options.ranks,
         "Ranks of the backend 'distributed', as threads; 0: the processes that were started together")
      ->check(wholeNumber(0))
      ->capture_default_str();
  app.add_option(
         "--gpus", options.gpus,
         "GPUs that step the world together, in place of a backend; of several processes each has one")
      ->check(wholeNumber(1));
  app.add_option_function<std::string>(
         "--exchange", [&options](const std::string& name) { options.exchange = exchangeNames().at(name); },
         "What ranks exchange: messages, stores into one another's memory, or letters that say what to "
         "store (default: stores; between processes messages, between their GPUs letters)")
      ->check(CLI::IsMember(exchangeNames()))
      ->type_name("NAME");
}

std::vector<JobOptions> comparedJobs(const JobOptions& options, const std::vector<std::string>& compare) {
  if (compare.empty()) return {options};
  if (compare.size() != 2)
    throw Error("--compare", "two backends or two numbers of iterations, with a comma between them",
                fmt::format("{}", compare.size()));
  std::vector<JobOptions> jobs(2, options);
  for (std::size_t i = 0; i < 2; ++i) {
    if (isNumber(compare[i]))
      jobs[i].iterations = iterationsOf(compare[i]);
    else
      jobs[i].backend = compare[i];
  }
  return jobs;
}

std::pair<std::string, double> parseAssignment(const std::string& text, const std::string& option) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw Error(option, "NAME=VALUE", text);
  const std::string name = text.substr(0, equals);
  const std::string value = text.substr(equals + 1);
  if (value == "true" || value == "false") return {name, value == "true" ? 1.0 : 0.0};
  double number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc{} || end != value.data() + value.size() || !std::isfinite(number))
    throw Error(option + " " + name, "a number", value.empty() ? "nothing" : value);
  return {name, number};
}

bool isModelFile(const std::string& scene) {
  const std::string ending = std::filesystem::path(scene).extension().string();
  const auto endings = {".xml", ".mjcf", ".urdf", ".xacro", ".usd", ".usda", ".usdc", ".gltf", ".glb"};
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

bool isSceneFile(const std::string& scene) {
  return std::filesystem::path(scene).extension() == ".json" || isModelFile(scene);
}

scenes::Job loadJob(const std::string& scene, const std::vector<std::string>& arguments) {
  if (isSceneFile(scene)) {
    if (!arguments.empty()) throw Error("--arg", "no arguments for a scene file", arguments.front());
    return loadFileJob(scene);
  }
  if (const std::string ending = std::filesystem::path(scene).extension().string();
      !ending.empty() || scene.find('/') != std::string::npos)
    throw Error("scene",
                "the name of a scene ('rubble info scenes'), or a file that ends in .json, .xml, .mjcf, "
                ".urdf or .xacro",
                "\"" + scene + "\"");
  const scenes::Spec& spec = scenes::find(scene);
  scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, parseArguments(arguments)));
  if (!spec.travels)
    job.camera = cameraShowing(job.scene, job.camera.target - job.camera.eye, job.smashStep >= 0);
  return job;
}

PreparedJob prepareJob(const JobOptions& options) {
  const std::string backend = options.gpus > 0          ? "distributed"
                              : options.backend.empty() ? bestBackend()
                                                        : options.backend;
  checkBackend(backend);
  PreparedJob prepared;
  prepared.title = options.arguments.empty()
                       ? options.scene
                       : fmt::format("{} {}", options.scene, fmt::join(options.arguments, " "));
  prepared.job = options.file ? jobOf(*options.file) : loadJob(options.scene, options.arguments);
  prepared.world.backend = backend;
  prepared.world.threads = options.threads > 0 ? options.threads : Processes::threads();
  prepared.world.ranks.count = options.ranks;
  prepared.world.ranks.exchange = options.exchange.value_or(options.ranks > 0 ? RankExchange::Stores
                                                                              : RankExchange::Messages);
  const int first = std::max(0, Processes::localRank());
  for (int device = 0; device < options.gpus; ++device)
    prepared.world.ranks.devices.push_back(first + device);
  prepared.world.params = paramsOf(options, prepared.job);
  prepared.steps = options.steps ? *options.steps : stepsOf(prepared.job, prepared.world.params.dt);
  return prepared;
}

PreparedJob withoutProbes(PreparedJob prepared) {
  prepared.job.probes.clear();
  return prepared;
}

}  // namespace rubble::cli
