#include "apps/cli/render_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "apps/cli/output.h"
#include "io/picture_poses.h"
#include "io/recording.h"

namespace rubble::cli {
namespace {

/// A scene is run twice, first for its camera, up to this number of steps of a body.
constexpr double kMostSteps = 4e5;
/// So many moments show how far a run reaches.
constexpr int kMoments = 60;

class Simulation final : public MomentSource {
 public:
  Simulation(const JobOptions& options, io::ColorBy colorBy, const render::Overlays& overlays)
      : Simulation(withoutProbes(prepareJob(options)), colorBy, overlays) {
    options_ = options;
  }

  bool advance() override {
    if (taken_ >= steps_) return false;
    ++taken_;
    stepMs_ = runner_.step().totalMs;
    return true;
  }
  void look(Moment& moment) override {
    moment.step = world().stepCount();
    moment.time = world().time();
    moment.stepMs = stepMs_;
    watched_.update(runner_.world(), colorBy_, moment.bodies, moment.epoch);
    if (overlays_.any()) moment.lines = render::overlayLines(world(), overlays_, bodySize_);
  }
  double time() const override { return world().time(); }
  double nextTime() const override { return world().time() + world().params().dt; }
  double stepMs() const override { return stepMs_; }
  int steps() const override { return steps_; }
  double dt() const override { return world().params().dt; }
  Vec3 gravity() const override { return world().gravity(); }
  std::vector<std::vector<io::PictureBody>> course() const override {
    std::vector<std::vector<io::PictureBody>> moments{io::pictureBodies(runner_.job().scene, true)};
    if (static_cast<double>(moments[0].size()) * steps_ > kMostSteps) return moments;
    PreparedJob prepared = withoutProbes(prepareJob(options_));
    prepared.world.timings = false;
    scenes::Runner ahead(std::move(prepared.job), prepared.world);
    moments[0] = io::pictureBodies(ahead.world());
    for (int step = 1; step <= steps_; ++step) {
      ahead.step();
      if (step % std::max(1, steps_ / kMoments) == 0) moments.push_back(io::pictureBodies(ahead.world()));
    }
    return moments;
  }
  scenes::Camera camera() const override { return runner_.job().camera; }
  const Appearance& appearance() const override { return runner_.job().appearance; }
  bool smashes() const override { return runner_.job().smashStep >= 0; }
  std::string title() const override { return title_; }
  std::string label() const override { return label_; }

 private:
  Simulation(PreparedJob prepared, io::ColorBy colorBy, const render::Overlays& overlays)
      : title_(prepared.title),
        label_(fmt::format("{}, {} iteration{}", prepared.world.backend, prepared.world.params.iterations,
                           prepared.world.params.iterations == 1 ? "" : "s")),
        steps_(prepared.steps),
        runner_(std::move(prepared.job), prepared.world),
        colorBy_(colorBy),
        overlays_(overlays),
        bodySize_(io::typicalSize(io::pictureBodies(world()))) {}

  const World& world() const { return const_cast<scenes::Runner&>(runner_).world(); }

  JobOptions options_;
  std::string title_, label_;
  int steps_;
  int taken_ = 0;
  double stepMs_ = 0;  ///< of the last step [ms]
  io::WatchedBodies watched_;
  scenes::Runner runner_;
  io::ColorBy colorBy_;
  render::Overlays overlays_;
  double bodySize_;  ///< [m]
};

class Recording final : public MomentSource {
 public:
  Recording(const std::string& file, const std::optional<int>& steps) : file_(file), reader_(file) {
    if (reader_.frameCount() == 0) throw Error(file, "a trajectory with frames", "none");
    frames_ = reader_.frameCount();
    if (steps) frames_ = std::min(frames_, *steps + 1);
    time_ = reader_.frame(0).time;
    nextTime_ = reader_.frame(std::min(1, frames_ - 1)).time;
  }

  bool advance() override {
    if (at_ + 1 >= frames_) return false;
    ++at_;
    time_ = nextTime_;
    nextTime_ = reader_.frame(std::min(at_ + 1, frames_ - 1)).time;
    return true;
  }
  void look(Moment& moment) override { moment = read(at_); }
  double time() const override { return time_; }
  double nextTime() const override { return nextTime_; }
  double stepMs() const override { return 0; }
  int steps() const override { return frames_ - 1; }
  double dt() const override { return reader_.header().dt; }
  Vec3 gravity() const override { return reader_.header().gravity; }
  std::vector<std::vector<io::PictureBody>> course() const override {
    std::vector<std::vector<io::PictureBody>> moments;
    for (int frame = 0; frame < frames_; frame += std::max(1, frames_ / kMoments))
      moments.push_back(io::pictureBodies(reader_, frame));
    return moments;
  }
  scenes::Camera camera() const override { return {}; }
  const Appearance& appearance() const override { return reader_.header().appearance; }
  bool smashes() const override { return true; }
  std::string title() const override { return reader_.header().scene; }
  std::string label() const override { return ""; }

 private:
  Moment read(int index) {
    const io::RecordedFrame frame = reader_.frame(index);
    return {frame.step, frame.time, io::pictureBodies(reader_, index), 0};
  }

  std::string file_;
  mutable io::RecordingReader reader_;
  int frames_ = 0, at_ = 0;
  double time_ = 0, nextTime_ = 0;  ///< [s]
};

/// A surface whose vertices lie between those of two; `b` where these are not the same ones.
Shape between(const Shape& a, const Shape& b, double at) {
  if (a.geometry->points.size() != b.geometry->points.size() ||
      a.geometry->triangles != b.geometry->triangles)
    return b;
  ShapeGeometry geometry = *b.geometry;
  for (std::size_t i = 0; i < geometry.points.size(); ++i)
    geometry.points[i] = a.geometry->points[i] + (geometry.points[i] - a.geometry->points[i]) * at;
  Shape out = b;
  out.geometry = std::make_shared<const ShapeGeometry>(std::move(geometry));
  return out;
}

}  // namespace

bool isRecording(const std::string& scene) { return std::filesystem::path(scene).extension() == ".rubble"; }

std::unique_ptr<MomentSource> momentSource(const JobOptions& options, io::ColorBy colorBy,
                                           const render::Overlays& overlays) {
  if (!isRecording(options.scene)) return std::make_unique<Simulation>(options, colorBy, overlays);
  requireWorldless(colorBy);
  if (overlays.any())
    throw Error("--show", "a scene to simulate: a trajectory has poses alone", options.scene);
  return std::make_unique<Recording>(options.scene, options.steps);
}

Moment between(const Moment& a, const Moment& b, double at) {
  Moment moment = b;
  if (at >= 1 || a.bodies.size() != b.bodies.size()) return moment;
  moment.time = a.time + (b.time - a.time) * at;
  for (std::size_t i = 0; i < b.bodies.size(); ++i) {
    if (a.bodies[i].key != b.bodies[i].key) return b;
    const Quat& p = a.bodies[i].orientation;
    Quat q = b.bodies[i].orientation;
    // The short way round; steps are small, so the chord is as good as the arc.
    if (p.s * q.s + dot(p.v, q.v) < 0) q = {-q.s, -q.v};
    moment.bodies[i].orientation = normalize(Quat{p.s + (q.s - p.s) * at, p.v + (q.v - p.v) * at});
    moment.bodies[i].position = a.bodies[i].position + (b.bodies[i].position - a.bodies[i].position) * at;
    if (b.bodies[i].deforms) moment.bodies[i].shape = between(a.bodies[i].shape, b.bodies[i].shape, at);
  }
  return moment;
}

}  // namespace rubble::cli
