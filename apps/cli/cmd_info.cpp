#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rubble/info.h>

#include "apps/cli/command.h"
#include "apps/cli/file_job.h"
#include "apps/cli/file_probe.h"
#include "apps/cli/info_json.h"
#include "apps/cli/job.h"
#include "apps/cli/output.h"

namespace rubble::cli {
namespace {

struct InfoOptions {
  bool json = false;
  JobOptions scene;
};

std::string unitText(const std::string& unit) { return unit == "1" ? "" : " [" + unit + "]"; }

void printScenes() {
  for (const scenes::Spec& spec : scenes::registry())
    fmt::print("{:<24} {}\n{:<24} {} iterations, {} steps{}{}\n", spec.name, spec.doc, "", spec.iterations,
               spec.steps, spec.tags.empty() ? "" : "; ", fmt::join(spec.tags, ", "));
}

void printFields(const std::vector<ForceField>& fields) {
  for (const ForceField& field : fields)
    fmt::print("  {:<24} {}{}\n", field.field, field.doc, unitText(field.unit));
}

void printForces() {
  for (const ForceInfo& force : forceInfos()) {
    fmt::print("{} ({} rows)\n  {}\n", force.name, force.rows, force.doc);
    printFields(force.fields);
  }
}

void printDeformables() {
  for (const DeformableInfo& info : deformableInfos()) {
    fmt::print("{}\n  {}\n", info.name, info.doc);
    printFields(info.fields);
  }
}

void printParams() {
  constexpr Preset kPresets[] = {Preset::Engine, Preset::Paper, Preset::Demo3d};
  fmt::print("{:<20}{:>12}{:>12}{:>12}   {}\n", "parameter", "engine", "paper", "demo3d", "meaning");
  for (const ParamField& field : paramFields()) {
    fmt::print("{:<20}", field.name);
    for (const Preset preset : kPresets) fmt::print("{:>12.6g}", field.get(Params::of(preset)));
    fmt::print("   {}{}\n", field.doc, unitText(field.unit));
  }
}

void printBuild() {
  const BuildInfo build = buildInfo();
  fmt::print("rubble {}\n", build.version);
  fmt::print("{:<12}{}\n{:<12}{}\n{:<12}{}\n", "commit", build.commit, "compiler", build.compiler,
             "precision", build.precision);
  fmt::print("{:<12}{}\n", "features",
             build.features.empty() ? "none" : fmt::format("{}", fmt::join(build.features, ", ")));
  for (const auto& [name, state] : pictureFeatures()) fmt::print("{:<12}{}\n", name, state);
  fmt::print("{:<12}{}\n", "backends", fmt::join(backends(), ", "));
  const std::vector<std::string> sets = instructionSets();
  fmt::print("{:<12}{} (of {})\n", "steps with", sets.back(), fmt::join(sets, ", "));
}

void printMetrics() {
  fmt::print("Of a body by its name:\n");
  for (const NamedMetric& metric : bodyMetrics())
    fmt::print("  NAME.{:<14} {}\n", metric.quantity, metric.doc);
  fmt::print("Of a joint by its name:\n");
  for (const NamedMetric& metric : jointMetrics())
    fmt::print("  NAME.{:<14} {}\n", metric.quantity, metric.doc);
  fmt::print("Of the scene (docs/scene_format.md says what they mean):\n");
  for (const std::string& metric : sceneMetrics(true)) fmt::print("  {}\n", metric);
}

void printScene(const JobOptions& options) {
  const scenes::Spec& spec = scenes::find(options.scene);
  const scenes::Job job = loadJob(options.scene, options.arguments);
  fmt::print(
      "{}\n  {}\n  {} bodies, {} joints, {} deformable objects, {} events; {} steps at {} iterations\n",
      spec.name, spec.doc, job.scene.bodies.size(), job.scene.joints.size(), job.scene.deformables.size(),
      job.scene.events.size(), job.steps, job.iterations);
  if (!spec.arguments.empty()) fmt::print("arguments\n");
  for (const scenes::Argument& argument : spec.arguments)
    fmt::print("  {:<20}{:>10.6g}   {}{}, {:.6g} to {:.6g}\n", argument.name, argument.value, argument.doc,
               unitText(argument.unit), argument.min, argument.max);
  fmt::print("verdict\n");
  for (const scenes::Claim& claim : job.claims)
    fmt::print("  {:<32}{:>12.6g} to {:<12.6g} {}\n", claim.metric, claim.min, claim.max, claim.why);
}

void showScene(const InfoOptions& options) {
  if (options.json || isSceneFile(options.scene.scene)) {
    writeOutput("-", io::toJson(fileOf(loadJob(options.scene.scene, options.scene.arguments))));
  } else {
    printScene(options.scene);
  }
}

}  // namespace

void addInfo(CLI::App& app, int& status) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* info = app.add_subcommand("info", "List what there is, with units");
  info->require_subcommand(1);
  const auto add = [&](const char* name, const char* doc, auto show) {
    CLI::App* command = info->add_subcommand(name, doc);
    command->add_flag("--json", options->json, "As JSON");
    command->callback([show, &status] {
      show();
      status = kHolds;
    });
    return command;
  };
  const auto list = [options](void (*print)(), std::string (*json)()) {
    return [=] { options->json ? writeOutput("-", json()) : print(); };
  };
  add("scenes", "Scenes of the registry", list(printScenes, scenesJson));
  add("forces", "Forces: rows and what an author sets", list(printForces, forcesJson));
  add("deformables", "Deformable objects and attachments: what an author sets",
      list(printDeformables, deformablesJson));
  add("params", "Parameters of the method, for --param", list(printParams, paramsJson));
  add("build", "Version, compiler, backends", list(printBuild, buildJson));
  add("metrics", "What the verdict of a scene file may name", list(printMetrics, metricsJson));
  CLI::App* scene = add("scene",
                        "One scene: arguments and verdict; with --json the scene itself, as a scene file",
                        [options] { showScene(*options); });
  scene->add_option("name", options->scene.scene, "Name of the scene, or a scene file (.json)")->required();
  addArgumentOptions(*scene, options->scene);
}

}  // namespace rubble::cli
