#include "render/painter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <rubble/error.h>

#if defined(RUBBLE_HAS_GL)
#include "render/headless.h"
#include "render/stage.h"
#endif

namespace rubble::render {

#if defined(RUBBLE_HAS_GL)
namespace {

Vec3 sunAt(const std::array<double, 2>& angles, const Vec3& up, const Camera& camera) {
  const Vec3 ahead = camera.target - camera.eye,
             fallback = cross(up, Vec3{std::fabs(up.x) < .6 ? 1. : 0., 1, 0});
  const Vec3 right = normalize(cross(ahead, up), normalize(fallback));
  const Vec3 level = right * std::cos(angles[0]) + cross(up, right) * std::sin(angles[0]);
  return level * std::cos(angles[1]) + up * std::sin(angles[1]);
}

/// Makes a context current as long as it lives.
class Drawing {
 public:
  explicit Drawing(const HeadlessContext& context) { context.makeCurrent(); }

 private:
  KeptContext before_;
};

class GlPainter final : public Painter {
 public:
  GlPainter(std::shared_ptr<const HeadlessContext> context, std::span<const io::PictureBody> atStart,
            const Vec3& gravity, const Camera& camera, const PaintSettings& settings)
      : context_(std::move(context)), settings_(settings) {
    const Drawing drawing(*context_);
    stage_ = std::make_unique<Stage>(atStart, gravity, camera, settings.width, settings.height,
                                     settings.appearance);
    quality_.samples = settings.transparent ? std::max(2, settings.samples) : settings.samples;
    stage_->setting().background = settings.background;
    stage_->setting().transparent = settings.transparent;
    if (settings.sun) stage_->setting().toSun = sunAt(*settings.sun, stage_->setting().up, camera);
  }
  ~GlPainter() override {
    try {
      const Drawing drawing(*context_);
      stage_.reset();
    } catch (const Error&) {
      static_cast<void>(stage_.release());  // its buffers end with the context
    }
  }
  GlPainter(const GlPainter&) = delete;
  GlPainter& operator=(const GlPainter&) = delete;

  io::Image paint(std::span<const io::PictureBody> bodies, const Camera& camera,
                  std::span<const Line> lines) override {
    const Drawing drawing(*context_);
    stage_->renderer().setLines(lines);
    stage_->setBodies(bodies, settings_.colorBy, settings_.fullValue);
    return stage_->picture(camera, quality_);
  }
  std::vector<float> depths() const override {
    const Drawing drawing(*context_);
    return stage_->renderer().readDepths();
  }
  std::vector<float> normals() const override {
    const Drawing drawing(*context_);
    return stage_->renderer().readNormals();
  }

 private:
  std::shared_ptr<const HeadlessContext> context_;
  PaintSettings settings_;
  std::unique_ptr<Stage> stage_;
  Quality quality_;
};

class GlDevice final : public PaintDevice {
 public:
  GlDevice() {
    const KeptContext before;
    context_ = std::make_shared<HeadlessContext>();
  }
  std::unique_ptr<Painter> painter(std::span<const io::PictureBody> atStart, const Vec3& gravity,
                                   const Camera& camera, const PaintSettings& settings) override {
    return std::make_unique<GlPainter>(context_, atStart, gravity, camera, settings);
  }
  std::string name() const override { return "OpenGL on " + context_->renderer(); }
  bool isSoftware() const override { return context_->isSoftware(); }

 private:
  std::shared_ptr<const HeadlessContext> context_;
};

}  // namespace

std::unique_ptr<PaintDevice> makePaintDevice() { return std::make_unique<GlDevice>(); }
std::string openglStatus() { return "on: OpenGL through EGL"; }
#else
std::unique_ptr<PaintDevice> makePaintDevice() {
  throw Error("pictures",
              "a build with libepoxy, EGL and libpng "
              "(Debian: apt-get install libepoxy-dev libegl-dev libgl1-mesa-dri libpng-dev)",
              "one without");
}
std::string openglStatus() { return "off: built without libepoxy, EGL or libpng"; }
#endif

std::string cairoStatus() {
#if defined(RUBBLE_HAS_CAIRO)
  return "on";
#else
  return "off: built without Cairo";
#endif
}

}  // namespace rubble::render
