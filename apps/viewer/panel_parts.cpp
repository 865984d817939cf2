#include "apps/viewer/panel_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/palette.h"

namespace rubble::viewer {
namespace {

void explain(const char* doc) {
  if (*doc && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", doc);
}

ImU32 colorOf(std::size_t series) {
  const std::uint32_t rgb = render::kKindColors[series % render::kKindColors.size()];
  return IM_COL32(rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255, 255);
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};
Range rangeOf(const std::vector<Series>& series, bool logarithmic) {
  Range range;
  for (const Series& s : series)
    for (const double v : s.values)
      if (std::isfinite(v) && (!logarithmic || v > 0))
        range.low = std::min(range.low, v), range.high = std::max(range.high, v);
  if (!(range.low <= range.high)) return {0, 1};
  if (!logarithmic) range.low = std::min(0., range.low);
  if (range.low == range.high) range.high = range.low + (range.low == 0 ? 1 : std::fabs(range.low));
  return range;
}

}  // namespace

float scaled(float length) { return length * ImGui::GetIO().FontGlobalScale; }

void row(const char* name, const char* unit, const Vec3& v, const char* doc) {
  ImGui::Text("%-20s %9.3g %9.3g %9.3g %s", name, v.x, v.y, v.z, unit);
  explain(doc);
}
void row(const char* name, const char* unit, double v, const char* doc) {
  ImGui::Text("%-20s %11.5g %s", name, v, std::string(unit) == "1" ? "" : unit);
  explain(doc);
}
void row(const char* name, const std::string& text, const char* doc) {
  ImGui::Text("%-20s %s", name, text.c_str());
  explain(doc);
}

void plot(const char* title, const char* unit, const std::vector<Series>& series, const ImVec2& size,
          bool logarithmic) {
  const Range range = rangeOf(series, logarithmic);
  ImGui::Text("%s [%s]   %.3g to %.3g%s", title, unit, range.low, range.high,
              logarithmic ? ", logarithmic" : "");
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(corner, {corner.x + size.x, corner.y + size.y}, IM_COL32(255, 255, 255, 160), 3);
  const auto height = [&](double v) {
    const auto scale = [&](double a) { return logarithmic ? std::log(std::max(a, range.low)) : a; };
    const double at = (scale(v) - scale(range.low)) / (scale(range.high) - scale(range.low));
    return corner.y + size.y * (1 - static_cast<float>(std::clamp(at, 0., 1.)));
  };
  for (std::size_t s = 0; s < series.size(); ++s) {
    const std::vector<double>& values = series[s].values;
    std::vector<ImVec2> points;
    const auto finish = [&] {
      draw->AddPolyline(points.data(), static_cast<int>(points.size()), colorOf(s), 0, 1.5f);
      if (points.size() < 20)
        for (const ImVec2& p : points) draw->AddCircleFilled(p, 2.5f, colorOf(s));
      points.clear();
    };
    for (std::size_t i = 0; i < values.size(); ++i) {
      // a gap where nothing is measured
      if (!std::isfinite(values[i])) {
        finish();
        continue;
      }
      const float across = values.size() > 1 ? static_cast<float>(i) / static_cast<float>(values.size() - 1)
                                             : .5f;
      points.push_back({corner.x + size.x * across, height(values[i])});
    }
    finish();
  }
  ImGui::Dummy(size);
  for (std::size_t s = 0; s < series.size(); ++s) {
    ImGui::PushStyleColor(ImGuiCol_Text, colorOf(s));
    const double now = series[s].values.empty() ? std::nan("") : series[s].values.back();
    if (std::isfinite(now))
      ImGui::Text("%s %.3g", series[s].name.c_str(), now);
    else
      ImGui::Text("%s -", series[s].name.c_str());
    ImGui::PopStyleColor();
    if (s % 3 != 2 && s + 1 < series.size()) ImGui::SameLine(0, 14);
  }
}

}  // namespace rubble::viewer
