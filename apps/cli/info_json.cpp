#include "apps/cli/info_json.h"

#include <rubble/info.h>

#include "apps/cli/file_probe.h"
#include "io/json_text.h"
#include "render/film.h"
#include "render/painter.h"
#include "scenes/registry.h"

namespace rubble::cli {

using Json = nlohmann::ordered_json;

std::string scenesJson() {
  Json list = Json::array();
  for (const scenes::Spec& spec : scenes::registry()) {
    Json arguments = Json::array();
    for (const scenes::Argument& a : spec.arguments)
      arguments.push_back({{"name", a.name},
                           {"value", a.value},
                           {"min", a.min},
                           {"max", a.max},
                           {"unit", a.unit},
                           {"doc", a.doc}});
    list.push_back(
        {{"name", spec.name},
         {"doc", spec.doc},
         {"steps", spec.steps},
         {"iterations", spec.iterations},
         {"tags", spec.tags},
         {"test_steps", spec.testSteps},
         {"test_arguments", spec.testArguments.empty() ? Json::object() : Json(spec.testArguments)},
         {"arguments", std::move(arguments)}});
  }
  return io::prettyJson(list);
}

static Json fieldsJson(const std::vector<ForceField>& fields) {
  Json list = Json::array();
  for (const ForceField& f : fields) list.push_back({{"field", f.field}, {"unit", f.unit}, {"doc", f.doc}});
  return list;
}

std::string forcesJson() {
  Json list = Json::array();
  for (const ForceInfo& force : forceInfos())
    list.push_back({{"name", force.name},
                    {"doc", force.doc},
                    {"rows", force.rows},
                    {"axes", force.axes},
                    {"frame_bodies", force.frameBodies},
                    {"fields", fieldsJson(force.fields)}});
  return io::prettyJson(list);
}

std::string deformablesJson() {
  Json list = Json::array();
  for (const DeformableInfo& info : deformableInfos())
    list.push_back({{"name", info.name}, {"doc", info.doc}, {"fields", fieldsJson(info.fields)}});
  return io::prettyJson(list);
}

std::string paramsJson() {
  Json list = Json::array();
  for (const ParamField& field : paramFields()) {
    list.push_back({{"name", field.name},
                    {"unit", field.unit},
                    {"doc", field.doc},
                    {"engine", field.get(Params::of(Preset::Engine))},
                    {"paper", field.get(Params::of(Preset::Paper))},
                    {"demo3d", field.get(Params::of(Preset::Demo3d))}});
  }
  return io::prettyJson(list);
}

std::vector<std::pair<std::string, std::string>> pictureFeatures() {
  const std::string ffmpeg = render::ffmpegProgram();
  return {{"pictures", render::openglStatus()},
          {"text", "Cairo " + render::cairoStatus()},
          {"films", ffmpeg.empty() ? "off: no ffmpeg on PATH" : "on: " + ffmpeg}};
}

std::string buildJson() {
  const BuildInfo build = buildInfo();
  Json drawing = Json::object();
  for (const auto& [name, state] : pictureFeatures()) drawing[name] = state;
  return io::prettyJson({{"version", build.version},
                         {"commit", build.commit},
                         {"compiler", build.compiler},
                         {"precision", build.precision},
                         {"features", build.features},
                         {"drawing", std::move(drawing)},
                         {"backends", backends()},
                         {"instruction_sets", instructionSets()}});
}

std::string metricsJson() {
  const auto named = [](const std::vector<NamedMetric>& metrics) {
    Json list = Json::array();
    for (const NamedMetric& metric : metrics)
      list.push_back({{"quantity", metric.quantity}, {"doc", metric.doc}});
    return list;
  };
  return io::prettyJson(
      {{"body", named(bodyMetrics())}, {"joint", named(jointMetrics())}, {"scene", sceneMetrics(true)}});
}

}  // namespace rubble::cli
