/// The panels of every session: scene, help, picker and timeline.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "apps/viewer/fuzzy.h"
#include "apps/viewer/panel_parts.h"
#include "apps/viewer/recording_session.h"
#include "apps/viewer/ui_state.h"
#include "io/picture_values.h"
#include "scenes/registry.h"

namespace rubble::viewer {
namespace {

void drawButtons(UiState& uiState, Session& session) {
  if (ImGui::Button(session.paused ? "Run" : "Pause")) session.paused = !session.paused;
  ImGui::SameLine();
  if (ImGui::Button("Step")) session.paused = true, session.step();
  ImGui::SameLine();
  if (ImGui::Button("Restart"))
    session.live() ? void(uiState.wanted = session.live()->request()) : session.seek(0);
  ImGui::SameLine();
  if (ImGui::Button("Scenes")) uiState.showPicker = uiState.focusPicker = true;
  if (!session.live()) return;
  ImGui::SameLine();
  if (ImGui::Button("Settings")) uiState.showSettings = !uiState.showSettings;
  ImGui::SameLine();
  if (ImGui::Button("Plots")) uiState.showPlots = !uiState.showPlots;
}

void drawColors(UiState& uiState, const Session& session) {
  ImGui::SetNextItemWidth(scaled(120));
  const io::Quantity& now = io::quantity(uiState.colorBy);
  if (ImGui::BeginCombo("color", now.key)) {
    for (const io::Quantity& q : io::quantities()) {
      const bool known = const_cast<Session&>(session).live() || io::knownWithoutWorld(q.by);
      if (ImGui::Selectable(q.key, q.by == uiState.colorBy, known ? 0 : ImGuiSelectableFlags_Disabled))
        uiState.colorBy = q.by;
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", q.doc);
    }
    ImGui::EndCombo();
  }
  if (now.isKind) return;
  ImGui::SameLine();
  ImGui::Text("up to %.3g %s", uiState.fullValue, std::string(now.unit) == "1" ? "" : now.unit);
}

void drawOverlays(render::Overlays& overlays) {
  ImGui::Checkbox("contacts", &overlays.contacts);
  ImGui::SameLine();
  ImGui::Checkbox("forces", &overlays.forces);
  ImGui::SameLine();
  ImGui::Checkbox("joints", &overlays.joints);
  ImGui::SameLine();
  ImGui::Checkbox("bounds", &overlays.bounds);
}

void drawCounts(Player& player) {
  for (int side = 0; side < player.sides(); ++side) {
    const StepReport& report = player.report(side);
    if (player.sides() > 1)
      ImGui::Text("%s: %s", side == 0 ? "left" : "right", player.label(side).c_str());
    else
      ImGui::Text("%s", player.label(side).c_str());
    ImGui::Text("%zu bodies, %d contact points", player.world(side).bodies().size(),
                report.contacts + report.vertexContacts);
    ImGui::Text("%d colors, %.2f ms per step", report.colors, report.totalMs);
    if (!player.world(side).firstDifference().empty())
      ImGui::TextWrapped("differs: %s", player.world(side).firstDifference().c_str());
  }
}

/// "z, 9.81 m/s2": what is up, and gravity.
std::string upText(const Vec3& gravity) {
  const double size = length(gravity);
  if (size == 0) return "none, no gravity";
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::fabs(gravity[i]) > std::fabs(gravity[axis])) axis = i;
  char text[64];
  if (std::fabs(gravity[axis]) < .999 * size)
    std::snprintf(text, sizeof text, "oblique, g %.3g m/s2", size);
  else
    std::snprintf(text, sizeof text, "%s%c, g %.3g m/s2", gravity[axis] > 0 ? "-" : "", "xyz"[axis], size);
  return text;
}

void drawScenePanel(UiState& uiState, Session& session) {
  ImGui::SetNextWindowPos({kMargin, kMargin}, ImGuiCond_Once);
  ImGui::Begin("Scene", nullptr, kPlain);
  ImGui::Text("%s", session.title().c_str());
  ImGui::Text("%.2f s, step %lld, %s", session.time(), static_cast<long long>(session.now()),
              session.paused ? "paused" : "running");
  if (session.live()) ImGui::Text("up: %s", upText(session.live()->world().gravity()).c_str());
  if (session.live())
    drawCounts(*session.live());
  else if (const auto* film = dynamic_cast<const RecordingSession*>(&session))
    ImGui::Text("frame %d of %d%s", film->frame() + 1, film->frames(),
                film->complete() ? "" : ", the run was cut off");
  drawButtons(uiState, session);
  auto speed = static_cast<float>(session.speed);
  ImGui::SetNextItemWidth(scaled(120));
  if (ImGui::SliderFloat("speed", &speed, .02f, 4, "%.2f", ImGuiSliderFlags_Logarithmic))
    session.speed = static_cast<double>(speed);
  drawColors(uiState, session);
  if (session.live()) drawOverlays(uiState.overlays);
  if (!uiState.message.empty()) {
    ImGui::PushTextWrapPos(scaled(340));
    ImGui::TextColored({.75f, .1f, .05f, 1}, "%s", uiState.message.c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::TextDisabled("? for the keys");
  ImGui::End();
}

void drawHelp(UiState& uiState) {
  if (!uiState.showHelp) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Always, {.5f, .5f});
  ImGui::Begin("Keys", &uiState.showHelp, kPlain);
  ImGui::TextUnformatted(
      "left drag     pull a body or vertex; beside them: turn the camera\n"
      "right drag    turn the camera          middle drag   move it\n"
      "wheel         zoom                     click         select a body, joint (with 3) or vertex\n"
      "Space         pause, go on             N, Right      one step\n"
      "Left          one step back            Home, End     to the start, to the last step\n"
      "R             restart                  - +           slower, faster\n"
      "B             shoot a ball             X             drop a box where the mouse is\n"
      "P             pick a scene             PgUp, PgDn    previous, next scene\n"
      "C, Shift C    next, previous coloring\n"
      "1 2 3 4       contacts, forces, frames of joints, bounds\n"
      "G             plots of times, energy and residuals\n"
      "T             arguments of the scene and parameters\n"
      "J             next joint\n"
      "F             show the selection, or everything\n"
      "Esc           nothing selected         ?             these keys\n"
      "Ctrl Q        close");
  ImGui::End();
}

/// Titles of the groups of the picker, by the first tag of a scene, in their order.
constexpr std::pair<const char*, const char*> kGroups[] = {
    {"stack", "Stacks and piles"},
    {"joint", "Joints and machines"},
    {"rope", "Ropes"},
    {"rod", "Rods"},
    {"soft", "Soft solids"},
    {"cloth", "Cloth"},
    {"grains", "Granular"},
    {"friction", "Friction"},
    {"shape", "Shapes"},
    {"fast", "Fast bodies"},
    {"body", "Special bodies"},
    {"basic", "Basics"},
};
std::size_t pickerGroup(const std::string& scene) {
  const auto& tags = scenes::find(scene).tags;
  const auto* const group = std::ranges::find_if(
      kGroups, [&](const auto& entry) { return !tags.empty() && tags[0] == entry.first; });
  return static_cast<std::size_t>(group - std::begin(kGroups));
}

/// Indices of the scenes that fit the search: without one all of them, by groups.
std::vector<std::size_t> sceneChoices(const std::string& search, const std::vector<std::string>& names) {
  std::vector<std::size_t> found = fuzzySearch(search, names);
  if (!search.empty()) {
    // words of descriptions come after names
    for (std::size_t i = 0; i < names.size(); ++i)
      if (std::ranges::find(found, i) == found.end() &&
          scenes::find(names[i]).doc.find(search) != std::string::npos)
        found.push_back(i);
    return found;
  }
  std::ranges::sort(found, {}, [&](std::size_t i) { return std::pair(pickerGroup(names[i]), names[i]); });
  return found;
}

void drawDescription(UiState& uiState, const std::string& name) {
  const scenes::Spec& spec = scenes::find(name);
  ImGui::BeginChild("##description");
  ImGui::TextUnformatted(name.c_str());
  ImGui::Separator();
  const float width = ImGui::GetContentRegionAvail().x;
  const ImVec2 size{width, width * Thumbnails::kHeight / Thumbnails::kWidth};
  GLuint picture = 0;
  try {
    picture = uiState.thumbnails.of(name, ImGui::GetTime());
  } catch (const Error& error) {
    uiState.message = error.what();
  }
  picture ? ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture)), size)
          : ImGui::Dummy(size);
  ImGui::TextWrapped("%s", spec.doc.c_str());
  ImGui::TextWrapped("%d steps at %d iterations", spec.steps, spec.iterations);
  for (const scenes::Argument& argument : spec.arguments)
    ImGui::TextWrapped("%s = %g: %s [%s]", argument.name.c_str(), argument.value, argument.doc.c_str(),
                       argument.unit.c_str());
  ImGui::EndChild();
}

void drawPicker(UiState& uiState, const std::vector<std::string>& names) {
  if (!uiState.showPicker) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x / 2, size.y * .12f}, ImGuiCond_Always, {.5f, 0});
  ImGui::SetNextWindowSize({std::min(scaled(640), size.x - 2 * kMargin), std::min(scaled(480), size.y * .8f)},
                           ImGuiCond_Always);
  ImGui::Begin("Scenes", &uiState.showPicker, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoResize);
  if (uiState.focusPicker) {
    ImGui::SetKeyboardFocusHere();
    uiState.focusPicker = false;
    uiState.choice = 0;
  }
  ImGui::SetNextItemWidth(-1);
  ImGui::InputTextWithHint("##search", "a name, or a word of a description", &uiState.search,
                           ImGuiInputTextFlags_AutoSelectAll);
  if (ImGui::IsItemEdited()) uiState.choice = 0;
  const std::vector<std::size_t> found = sceneChoices(uiState.search, names);
  const int last = static_cast<int>(found.size()) - 1;
  uiState.choice = std::clamp(uiState.choice, 0, std::max(0, last));
  std::string chosen, described;
  ImGui::BeginChild("##list", {scaled(230), 0});
  std::size_t group = std::size(kGroups) + 1;
  for (int i = 0; i <= last; ++i) {
    const std::string& name = names[found[static_cast<std::size_t>(i)]];
    if (uiState.search.empty() && pickerGroup(name) != group) {
      group = pickerGroup(name);
      ImGui::TextDisabled("%s", group < std::size(kGroups) ? kGroups[group].second : "Others");
    }
    if (ImGui::Selectable(name.c_str(), i == uiState.choice)) chosen = name;
    if (ImGui::IsItemHovered() || (described.empty() && i == uiState.choice)) described = name;
  }
  ImGui::EndChild();
  ImGui::SameLine();
  if (!described.empty()) drawDescription(uiState, described);
  if (uiState.takeChoice && last >= 0) chosen = names[found[static_cast<std::size_t>(uiState.choice)]];
  uiState.takeChoice = false;
  ImGui::End();
  if (chosen.empty()) return;
  uiState.showPicker = false;
  uiState.wanted = Request{chosen, {}, ""};
}

/// Marks under the slider: where snapshots are, and where the branch began.
void drawMarks(const Player& player, const ImVec2& corner, float width) {
  const auto at = [&](std::int64_t step) {
    return corner.x +
           width * static_cast<float>(step) / static_cast<float>(std::max<std::int64_t>(1, player.last()));
  };
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const Branch& branch = player.history().branch();
  for (const auto& [step, worlds] : branch.checkpoints)
    if (step <= player.last())
      draw->AddLine({at(step), corner.y}, {at(step), corner.y + 4}, IM_COL32(90, 110, 140, 255));
  for (const Input& input : branch.inputs)
    draw->AddLine({at(input.step), corner.y}, {at(input.step), corner.y + 7}, IM_COL32(200, 110, 20, 255));
  if (branch.parent >= 0)
    draw->AddLine({at(branch.begins), corner.y}, {at(branch.begins), corner.y + 10},
                  IM_COL32(200, 30, 30, 255), 2);
}

}  // namespace

void drawTimeline(UiState& uiState, Session& session) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x / 2, size.y - kMargin}, ImGuiCond_Always, {.5f, 1});
  ImGui::SetNextWindowSize({std::min(size.x - 2 * kMargin, scaled(900)), 0});
  ImGui::Begin("Timeline", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoFocusOnAppearing);
  auto now = static_cast<int>(session.now());
  const auto last = static_cast<int>(std::max<std::int64_t>(1, session.last()));
  const bool branches = session.live() && session.live()->history().branches().size() > 1;
  const float width = ImGui::GetContentRegionAvail().x - (branches ? scaled(140) : 0.f);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::SetNextItemWidth(width);
  if (ImGui::SliderInt("##step", &now, 0, last, "step %d")) session.paused = true, session.seek(now);
  if (branches) {
    Player& player = *session.live();
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    if (ImGui::BeginCombo("##branch", player.history().branch().name.c_str())) {
      for (std::size_t i = 0; i < player.history().branches().size(); ++i) {
        const Branch& branch = player.history().branches()[i];
        char label[96];
        std::snprintf(label, sizeof label, "%s: from %lld to %lld", branch.name.c_str(),
                      static_cast<long long>(branch.begins), static_cast<long long>(branch.last));
        if (ImGui::Selectable(label, static_cast<int>(i) == player.history().current()))
          player.choose(static_cast<int>(i)), uiState.selection = {};
      }
      ImGui::EndCombo();
    }
  }
  if (session.live()) {
    drawMarks(*session.live(), {corner.x, ImGui::GetCursorScreenPos().y - 3}, width);
    ImGui::Dummy({0, 5});
  }
  ImGui::End();
}

void drawPanels(UiState& uiState, Session& session, const std::vector<std::string>& scenes) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  if (session.sides() == 2)
    ImGui::GetBackgroundDrawList()->AddLine({size.x / 2, 0}, {size.x / 2, size.y},
                                            IM_COL32(250, 250, 250, 255), 3);
  drawScenePanel(uiState, session);
  if (Player* player = session.live()) {
    drawInspector(uiState, *player);
    if (uiState.showPlots) drawPlots(uiState, *player);
    if (uiState.showSettings) drawSettings(uiState, *player);
  }
  drawTimeline(uiState, session);
  drawHelp(uiState);
  drawPicker(uiState, scenes);
}

}  // namespace rubble::viewer
