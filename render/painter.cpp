#include "render/painter.h"

#include <algorithm>

#include <rubble/error.h>

#if defined(RUBBLE_HAS_GL)
#include "render/headless.h"
#include "render/stage.h"
#endif

namespace rubble::render {

#if defined(RUBBLE_HAS_GL)
namespace {

class GlPainter final : public Painter {
 public:
  GlPainter(std::span<const io::PictureBody> atStart, const Vec3& gravity, const Camera& camera,
            const PaintSettings& settings)
      : settings_(settings), stage_(atStart, gravity, camera, settings.width, settings.height) {
    quality_.samples = settings.transparent ? std::max(2, settings.samples) : settings.samples;
    stage_.setting().background = settings.background;
    stage_.setting().transparent = settings.transparent;
  }

  io::Image paint(std::span<const io::PictureBody> bodies, const Camera& camera,
                  std::span<const Line> lines) override {
    stage_.renderer().setLines(lines);
    stage_.setBodies(bodies, settings_.colorBy, settings_.fullValue);
    return stage_.picture(camera, quality_);
  }
  std::vector<float> depths() const override { return stage_.renderer().readDepths(); }

 private:
  PaintSettings settings_;
  Stage stage_;
  Quality quality_;
};

class GlDevice final : public PaintDevice {
 public:
  std::unique_ptr<Painter> painter(std::span<const io::PictureBody> atStart, const Vec3& gravity,
                                   const Camera& camera, const PaintSettings& settings) override {
    return std::make_unique<GlPainter>(atStart, gravity, camera, settings);
  }
  std::string name() const override { return "OpenGL on " + context_.renderer(); }
  bool isSoftware() const override { return context_.isSoftware(); }

 private:
  HeadlessContext context_;
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
