#include <rubble/c/scene.h>
#include <rubble/info.h>

#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "c_api/handles.h"
#include "io/definition_json.h"
#include "render/painter.h"
#include "scenes/probes.h"

using namespace rubble;
using namespace rubble::c;
using Ordered = nlohmann::ordered_json;

namespace {

scenes::Arguments argumentsOf(const char* text) {
  scenes::Arguments out;
  io::readDefinition(textOr(text, "{}"), "arguments", [&](const io::Node& node) {
    if (!node.value().isObject()) return node.fault("an object with numbers");
    for (const io::JsonValue* const member : node.value().members()) {
      const io::Node value = node.member(*member);
      out[std::string(member->key())] = member->isBoolean() ? value.boolean().value_or(false)
                                                            : value.number().value_or(0);
    }
  });
  return out;
}

scenes::Job jobOf(const char* name, const char* arguments) {
  const scenes::Spec& spec = scenes::find(textOr(name, ""));
  return scenes::prepare(spec, scenes::resolve(spec, argumentsOf(arguments)));
}

std::unique_ptr<rb_run> runOf(scenes::Job job, const char* options) {
  WorldOptions parsed = io::parseOptions(textOr(options, "{}"));
  const Ordered given = Ordered::parse(textOr(options, "{}"));
  if (!given.contains("iterations")) parsed.params.iterations = job.iterations;
  if (!given.contains("substeps")) parsed.params.substeps = job.substeps;
  if (!given.contains("dt")) parsed.params.dt = job.dt;
  auto out = std::make_unique<rb_run>();
  out->runner = std::make_shared<scenes::Runner>(std::move(job), parsed);
  out->world.world = std::shared_ptr<World>(out->runner, &out->runner->world());
  out->world.appearance = out->runner->job().appearance;
  return out;
}

Ordered numberJson(double value) { return std::isfinite(value) ? Ordered(value) : Ordered(nullptr); }

Ordered resultJson(const scenes::RunResult& result) {
  Ordered json{{"holds", result.verdict.holds}, {"metrics", Ordered::object()}, {"claims", Ordered::array()}};
  for (const auto& [name, value] : result.metrics) json["metrics"][name] = numberJson(value);
  for (const scenes::ClaimResult& each : result.verdict.results)
    json["claims"].push_back({{"metric", each.claim.metric},
                              {"min", numberJson(each.claim.min)},
                              {"max", numberJson(each.claim.max)},
                              {"value", numberJson(each.value)},
                              {"holds", each.holds},
                              {"why", each.claim.why}});
  return json;
}

Ordered specJson(const scenes::Spec& spec) {
  Ordered json{{"name", spec.name},
               {"doc", spec.doc},
               {"steps", spec.steps},
               {"iterations", spec.iterations},
               {"substeps", spec.substeps},
               {"tags", spec.tags},
               {"arguments", Ordered::array()}};
  for (const scenes::Argument& each : spec.arguments)
    json["arguments"].push_back({{"name", each.name},
                                 {"value", each.value},
                                 {"min", numberJson(each.min)},
                                 {"max", numberJson(each.max)},
                                 {"unit", each.unit},
                                 {"doc", each.doc},
                                 {"whole", each.whole}});
  return json;
}

Ordered fieldsJson(const std::vector<ForceField>& fields) {
  Ordered json = Ordered::array();
  for (const ForceField& field : fields)
    json.push_back({{"key", field.field}, {"unit", field.unit}, {"doc", field.doc}});
  return json;
}

Ordered infoJson() {
  const BuildInfo build = buildInfo();
  Ordered json{{"version", build.version},       {"commit", build.commit},
               {"compiler", build.compiler},     {"precision", build.precision},
               {"features", build.features},     {"backends", backends()},
               {"cuda", cudaStatus()},           {"opengl", render::openglStatus()},
               {"forces", Ordered::array()},     {"deformables", Ordered::array()},
               {"parameters", Ordered::array()}, {"instruction_sets", instructionSets()}};
  for (const ForceInfo& force : forceInfos())
    json["forces"].push_back({{"name", force.name},
                              {"doc", force.doc},
                              {"rows", force.rows},
                              {"fields", fieldsJson(force.fields)}});
  for (const DeformableInfo& kind : deformableInfos())
    json["deformables"].push_back(
        {{"name", kind.name}, {"doc", kind.doc}, {"fields", fieldsJson(kind.fields)}});
  for (const ParamField& field : paramFields())
    json["parameters"].push_back({{"key", io::parameterKey(field.name)},
                                  {"unit", field.unit},
                                  {"doc", field.doc},
                                  {"value", field.get(Params{})}});
  return json;
}

}  // namespace

extern "C" {

rb_status rb_info(const char** json) {
  return guarded([&] { need(json, "json") = keepText(infoJson().dump()); });
}

rb_status rb_scene_build(const char* name, const char* arguments, rb_scene** scene) {
  return guarded([&] {
    scenes::Job job = jobOf(name, arguments);
    auto out = std::make_unique<rb_scene>("");
    io::SceneFile& file = out->file;
    file.scene = std::move(job.scene);
    if (!(job.camera.eye == job.camera.target)) file.camera = {job.camera.eye, job.camera.target};
    file.steps = job.steps, file.iterations = job.iterations, file.substeps = job.substeps;
    file.smashStep = job.smashStep, file.dt = job.dt;
    out->reader.adopt(file);
    need(scene, "scene") = out.release();
  });
}

rb_status rb_registry(const char** json) {
  return guarded([&] {
    Ordered list = Ordered::array();
    for (const scenes::Spec& spec : scenes::registry()) list.push_back(specJson(spec));
    need(json, "json") = keepText(list.dump());
  });
}

rb_status rb_run_create(const char* name, const char* arguments, const char* options, rb_run** run) {
  return guarded([&] {
    auto made = runOf(jobOf(name, arguments), options);
    made->isJudged = true;
    need(run, "run") = made.release();
  });
}

rb_status rb_run_scene(const rb_scene* scene, const char* options, rb_run** run) {
  return guarded([&] {
    const io::SceneFile& file = need(scene, "scene").file;
    scenes::Job job;
    job.scene = file.scene;
    job.probes.push_back(scenes::qualityProbe(std::numeric_limits<double>::infinity()));
    job.steps = file.steps, job.iterations = file.iterations, job.substeps = file.substeps;
    job.smashStep = file.smashStep, job.dt = file.dt;
    job.appearance = file.appearance, job.sensors = file.sensors;
    job.actuators = file.actuators;
    need(run, "run") = runOf(std::move(job), options).release();
  });
}

void rb_run_destroy(rb_run* run) { delete run; }

rb_world* rb_run_world(rb_run* run) { return run ? &run->world : nullptr; }

int32_t rb_run_steps(const rb_run* run) { return run ? run->runner->job().steps : 0; }

rb_status rb_run_step(rb_run* run, rb_step_report* report) {
  return guarded([&] {
    need(run, "run").world.report = run->runner->step();
    if (report) *report = toC(run->world.report);
  });
}

rb_status rb_run_rewound(rb_run* run) {
  return guarded([&] { need(run, "run"); });
}

rb_status rb_run_finish(rb_run* run, const char** json) {
  return guarded([&] {
    Ordered result = resultJson(need(run, "run").runner->run(0));
    if (!run->isJudged) result["holds"] = nullptr;
    need(json, "json") = keepText(result.dump());
  });
}
}
