#pragma once
/// Parts that panels are made of.
#include <string>
#include <vector>

#include <imgui/imgui.h>

#include <rubble/math.h>

namespace rubble::viewer {

constexpr float kMargin = 12;
/// Pixels of a length that is given for a display of 96 dots per inch.
float scaled(float length);
constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize |
                                    ImGuiWindowFlags_NoFocusOnAppearing;

/// A line of a table of fields; the doc appears under the mouse.
void row(const char* name, const char* unit, const Vec3& v, const char* doc = "");
void row(const char* name, const char* unit, double v, const char* doc = "");
void row(const char* name, const std::string& text, const char* doc = "");

/// A line of a plot.
struct Series {
  std::string name;
  std::vector<double> values;
};
/// Lines over one another from left to right, with a legend and the range of the values. A line has gaps
/// where values are not finite. `logarithmic`: values above 0.
void plot(const char* title, const char* unit, const std::vector<Series>& series, const ImVec2& size,
          bool logarithmic = false);

}  // namespace rubble::viewer
