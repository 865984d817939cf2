#pragma once
/// One panel of a figure: bars that are made of parts, dots on a logarithmic axis, or lines over time.
#include "render/plot.h"
#include "render/plot_axis.h"

namespace rubble::render {

enum class PanelForm { StackedBars, Dots, Lines };

struct PlotValue {
  std::string part;  ///< of a bar, or kind of dot: named in the legend
  double value = 0;
};

struct PlotRow {
  std::string name;
  std::vector<PlotValue> values;  ///< bars and dots
  std::vector<Point> points;      ///< lines: x, y
};

struct Figure::Panel {
  PanelForm form = PanelForm::Lines;
  std::string title, unitX, unitY;
  std::vector<PlotRow> rows;
  bool logX = false, logY = false;  ///< of lines; values that are not above 0 are left out there

  double height() const;
  void draw(Canvas& canvas, double top) const;

 private:
  std::vector<std::string> parts() const;
  double drawLegend(Canvas& canvas, double top) const;
  void drawBars(Canvas& canvas, double top) const;
  void drawDots(Canvas& canvas, double top) const;
  void drawLines(Canvas& canvas, double top) const;
};

constexpr double kPlotWidth = 860;

}  // namespace rubble::render
