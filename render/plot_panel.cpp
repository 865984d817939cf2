#include "render/plot_panel.h"

#include <algorithm>
#include <cmath>

namespace rubble::render {
namespace {

constexpr double kLeft = 190, kRight = 36, kTitle = 40, kLegendLine = 20, kRowHeight = 30, kAxis = 46,
                 kLinesHeight = 230, kGap = 18;
constexpr Ink kText{0x2b2723}, kSoft{0x6f6860}, kRule{0xe4dfd8}, kFrame{0x9a938a};
/// Muted colors. Neighboring ones are distinguishable in gray and by the color-blind.
constexpr std::uint32_t kColors[] = {0x8f4a2f, 0xd08a4c, 0xe6c48a, 0x4f7f86, 0x2c4a5e,
                                     0x9fb8a8, 0x7a5a78, 0xc7a6a0, 0x5d7f4a, 0xb7b27a,
                                     0x6c6f76, 0xa9adb3, 0x3f3a52, 0xcf6f5f, 0x8cc0c8};
constexpr std::size_t kColorCount = std::size(kColors);

Ink colorOf(std::size_t index) { return {kColors[index % kColorCount]}; }
double inside(const Axis& axis, double value) {
  return kLeft + axis.at(value) * (kPlotWidth - kLeft - kRight);
}

void drawAxisX(Canvas& canvas, const Axis& axis, double top, double bottom, const std::string& unit) {
  for (const double tick : axis.ticks) {
    canvas.line({{inside(axis, tick), top}, {inside(axis, tick), bottom}}, 1, kRule);
    canvas.text({inside(axis, tick), bottom + 17}, tickText(tick), {11.5, kSoft, false, Align::Middle, 0});
  }
  canvas.text({(kLeft + kPlotWidth - kRight) / 2, bottom + 35}, unit, {12, kSoft, false, Align::Middle, 0});
}

double total(const PlotRow& row) {
  double sum = 0;
  for (const PlotValue& value : row.values) sum += value.value;
  return sum;
}

}  // namespace

std::vector<std::string> Figure::Panel::parts() const {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const PlotRow& row : rows) {
    if (form == PanelForm::Lines) add(row.name);
    for (const PlotValue& value : row.values) add(value.part);
  }
  return names;
}

double Figure::Panel::height() const {
  // Legends are measured as letters are wide on the whole; a line of a legend holds about this many parts.
  constexpr std::size_t kPartsInLine = 6;
  const double legend = kLegendLine * std::ceil(static_cast<double>(parts().size()) / kPartsInLine);
  const double body = form == PanelForm::Lines ? kLinesHeight : kRowHeight * static_cast<double>(rows.size());
  return kTitle + legend + body + kAxis + kGap;
}

double Figure::Panel::drawLegend(Canvas& canvas, double top) const {
  constexpr std::size_t kPartsInLine = 6;
  const double width = (kPlotWidth - kLeft - kRight) / kPartsInLine;
  const std::vector<std::string> names = parts();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Point at{kLeft + width * static_cast<double>(i % kPartsInLine),
                   top + kLegendLine * static_cast<double>(i / kPartsInLine)};
    canvas.rectangle({at.x, at.y + 3}, 11, 11, colorOf(i), 2);
    canvas.text({at.x + 17, at.y + 13}, names[i], {11.5, kText, false, Align::Start, 0});
  }
  return top + kLegendLine * std::ceil(static_cast<double>(names.size()) / kPartsInLine);
}

void Figure::Panel::draw(Canvas& canvas, double top) const {
  canvas.text({24, top + 24}, title, {15, kText, true, Align::Start, 0});
  const double body = drawLegend(canvas, top + kTitle);
  if (form == PanelForm::StackedBars) drawBars(canvas, body);
  if (form == PanelForm::Dots) drawDots(canvas, body);
  if (form == PanelForm::Lines) drawLines(canvas, body);
}

void Figure::Panel::drawBars(Canvas& canvas, double top) const {
  double most = 0;
  for (const PlotRow& row : rows) most = std::max(most, total(row));
  const Axis axis = linearAxis(0, most);
  const double bottom = top + kRowHeight * static_cast<double>(rows.size());
  drawAxisX(canvas, axis, top, bottom, unitX);
  const std::vector<std::string> names = parts();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = top + kRowHeight * static_cast<double>(i);
    canvas.text({kLeft - 12, y + 20}, rows[i].name, {12, kText, false, Align::End, 0});
    double from = 0;
    for (const PlotValue& value : rows[i].values) {
      const auto part = static_cast<std::size_t>(std::find(names.begin(), names.end(), value.part) -
                                                 names.begin());
      const double x = inside(axis, from);
      from += value.value;
      canvas.rectangle({x, y + 6}, inside(axis, from) - x, kRowHeight - 12, colorOf(part));
    }
    canvas.text({inside(axis, from) + 6, y + 20}, tickText(std::round(from * 100) / 100),
                {11.5, kSoft, false, Align::Start, 0});
  }
}

void Figure::Panel::drawDots(Canvas& canvas, double top) const {
  double low = 1e300, high = 0;
  for (const PlotRow& row : rows)
    for (const PlotValue& value : row.values)
      if (value.value > 0) low = std::min(low, value.value), high = std::max(high, value.value);
  const Axis axis = logAxis(low, high);
  const double bottom = top + kRowHeight * static_cast<double>(rows.size());
  drawAxisX(canvas, axis, top, bottom, unitX);
  const std::vector<std::string> names = parts();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = top + kRowHeight * (static_cast<double>(i) + .5);
    canvas.text({kLeft - 12, y + 5}, rows[i].name, {12, kText, false, Align::End, 0});
    double first = 1e300, last = 0;
    for (const PlotValue& value : rows[i].values)
      if (value.value > 0) first = std::min(first, value.value), last = std::max(last, value.value);
    if (last > 0) canvas.line({{inside(axis, first), y}, {inside(axis, last), y}}, 2, kFrame);
    for (const PlotValue& value : rows[i].values) {
      if (!(value.value > 0)) continue;
      const auto part = static_cast<std::size_t>(std::find(names.begin(), names.end(), value.part) -
                                                 names.begin());
      canvas.disc({inside(axis, value.value), y}, 5.5, colorOf(part));
    }
  }
}

void Figure::Panel::drawLines(Canvas& canvas, double top) const {
  double lowX = 1e300, highX = -1e300, lowY = logY ? 1e300 : 0, highY = -1e300;
  const auto shown = [&](const Point& p) { return (!logX || p.x > 0) && (!logY || p.y > 0); };
  for (const PlotRow& row : rows) {
    for (const Point& p : row.points) {
      if (!shown(p)) continue;
      lowX = std::min(lowX, p.x), highX = std::max(highX, p.x);
      lowY = std::min(lowY, p.y), highY = std::max(highY, p.y);
    }
  }
  if (highY < lowY) lowX = highX = lowY = highY = 1;
  const Axis x = logX ? logAxis(lowX, highX) : linearAxis(lowX, highX, 8),
             y = logY ? logAxis(lowY, highY) : linearAxis(lowY, highY);
  const double bottom = top + kLinesHeight;
  const auto up = [&](double value) { return bottom - y.at(value) * (kLinesHeight - 8); };
  drawAxisX(canvas, x, top + 8, bottom, unitX);
  for (const double tick : y.ticks) {
    canvas.line({{kLeft, up(tick)}, {kPlotWidth - kRight, up(tick)}}, 1, kRule);
    canvas.text({kLeft - 10, up(tick) + 4}, tickText(tick), {11.5, kSoft, false, Align::End, 0});
  }
  canvas.text({kLeft - 92, (top + bottom) / 2}, unitY, {12, kSoft, false, Align::Middle, 90});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<Point> points;
    for (const Point& p : rows[i].points)
      if (shown(p)) points.push_back({inside(x, p.x), up(p.y)});
    canvas.line(points, 1.8, colorOf(i));
    if (logX)
      for (const Point& p : points) canvas.disc(p, 3.5, colorOf(i));
  }
}

}  // namespace rubble::render
