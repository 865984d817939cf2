#include "apps/viewer/panels.h"

#include <algorithm>
#include <cfloat>
#include <cstdio>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "apps/viewer/fuzzy.h"

namespace rubble::viewer {
namespace {

constexpr float kMargin = 12;
constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing;

void row(const char* name, const char* unit, const Vec3& v) { ImGui::Text("%-18s %11.4g %11.4g %11.4g  %s", name, v.x, v.y, v.z, unit); }
void row(const char* name, const char* unit, double v) { ImGui::Text("%-18s %11.4g  %s", name, v, unit); }

void drawScenePanel(Desk& desk, Player& player) {
  ImGui::SetNextWindowPos({kMargin, kMargin}, ImGuiCond_Once);
  ImGui::Begin("Scene", nullptr, kPlain);
  ImGui::Text("%s", player.title().c_str());
  const StepReport& report = player.report();
  ImGui::Text("%.2f s, step %lld, %s", player.world().time(), static_cast<long long>(player.world().stepCount()),
              player.paused ? "paused" : "running");
  ImGui::Text("%zu bodies, %d contact points, %d colours", player.world().bodies().size(), report.contacts, report.colors);
  if (ImGui::Button(player.paused ? "Run" : "Pause")) player.paused = !player.paused;
  ImGui::SameLine();
  if (ImGui::Button("Step")) player.paused = true, player.step();
  ImGui::SameLine();
  if (ImGui::Button("Restart")) player.restart(), desk.selected.reset();
  ImGui::SameLine();
  if (ImGui::Button("Scenes ...")) desk.showPicker = desk.focusPicker = true;
  auto speed = static_cast<float>(player.speed);
  ImGui::SetNextItemWidth(160);
  if (ImGui::SliderFloat("speed", &speed, .02f, 2, "%.2f", ImGuiSliderFlags_Logarithmic)) player.speed = speed;
  int colors = desk.colorBy == io::ColorBy::Speed;
  ImGui::SetNextItemWidth(160);
  if (ImGui::Combo("colour by", &colors, "body\0speed\0")) desk.colorBy = colors == 1 ? io::ColorBy::Speed : io::ColorBy::Body;
  if (ImGui::CollapsingHeader("Times", ImGuiTreeNodeFlags_DefaultOpen)) {
    const std::vector<float>& times = player.stepTimes();
    char now[32];
    std::snprintf(now, sizeof now, "%.2f ms a step", report.totalMs);
    ImGui::PlotLines("##step", times.data(), static_cast<int>(times.size()), 0, now, 0, FLT_MAX, {280, 60});
    for (const StageTime& stage : report.stages)
      if (stage.ms > .02 * report.totalMs) ImGui::Text("%-14s %8.3f ms", stage.name.c_str(), stage.ms);
  }
  if (!desk.message.empty()) ImGui::TextWrapped("%s", desk.message.c_str());
  ImGui::TextDisabled("? for the keys");
  ImGui::End();
}

void drawInspector(Desk& desk, Player& player) {
  if (!desk.selected || !player.world().alive(*desk.selected)) return;
  World& world = player.world();
  const BodyId id = *desk.selected;
  const BodyDef& body = world.definition(id);
  const BodyState state = world.state(id);
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - kMargin, kMargin}, ImGuiCond_Once, {1, 0});
  ImGui::Begin("Body", nullptr, kPlain);
  ImGui::Text("%s (index %d)", body.name.empty() ? "unnamed" : body.name.c_str(), static_cast<int>(id.index));
  row("mass", "kg", world.massOf(id).mass);
  row("inertia", "kg m2", world.massOf(id).inertia);
  row("static friction", "", body.material.staticFriction);
  row("dynamic friction", "", body.material.dynamicFriction);
  row("restitution", "", body.material.restitution);
  row("position", "m", state.position);
  row("velocity", "m/s", state.velocity);
  row("angular velocity", "rad/s", state.angularVelocity);
  Vec3 force;
  int points = 0;
  double deepest = 0;
  for (const ContactPoint& contact : world.contacts()) {
    if (contact.a != id && contact.b != id) continue;
    force += contact.b == id ? contact.force : -contact.force;
    deepest = std::max(deepest, contact.depth);
    ++points;
  }
  ImGui::Separator();
  ImGui::Text("%d contact points", points);
  row("contact force", "N", force);
  row("deepest", "m", deepest);
  ImGui::End();
}

void drawHelp(Desk& desk) {
  if (!desk.showHelp) return;
  ImGui::SetNextWindowPos({kMargin, ImGui::GetIO().DisplaySize.y - kMargin}, ImGuiCond_Always, {0, 1});
  ImGui::Begin("Keys", &desk.showHelp, kPlain);
  ImGui::TextUnformatted(
      "left drag     pull a body; beside bodies: turn the camera\n"
      "right drag    turn the camera      middle drag   move it\n"
      "wheel         zoom                 click         select a body\n"
      "Space         pause, go on         N             one step\n"
      "R             restart              B             shoot a ball at the mouse\n"
      "P             pick a scene         PgUp, PgDn    previous, next scene\n"
      "- +           slower, faster       C             colour by body, speed\n"
      "F             show everything      Esc           nothing selected\n"
      "?             these keys           Ctrl Q        close");
  ImGui::End();
}

std::string drawPicker(Desk& desk, const std::vector<std::string>& scenes) {
  if (!desk.showPicker) return "";
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x / 2, size.y * .2f}, ImGuiCond_Always, {.5f, 0});
  ImGui::SetNextWindowSize({420, 380}, ImGuiCond_Always);
  ImGui::Begin("Scenes", &desk.showPicker, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoResize);
  if (desk.focusPicker) {
    ImGui::SetKeyboardFocusHere();
    desk.focusPicker = false;
    desk.choice = 0;
  }
  ImGui::SetNextItemWidth(-1);
  ImGui::InputText("##search", &desk.search, ImGuiInputTextFlags_AutoSelectAll);
  if (ImGui::IsItemEdited()) desk.choice = 0;
  const std::vector<std::size_t> found = fuzzySearch(desk.search, scenes);
  const int last = static_cast<int>(found.size()) - 1;
  desk.choice = std::clamp(desk.choice, 0, std::max(0, last));
  std::string chosen;
  ImGui::BeginChild("##list");
  for (int i = 0; i <= last; ++i)
    if (ImGui::Selectable(scenes[found[static_cast<std::size_t>(i)]].c_str(), i == desk.choice))
      chosen = scenes[found[static_cast<std::size_t>(i)]];
  ImGui::EndChild();
  if (desk.takeChoice && last >= 0) chosen = scenes[found[static_cast<std::size_t>(desk.choice)]];
  desk.takeChoice = false;
  ImGui::End();
  if (!chosen.empty()) desk.showPicker = false;
  return chosen;
}

}  // namespace

std::string drawPanels(Desk& desk, Player& player, const std::vector<std::string>& scenes) {
  drawScenePanel(desk, player);
  drawInspector(desk, player);
  drawHelp(desk);
  return drawPicker(desk, scenes);
}

}  // namespace rubble::viewer
