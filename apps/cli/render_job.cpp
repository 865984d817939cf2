#include "apps/cli/render_job.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "apps/cli/progress.h"
#include "apps/cli/render_view.h"
#include "io/picture_values.h"
#include "render/film.h"
#include "render/painter.h"

namespace rubble::cli {
namespace {

constexpr int kPictureSamples = 32, kFilmSamples = 4, kFilmSamplesGpu = 16;
constexpr int kDivider = 4;  // pixels between two runs
constexpr double kTimeSlack = 1e-9;

/// One run that is drawn. Moments are taken where a picture needs them: of the step that it shows, and of the
/// one before if it lies between.
class Side {
 public:
  Side(const RenderOptions& options, const JobOptions& job, int width, int height,
       render::PaintDevice& device, int samples)
      : options_(options), source_(momentSource(job, options.colorBy, options.show)) {
    camera_ = cameraOf(options.camera, sightOf(*source_), width, height, options.fieldOfView);
    if (options.eye) camera_.eye = *options.eye;
    if (options.target) camera_.target = *options.target;
    painter_ = device.painter(current().bodies, source_->gravity(), camera_,
                              {width, height, samples, options.colorBy, options.colorMax});
  }

  const MomentSource& source() const { return *source_; }
  bool step() {
    if (!source_->advance()) return false;
    seen_ = hasPrevious_ = false;
    return true;
  }
  /// Steps until the moment is not before `time` [s]; false if the source ends earlier.
  bool reach(double time) {
    while (source_->time() < time - kTimeSlack) {
      const bool straddles = source_->nextTime() > time + kTimeSlack;
      if (straddles) current();
      if (!step()) return false;
      if (straddles) std::swap(previous_, current_);
      hasPrevious_ = straddles;
    }
    return true;
  }

  io::Image paint(double time, double filmTime) {
    const double way = hasPrevious_ ? (time - previous_.time) / (current().time - previous_.time) : 1;
    const Moment blend = way < 1 ? between(previous_, current(), std::max(0., way)) : Moment();
    const Moment& shown = way < 1 ? blend : current();
    io::Image image = painter_->paint(shown.bodies, turned(camera_, options_.orbit * filmTime), shown.lines);
    if (options_.overlay) drawCaption(image, caption(shown));
    return image;
  }
  double time() const { return source_->time(); }
  double stepMs() const { return source_->stepMs(); }

 private:
  const Moment& current() {
    if (!std::exchange(seen_, true)) source_->look(current_);
    return current_;
  }

  Caption caption(const Moment& shown) const {
    Caption caption{source_->title(), {grouped(static_cast<long long>(shown.bodies.size())) + " bodies"}};
    if (!source_->label().empty()) caption.facts.push_back(source_->label());
    if (shown.stepMs > 0) caption.facts.push_back(fmt::format("{:.1f} ms per step", shown.stepMs));
    if (const io::Quantity& by = io::quantity(options_.colorBy); by.by != io::ColorBy::Body)
      caption.facts.push_back(legend(by, shown));
    caption.facts.push_back(fmt::format("{:.2f} s", shown.time));
    if (options_.slow != 1) caption.facts.push_back(fmt::format("{:g}x slower", options_.slow));
    return caption;
  }

  /// "speed up to 3.2 m/s"
  std::string legend(const io::Quantity& quantity, const Moment& shown) const {
    if (quantity.isKind) return fmt::format("colored by {}", quantity.key);
    const double full = options_.colorMax > 0 ? options_.colorMax
                                              : io::largestValue(shown.bodies, quantity.by);
    return fmt::format("{} up to {:.3g}{}{}", quantity.key, full,
                       quantity.unit == std::string("1") ? "" : " ",
                       quantity.unit == std::string("1") ? "" : quantity.unit);
  }

  const RenderOptions& options_;
  std::unique_ptr<MomentSource> source_;
  Moment current_, previous_;
  bool seen_ = false;         ///< `current_` is of the step that the source stands at
  bool hasPrevious_ = false;  ///< `previous_` is of the one before
  render::Camera camera_;
  std::unique_ptr<render::Painter> painter_;
};

io::Image together(std::vector<io::Image> images) {
  return images.size() == 1 ? std::move(images[0]) : beside(images[0], images[1]);
}

/// A film longer than this is a slip in a number.
constexpr double kMostFrames = 1e6;

int framesIn(double time, double frameTime) {
  const double frames = 1 + std::floor(time / frameTime + 1e-6);
  if (!(frames <= kMostFrames))
    throw Error("--fps, --slow", fmt::format("at most {} frames", kMostFrames), fmt::format("{}", frames));
  return static_cast<int>(frames);
}

}  // namespace

RenderResult renderFilm(const RenderOptions& options) {
  const bool single = !render::isFilm(options.out) && !render::isNumbered(options.out);
  if (!options.compare.empty() && isRecording(options.job.scene))
    throw Error("--compare", "a scene to simulate", options.job.scene);
  const std::vector<JobOptions> jobs = comparedJobs(options.job, options.compare);
  const int width = jobs.size() == 1 ? options.width : (options.width - kDivider) / 2;
  const int whole = jobs.size() == 1 ? width : 2 * width + kDivider;
  // Tests the output before anything is simulated.
  const std::unique_ptr<render::PictureSink> sink = render::pictureSink(options.out, whole, options.height,
                                                                        options.fps);
  const std::unique_ptr<render::PaintDevice> device = render::makePaintDevice();
  const int samples = options.samples > 0    ? options.samples
                      : single               ? kPictureSamples
                      : device->isSoftware() ? kFilmSamples
                                             : kFilmSamplesGpu;
  std::vector<std::unique_ptr<Side>> sides;
  for (const JobOptions& job : jobs)
    sides.push_back(std::make_unique<Side>(options, job, width, options.height, *device, samples));

  const Side& first = *sides.front();
  const double dt = first.source().dt(), start = first.time();
  const int steps = first.source().steps();
  if (options.from >= steps && options.from > 0)
    throw Error("--from", fmt::format("a step before the last, {}", steps), std::to_string(options.from));
  const double frameTime = options.every > 0 ? options.every * dt : 1 / (options.fps * options.slow);
  const double begin = start + options.from * dt, end = start + steps * dt;
  const int frames = single ? 1 : framesIn(end - begin, frameTime);
  Progress progress(first.source().title(), single ? std::max(1, steps) : frames, options.quiet);
  RenderResult result{0, device->name()};
  if (single) {
    // The last step, at any picture rate.
    for (int step = 1; step <= steps; ++step) {
      for (const auto& side : sides) side->step();
      progress.update(step, first.stepMs());
    }
  }
  for (int frame = 0; frame < frames; ++frame) {
    const double time = single ? end : begin + frame * frameTime;
    std::vector<io::Image> images;
    for (const auto& side : sides) {
      side->reach(time);
      images.push_back(side->paint(time, frame / options.fps));
    }
    sink->put(together(std::move(images)));
    ++result.frames;
    if (!single) progress.update(frame + 1, first.stepMs());
  }
  sink->finish();
  return result;
}

}  // namespace rubble::cli
