/// The panels of numbers: live plots, and what can be set.
#include <algorithm>
#include <cmath>

#include <imgui/imgui.h>

#include "apps/viewer/panel_parts.h"
#include "apps/viewer/ui_state.h"

namespace rubble::viewer {
namespace {

ImVec2 plotSize() { return {scaled(330), scaled(70)}; }
/// Stages shorter than this share of the step are added up as "rest".
constexpr double kSmallStage = .05;
/// The residuals of a step that runs are measured every so many steps, and in scenes of so many bodies only
/// when they stand still.
constexpr std::int64_t kMeasureEvery = 15;
constexpr std::size_t kManyBodies = 3000;

std::vector<Series> stageSeries(const std::vector<StepRecord>& records) {
  std::vector<Series> series{{"step", {}}};
  if (records.empty()) return series;
  for (const StageTime& stage : records.back().stages)
    if (stage.ms > kSmallStage * records.back().totalMs) series.push_back({stage.name, {}});
  for (const StepRecord& p : records) {
    series[0].values.push_back(p.totalMs);
    for (std::size_t s = 1; s < series.size(); ++s) {
      double ms = 0;
      for (const StageTime& stage : p.stages)
        if (stage.name == series[s].name) ms += stage.ms;
      series[s].values.push_back(ms);
    }
  }
  return series;
}

void measureIterations(UiState& uiState, Player& player) {
  const bool due = player.paused ? uiState.iterationsOf != player.now()
                                 : uiState.iterationsOf < 0 ||
                                       std::abs(player.now() - uiState.iterationsOf) >= kMeasureEvery;
  if (!uiState.measureIterations || !due || (!player.paused && player.world().bodies().size() > kManyBodies))
    return;
  uiState.iterations = iterationErrors(player.world());
  uiState.iterationsOf = player.now();
}

void numberOf(Player& player, const ParamField& field) {
  double value = field.get(player.world().params());
  ImGui::SetNextItemWidth(scaled(110));
  bool changed = false;
  if (std::string(field.unit) == "bool") {
    bool on = value != 0;
    changed = ImGui::Checkbox(field.name, &on);
    value = on ? 1 : 0;
  } else {
    changed = ImGui::InputDouble(field.name, &value, 0, 0, "%.6g", ImGuiInputTextFlags_EnterReturnsTrue);
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s [%s]", field.doc, field.unit);
  if (!changed) return;
  const std::string name = field.name;
  player.changeParams(name, [name, value](Params& params) { setParam(params, name, value); });
}

void drawArguments(UiState& uiState, Player& player) {
  for (const scenes::Argument& argument : player.arguments()) {
    double value = argument.value;
    ImGui::SetNextItemWidth(scaled(110));
    const bool changed = ImGui::InputDouble(argument.name.c_str(), &value, 0, 0, "%.6g",
                                            ImGuiInputTextFlags_EnterReturnsTrue);
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s [%s], %g to %g", argument.doc.c_str(), argument.unit.c_str(), argument.min,
                        argument.max);
    if (!changed) continue;
    uiState.wanted = player.request();
    uiState.wanted->arguments[argument.name] = value;
  }
}

void drawGravity(Player& player) {
  const Vec3 gravity = player.world().gravity();
  double g[3] = {gravity.x, gravity.y, gravity.z};
  ImGui::SetNextItemWidth(scaled(220));
  if (!ImGui::InputScalarN("gravity [m/s2]", ImGuiDataType_Double, g, 3, nullptr, nullptr, "%.4g",
                           ImGuiInputTextFlags_EnterReturnsTrue))
    return;
  const Vec3 wanted{g[0], g[1], g[2]};
  player.apply(
      "gravity", [wanted](World& world) { world.setGravity(wanted); }, true);
}

}  // namespace

void drawPlots(UiState& uiState, Player& player) {
  player.measureEnergy = true;
  const std::vector<StepRecord>& records = player.records();
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  // beside the inspector, between the panel of the scene and the timeline
  ImGui::SetNextWindowPos({kMargin, size.y - scaled(60)}, ImGuiCond_Once, {0, 1});
  ImGui::Begin("Plots", &uiState.showPlots, kPlain);
  plot("stages", "ms", stageSeries(records), plotSize());
  std::vector<Series> energy{{"kinetic", {}}, {"potential from here", {}}, {"sum", {}}};
  Series error{"largest error", {}};
  const auto measured = std::ranges::find_if(records,
                                             [](const StepRecord& p) { return std::isfinite(p.potential); });
  for (const StepRecord& p : records) {
    const double potential = measured == records.end() ? p.potential : p.potential - measured->potential;
    energy[0].values.push_back(p.kinetic);
    energy[1].values.push_back(potential);
    energy[2].values.push_back(p.kinetic + potential);
    error.values.push_back(p.error);
  }
  plot("energy", "J", energy, plotSize());
  plot("penetration and gaps", "m", {error}, plotSize());
  ImGui::Checkbox("residuals of the next step by iteration", &uiState.measureIterations);
  measureIterations(uiState, player);
  if (uiState.measureIterations && !uiState.iterations.empty()) {
    Series errors{"error", {}}, changes{"motion by the last iteration", {}};
    for (std::size_t i = 0; i < uiState.iterations.size(); ++i) {
      errors.values.push_back(uiState.iterations[i].error);
      changes.values.push_back(i == 0 ? std::nan("") : uiState.iterations[i].change);
    }
    plot("residual", "m", {errors, changes}, plotSize(), true);
  }
  ImGui::End();
}

void drawSettings(UiState& uiState, Player& player) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x / 2, kMargin}, ImGuiCond_Once, {.5f, 0});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {size.x, size.y - 90});
  ImGui::Begin("Settings", &uiState.showSettings, kPlain);
  ImGui::SetNextItemWidth(scaled(110));
  if (ImGui::BeginCombo("backend", player.backend().c_str())) {
    for (const std::string& backend : backends()) {
      if (!ImGui::Selectable(backend.c_str(), backend == player.backend())) continue;
      uiState.wanted = player.request();
      uiState.wanted->backend = backend;
    }
    ImGui::EndCombo();
  }
  int iterations = player.world().params().iterations;
  ImGui::SetNextItemWidth(scaled(110));
  if (ImGui::SliderInt("iterations", &iterations, 1, 50))
    player.changeParams("iterations",
                        [iterations](Params& params) { params.iterations = std::max(1, iterations); });
  drawGravity(player);
  if (!player.arguments().empty() &&
      ImGui::CollapsingHeader("Arguments of the scene (restart)", ImGuiTreeNodeFlags_DefaultOpen))
    drawArguments(uiState, player);
  if (ImGui::CollapsingHeader("Parameters"))
    for (const ParamField& field : paramFields()) {
      const std::string name = field.name;
      // Steps are what the timeline counts; the length of one is not changed on the way.
      if (name != "dt" && name != "iterations") numberOf(player, field);
    }
  ImGui::End();
}

}  // namespace rubble::viewer
