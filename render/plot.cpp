#include "render/plot.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <rubble/error.h>

#include "io/scene_json.h"
#include "render/plot_panel.h"

namespace rubble::render {
namespace {

using Json = nlohmann::ordered_json;
using Panel = Figure::Panel;

constexpr double kTop = 10, kBottom = 8;
constexpr double kPngScale = 2;

/// A number of a report by its path, or NaN.
double numberAt(const Json& report, const std::string& section, const std::string& key) {
  const auto found = report.find(section);
  if (found == report.end() || !found->is_object()) return NAN;
  const auto value = found->find(key);
  return value != found->end() && value->is_number() ? value->get<double>() : NAN;
}

/// Did a study give this report a name?
bool hasLabel(const Json& report) {
  const auto label = report.find("label");
  return label != report.end() && label->is_string();
}

/// Names that distinguish the reports: their labels, or the scene and the differences between reports of one
/// scene.
std::vector<std::string> namesOf(const std::vector<Json>& reports) {
  if (std::all_of(reports.begin(), reports.end(), hasLabel)) {
    std::vector<std::string> labels;
    for (const Json& r : reports) labels.push_back(r.at("label").get<std::string>());
    return labels;
  }
  const auto differs = [&](const char* key) {
    return std::any_of(reports.begin(), reports.end(),
                       [&](const Json& r) { return r.value(key, Json()) != reports[0].value(key, Json()); });
  };
  const bool scene = differs("scene") || reports.size() == 1, backend = differs("backend"),
             threads = differs("threads"), iterations = differs("iterations"), dt = differs("dt");
  std::vector<std::string> names;
  for (const Json& r : reports) {
    std::string name;
    const auto add = [&](const std::string& part) { name += (name.empty() ? "" : ", ") + part; };
    if (scene) add(std::filesystem::path(r.at("scene").get<std::string>()).stem().string());
    if (backend) add(r.at("backend").get<std::string>());
    if (threads) add(std::to_string(r.at("threads").get<int>()) + " threads");
    if (iterations) add(std::to_string(r.at("iterations").get<int>()) + " iterations");
    if (dt) add("dt " + tickText(r.at("dt").get<double>()) + " s");
    names.push_back(name.empty() ? r.at("scene").get<std::string>() : name);
  }
  // Reports that differ in nothing of this have the names of their files, or are counted.
  const std::vector<std::string> before = names;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::ranges::count(before, names[i]) > 1 && reports[i].contains("file"))
      names[i] += ", " + reports[i].at("file").get<std::string>();
  for (std::size_t i = 0; i < names.size(); ++i) {
    int same = 1;
    for (std::size_t k = i + 1; k < names.size(); ++k)
      if (names[k] == names[i]) names[k] += " (" + std::to_string(++same) + ")";
  }
  return names;
}

/// Parts that are thin in every bar become one, "other".
void gatherSmallParts(std::vector<PlotRow>& rows) {
  constexpr double kThin = .01;
  std::vector<std::string> thick;
  for (const PlotRow& row : rows) {
    double total = 0;
    for (const PlotValue& value : row.values) total += value.value;
    for (const PlotValue& value : row.values)
      if (value.value >= kThin * total) thick.push_back(value.part);
  }
  for (PlotRow& row : rows) {
    PlotValue other{"other", 0};
    std::vector<PlotValue> kept;
    for (const PlotValue& value : row.values) {
      const bool isThick = std::find(thick.begin(), thick.end(), value.part) != thick.end();
      isThick ? kept.push_back(value) : void(other.value += value.value);
    }
    if (other.value > 0) kept.push_back(other);
    row.values = std::move(kept);
  }
}

std::vector<Panel> timingPanels(const std::vector<Json>& reports, const std::vector<std::string>& names) {
  Panel panel;
  panel.form = PanelForm::StackedBars;
  panel.title = "Time of a settled step by stage";
  panel.unitX = "ms per step";
  for (std::size_t i = 0; i < reports.size(); ++i) {
    PlotRow row{names[i], {}, {}};
    if (const auto stages = reports[i].find("stages_ms"); stages != reports[i].end() && stages->is_object())
      for (const auto& [name, ms] : stages->items())
        if (ms.is_number()) row.values.push_back({name, ms.get<double>()});
    if (!row.values.empty()) panel.rows.push_back(std::move(row));
  }
  gatherSmallParts(panel.rows);
  return panel.rows.empty() ? std::vector<Panel>{} : std::vector<Panel>{panel};
}

std::vector<Panel> errorPanels(const std::vector<Json>& reports, const std::vector<std::string>& names) {
  std::vector<Panel> panels;
  const auto add = [&](const char* title, const char* section,
                       const std::vector<std::pair<const char*, const char*>>& keys) {
    Panel panel;
    panel.form = PanelForm::Dots;
    panel.title = title;
    panel.unitX = "m";
    for (std::size_t i = 0; i < reports.size(); ++i) {
      PlotRow row{names[i], {}, {}};
      for (const auto& [key, label] : keys)
        if (const double value = numberAt(reports[i], section, key); value > 0)
          row.values.push_back({label, value});
      if (!row.values.empty()) panel.rows.push_back(std::move(row));
    }
    if (!panel.rows.empty()) panels.push_back(std::move(panel));
  };
  add("Penetration of contacts", "penetration_m", {{"mean", "mean"}, {"p99", "99 %"}, {"max", "max"}});
  add("Gap of joints", "joint_gap_m", {{"mean", "mean"}, {"max", "max"}});
  return panels;
}

std::vector<Panel> seriesPanel(const std::vector<Json>& reports, const std::vector<std::string>& names,
                               const std::string& key, const char* title, const char* unit,
                               bool logarithmic = false) {
  Panel panel;
  panel.logY = logarithmic;
  panel.title = title;
  panel.unitX = "time [s]";
  panel.unitY = unit;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const auto series = reports[i].find("series");
    if (series == reports[i].end() || !series->contains("time_s") || !series->contains(key)) continue;
    const Json &times = series->at("time_s"), &values = series->at(key);
    PlotRow row{names[i], {}, {}};
    for (std::size_t k = 0; k < std::min(times.size(), values.size()); ++k)
      if (times[k].is_number() && values[k].is_number())
        row.points.push_back({times[k].get<double>(), values[k].get<double>()});
    // what is 0 throughout, such as contacts and joints of a scene without any, shows nothing
    const bool shows = std::ranges::any_of(row.points, [](const auto& p) { return p.y != 0; });
    if (row.points.size() > 1 && shows) panel.rows.push_back(std::move(row));
  }
  return panel.rows.empty() ? std::vector<Panel>{} : std::vector<Panel>{panel};
}

/// "error" of a study over the iterations of a step, a line for each label.
std::vector<Panel> convergencePanel(const std::vector<Json>& reports) {
  Panel panel;
  panel.title = "Error against a converged run";
  panel.unitX = "iterations per step";
  panel.logX = panel.logY = true;
  for (const Json& report : reports) {
    const auto error = report.find("error");
    if (!hasLabel(report) || error == report.end() || !error->is_number()) continue;
    const std::string label = report.at("label").get<std::string>();
    if (const auto unit = report.find("error_unit"); unit != report.end() && unit->is_string())
      panel.unitY = unit->get<std::string>();
    auto row = std::find_if(panel.rows.begin(), panel.rows.end(),
                            [&](const PlotRow& r) { return r.name == label; });
    if (row == panel.rows.end()) row = panel.rows.insert(panel.rows.end(), PlotRow{label, {}, {}});
    row->points.push_back({report.at("iterations").get<double>(), error->get<double>()});
  }
  return panel.rows.empty() ? std::vector<Panel>{} : std::vector<Panel>{panel};
}

}  // namespace

const std::vector<std::string>& plotKinds() {
  static const std::vector<std::string> kinds{"all",    "convergence", "timing", "error",
                                              "energy", "gap",         "depth",  "step"};
  return kinds;
}

Figure::Figure(const std::vector<Json>& reports, const std::string& kind) {
  if (std::find(plotKinds().begin(), plotKinds().end(), kind) == plotKinds().end())
    throw Error("--kind", "all, convergence, timing, error, energy, gap, depth or step", kind);
  if (reports.empty()) throw Error("reports", "at least one", "none");
  const std::vector<std::string> names = namesOf(reports);
  const auto add = [&](const char* name, std::vector<Panel> panels) {
    if (kind == "all" || kind == name) panels_.insert(panels_.end(), panels.begin(), panels.end());
  };
  add("convergence", convergencePanel(reports));
  add("timing", timingPanels(reports, names));
  add("error", errorPanels(reports, names));
  add("energy", seriesPanel(reports, names, "energy_j", "Energy, kinetic and potential", "J"));
  add("gap", seriesPanel(reports, names, "gap_mean_m", "Mean gap of joints", "m", true));
  add("depth", seriesPanel(reports, names, "penetration_max_m", "Deepest contact", "m"));
  add("step", seriesPanel(reports, names, "step_ms", "Time of a step", "ms"));
  if (panels_.empty()) {
    const bool needsSeries = kind == "energy" || kind == "gap" || kind == "depth" || kind == "step";
    throw Error("reports",
                std::string("something to plot as ") + kind +
                    (needsSeries ? " other than 0 (write reports with run --series --json)" : ""),
                "none");
  }
}

Figure::~Figure() = default;
Figure::Figure(Figure&&) noexcept = default;

PlotSize Figure::size() const {
  PlotSize size{kPlotWidth, kTop + kBottom};
  for (const Panel& panel : panels_) size.height += panel.height();
  return size;
}

void Figure::draw(Canvas& canvas) const {
  canvas.rectangle({0, 0}, size().width, size().height, {0xffffff});
  double top = kTop;
  for (const Panel& panel : panels_) {
    panel.draw(canvas, top);
    top += panel.height();
  }
}

std::vector<Json> readReports(const std::vector<std::string>& files) {
  std::vector<Json> reports;
  for (const std::string& file : files) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error(file, "a file that can be read", "none");
    Json content;
    try {
      content = Json::parse(in);
    } catch (const Json::exception& error) {
      // without the name of the library's exception
      const std::string text = error.what();
      throw Error(file, "JSON", text.substr(text.find("] ") + 2));
    }
    if (!content.is_array()) content = Json::array({content});
    for (const Json& report : content) {
      const bool good = report.is_object() && report.contains("scene") && report["scene"].is_string() &&
                        report.contains("backend") && report["backend"].is_string() &&
                        report.contains("iterations") && report["iterations"].is_number_integer() &&
                        report.contains("threads") && report["threads"].is_number_integer() &&
                        report.contains("dt") && report["dt"].is_number();
      if (!good) throw Error(file, "reports of run or bench (--json)", "something else");
      reports.push_back(report);
      reports.back()["file"] = std::filesystem::path(file).stem().string();
    }
  }
  return reports;
}

void writeFigure(const Figure& figure, const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  const auto [width, height] = figure.size();
  if (extension == ".svg") {
    std::string document;
    Canvas canvas(document, width, height);
    figure.draw(canvas);
    canvas.finish();
    return io::writeText(file, document);
  }
  if (extension != ".png") throw Error("--out", "a .svg or .png file", file);
  io::Image image{static_cast<int>(std::lround(kPngScale * width)),
                  static_cast<int>(std::lround(kPngScale * height)),
                  {}};
  image.rgb.assign(3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 255);
  Canvas canvas(image, kPngScale);
  figure.draw(canvas);
  canvas.finish();
  io::writePng(image, file);
}

}  // namespace rubble::render
