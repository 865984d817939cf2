#include "apps/cli/render_job.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/layer_files.h"
#include "apps/cli/progress.h"
#include "apps/cli/render_view.h"
#include "io/picture_values.h"
#include "render/film.h"
#include "render/painter.h"

namespace rubble::cli {
namespace {

constexpr int kPictureSamples = 32, kFilmSamples = 4, kFilmSamplesGpu = 16;
constexpr double kTimeSlack = 1e-9;
/// Exposures of a picture with motion blur.
constexpr int kExposures = 8;

/// One run that is drawn. Moments are taken where a picture needs them: of the step that it shows, and of the
/// one before if it lies between.
class Side {
 public:
  Side(const RenderOptions& options, const JobOptions& job, int width, int height,
       render::PaintDevice& device, int samples)
      : options_(options),
        width_(width),
        height_(height),
        device_(device),
        samples_(samples),
        source_(momentSource(job, options.colorBy, options.show)),
        start_(current().bodies) {
    const std::vector<NamedCamera>& own = source_->appearance().cameras;
    const auto named = std::ranges::find(own, options_.camera, &NamedCamera::name);
    if (named != own.end()) {
      named_ = *named;
    } else if (std::ranges::count(cameraNames(), options_.camera) == 0) {
      std::vector<std::string> known = cameraNames();
      for (const NamedCamera& camera : own) known.push_back(camera.name);
      throw Error("--camera", fmt::format("one of {}", fmt::join(known, ", ")), options_.camera);
    }
  }

  /// Chooses the camera for these moments of the run. Call before paint().
  void plan(std::span<const std::vector<io::PictureBody>> moments) {
    const std::optional<Vec3> eye = options_.eye ? options_.eye
                                    : named_     ? std::optional(named_->eye)
                                                 : std::nullopt;
    plan_.emplace(planOf(named_ ? "scene" : options_.camera, *source_, moments, width_, height_,
                         options_.fieldOfView, eye));
    render::PaintSettings settings{width_, height_, samples_, options_.colorBy, options_.colorMax};
    settings.background = options_.background;
    settings.transparent = options_.transparent;
    settings.sun = options_.sun;
    settings.appearance = source_->appearance();
    options_.light.apply(settings.appearance);
    painter_ = device_.painter(plan_->shown(start_), source_->gravity(), cameraAt(start_, 0), settings);
  }
  std::vector<std::vector<io::PictureBody>> startAndNow() { return {start_, current().bodies}; }
  /// Of the last picture [m].
  std::vector<float> depths() const { return painter_->depths(); }
  std::vector<float> normals() const { return painter_->normals(); }

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
    io::Image image = painter_->paint(plan_->shown(shown.bodies), cameraAt(shown.bodies, filmTime),
                                      shown.lines);
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

  render::Camera cameraAt(std::span<const io::PictureBody> bodies, double filmTime) const {
    render::Camera camera = plan_->camera(bodies);
    if (named_) {
      camera.eye = named_->eye, camera.target = named_->target;
      camera.fieldOfView = named_->fieldOfView.value_or(camera.fieldOfView);
    }
    if (options_.path) camera = options_.path->at(filmTime, camera);
    if (options_.eye) camera.eye = *options_.eye;
    if (options_.target) camera.target = *options_.target;
    return turned(camera, options_.orbit * filmTime);
  }

  const RenderOptions& options_;
  int width_, height_;
  render::PaintDevice& device_;
  int samples_;
  std::unique_ptr<MomentSource> source_;
  Moment current_, previous_;
  bool seen_ = false;         ///< `current_` is of the step that the source stands at
  bool hasPrevious_ = false;  ///< `previous_` is of the one before
  std::vector<io::PictureBody> start_;
  std::optional<NamedCamera> named_;  ///< of the scene, if it has one of the name that is asked for
  std::optional<render::ViewPlan> plan_;
  std::unique_ptr<render::Painter> painter_;
};

/// Several exposures as one picture: the mean of their light.
class Exposure {
 public:
  void add(const io::Image& image) {
    const auto linear = [](std::uint8_t byte) {
      const float s = static_cast<float>(byte) / 255;
      return s <= .04045f ? s / 12.92f : std::pow((s + .055f) / 1.055f, 2.4f);
    };
    if (sum_.empty()) sum_.resize(image.rgb.size()), alpha_.resize(image.alpha.size());
    for (std::size_t i = 0; i < sum_.size(); ++i)
      sum_[i] += linear(image.rgb[i]) * (alpha_.empty() ? 1 : static_cast<float>(image.alpha[i / 3]) / 255);
    for (std::size_t i = 0; i < alpha_.size(); ++i) alpha_[i] += static_cast<float>(image.alpha[i]) / 255;
    width_ = image.width, height_ = image.height;
    ++count_;
  }
  io::Image image() const {
    const auto byte = [](float s) {
      return static_cast<std::uint8_t>(std::lround(255 * std::clamp(s, 0.f, 1.f)));
    };
    io::Image out{width_, height_, {}};
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      const float light = sum_[i] /
                          (alpha_.empty() ? static_cast<float>(count_) : std::max(1e-6f, alpha_[i / 3]));
      out.rgb.push_back(
          byte(light <= .0031308f ? 12.92f * light : 1.055f * std::pow(light, 1 / 2.4f) - .055f));
    }
    for (const float alpha : alpha_) out.alpha.push_back(byte(alpha / static_cast<float>(count_)));
    return out;
  }

 private:
  int width_ = 0, height_ = 0, count_ = 0;
  std::vector<float> sum_, alpha_;
};

/// "depth_%04d.npy" with a number in it.
std::string numbered(const std::string& pattern, int number) {
  const std::size_t at = pattern.find('%'), end = pattern.find('d', at);
  if (at == std::string::npos || end == std::string::npos) return pattern;
  const int digits = end > at + 1 ? std::atoi(pattern.substr(at + 1, end - at - 1).c_str()) : 0;
  return pattern.substr(0, at) + fmt::format("{:0{}}", number, std::clamp(digits, 1, 9)) +
         pattern.substr(end + 1);
}

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

void LightOptions::apply(Appearance& to) const {
  if (sunColor) to.daylight.sunColor = *sunColor;
  if (sunStrength) to.daylight.sunStrength = *sunStrength;
  if (skyStrength) to.daylight.skyStrength = *skyStrength;
  to.lights.insert(to.lights.end(), lights.begin(), lights.end());
  if (to.lights.size() > kMostPointLights)
    throw Error("--light", fmt::format("at most {} lights with those of the scene", kMostPointLights),
                std::to_string(to.lights.size()));
}

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
  if (!options.depthFile.empty() && jobs.size() > 1) throw Error("--depth", "one run", "--compare");
  if (!options.normalsFile.empty() && jobs.size() > 1) throw Error("--normals", "one run", "--compare");
  Progress progress(first.source().title(), single ? std::max(1, steps) : frames, options.quiet,
                    single ? "step" : "picture");
  if (!single)
    for (const auto& side : sides) side->plan(side->source().course());
  RenderResult result{0, device->name()};
  if (single) {
    // The last step, at any picture rate.
    for (int step = 1; step <= steps; ++step) {
      for (const auto& side : sides) side->step();
      progress.update(step, first.stepMs());
    }
    for (const auto& side : sides) side->plan(side->startAndNow());
  }
  for (int frame = 0; frame < frames; ++frame) {
    const double time = single ? end : begin + frame * frameTime;
    const int exposures = options.shutter > 0 && !single ? kExposures : 1;
    Exposure exposure;
    io::Image image;
    for (int k = 0; k < exposures; ++k) {
      const double now = time - options.shutter * frameTime * (exposures - 1 - k) / exposures;
      std::vector<io::Image> images;
      for (const auto& side : sides) {
        side->reach(std::max(now, begin));
        images.push_back(side->paint(std::max(now, begin), frame / options.fps));
      }
      image = together(std::move(images));
      if (exposures > 1) exposure.add(image);
    }
    sink->put(exposures > 1 ? exposure.image() : std::move(image));
    if (!options.depthFile.empty())
      writeDepths(numbered(options.depthFile, frame), sides.front()->depths(), width, options.height);
    if (!options.normalsFile.empty())
      writeNormals(numbered(options.normalsFile, frame), sides.front()->normals(), width, options.height);
    ++result.frames;
    if (!single) progress.update(frame + 1, first.stepMs());
  }
  sink->finish();
  return result;
}

}  // namespace rubble::cli
