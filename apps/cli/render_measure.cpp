#include <algorithm>
#include <chrono>
#include <ctime>
#include <numbers>

#include "apps/cli/output.h"
#include "apps/cli/render_job.h"
#include "apps/cli/render_view.h"
#include "apps/cli/statistics.h"
#include "render/painter.h"

#if defined(RUBBLE_HAS_GL)
#include "render/headless.h"
#include "render/stage.h"
#endif

namespace rubble::cli {

#if defined(RUBBLE_HAS_GL)
namespace {

using Clock = std::chrono::steady_clock;

/// Frames that are drawn stage by stage, from all round as the others.
constexpr int kMeasuredFrames = 12;

double since(Clock::time_point began) {
  return std::chrono::duration<double, std::milli>(Clock::now() - began).count();
}

/// What is drawn, and where from.
class Measurement {
 public:
  Measurement(const RenderOptions& options, int frames)
      : frames_(frames),
        prepared_(withoutProbes(prepareJob(options.job))),
        camera_(cameraOf(options.camera, sightOf(prepared_.job), options.width, options.height,
                         options.fieldOfView)),
        runner_(std::move(prepared_.job), prepared_.world),
        stage_(io::pictureBodies(runner_.world()), runner_.world().gravity(), camera_, options.width,
               options.height, runner_.job().appearance) {
    quality_.samples = std::max(1, options.samples);
    stage_.follow(runner_.world());
  }
  void step() { runner_.step(); }
  void draw(int frame) {
    const Clock::time_point began = Clock::now();
    stage_.follow(runner_.world());
    if (measures_) stage_.renderer().finish(), add("poses", since(began));
    stage_.renderer().draw(turned(camera_, 2 * std::numbers::pi * frame / std::max(1, frames_)),
                           stage_.setting(), quality_);
    stage_.renderer().finish();
    if (!measures_) return;
    for (const render::PassTime& pass : stage_.renderer().passTimes()) add(pass.name, pass.ms);
  }
  /// From now on stage by stage, waiting for the device after each.
  void measureStages() {
    measures_ = true;
    stage_.renderer().measurePasses(true);
  }
  /// Sums over the frames since then [ms].
  const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }
  render::Stage& stage() { return stage_; }
  std::size_t bodies() { return runner_.world().bodies().size(); }

 private:
  void add(const std::string& name, double ms) {
    const auto known = std::find_if(stages_.begin(), stages_.end(),
                                    [&](const auto& stage) { return stage.first == name; });
    known == stages_.end() ? void(stages_.emplace_back(name, ms)) : void(known->second += ms);
  }

  bool measures_ = false;
  std::vector<std::pair<std::string, double>> stages_;
  int frames_;
  PreparedJob prepared_;
  render::Camera camera_;
  scenes::Runner runner_;
  render::Stage stage_;
  render::Quality quality_;
};

}  // namespace

RenderMeasure measureRender(const RenderOptions& options, int frames, bool live) {
  if (isRecording(options.job.scene)) throw Error("--measure", "a scene", options.job.scene);
  render::HeadlessContext context;
  Measurement measurement(options, frames);
  RenderMeasure result;
  result.device = context.renderer();
  result.bodies = measurement.bodies();
  result.frames = frames;
  measurement.draw(0);  // shaders are compiled at their first use
  if (live) measurement.step();
  std::vector<double> ms;
  std::clock_t cpu = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const Clock::time_point stepBegan = Clock::now();
    if (live) measurement.step();
    if (live) result.stepMs += since(stepBegan) / frames;
    const Clock::time_point began = Clock::now();
    const std::clock_t cpuBegan = std::clock();
    measurement.draw(frame);
    ms.push_back(since(began));
    cpu += std::clock() - cpuBegan;
  }
  result.cpuMs = 1000. * static_cast<double>(cpu) / CLOCKS_PER_SEC / frames;
  result.boxes = measurement.stage().renderer().bodies().computesBoxes() ? "by compute" : "as triangles";
  result.poses = measurement.stage().posesFrom();
  for (const double value : ms) result.meanMs += value / frames;
  std::sort(ms.begin(), ms.end());
  result.medianMs = ms[ms.size() / 2];
  result.p95Ms = ms[std::min(ms.size() - 1, ms.size() * 95 / 100)];
  const int measured = std::min(frames, kMeasuredFrames);
  measurement.measureStages();
  for (int i = 0; i < measured; ++i) {
    if (live) measurement.step();
    measurement.draw(i * frames / measured);
  }
  for (const auto& [name, ms] : measurement.stages()) result.passes.emplace_back(name, ms / measured);
  return result;
}
#else
RenderMeasure measureRender(const RenderOptions&, int, bool) {
  render::makePaintDevice();  // says what is missing
  return {};
}
#endif

}  // namespace rubble::cli
