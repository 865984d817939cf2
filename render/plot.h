#pragma once
/// Plots of the JSON reports that run and bench write (io/report_json.h), in one style.
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/canvas.h"

namespace rubble::render {

/// What can be plotted: "convergence" (what tools/study_convergence writes), "timing" (stages of a step),
/// "error" (penetration and gaps), "energy", "gap", "depth" and "step" (over time; needs --series), "all"
/// (whatever the reports hold).
const std::vector<std::string>& plotKinds();

struct PlotSize {
  double width = 0, height = 0;
};

/// A figure of one or more panels, laid out and ready to be drawn.
class Figure {
 public:
  /// `reports` are the objects of one or more files. Throws Error for an unknown kind, for what is no report,
  /// and if the reports hold nothing of the kind.
  Figure(const std::vector<nlohmann::ordered_json>& reports, const std::string& kind);
  ~Figure();
  Figure(Figure&&) noexcept;

  PlotSize size() const;
  void draw(Canvas& canvas) const;

  struct Panel;

 private:
  std::vector<Panel> panels_;
};

/// Reads reports from files; each holds one report or a list. Throws Error with the file for what is none.
std::vector<nlohmann::ordered_json> readReports(const std::vector<std::string>& files);

/// Writes a figure as .svg or .png. Throws Error for another name.
void writeFigure(const Figure& figure, const std::string& file);

}  // namespace rubble::render
