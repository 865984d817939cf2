#include "render/painter.h"

#include <rubble/error.h>

#if defined(RUBBLE_HAS_GL)
#include "render/headless.h"
#include "render/stage.h"
#endif

namespace rubble::render {
namespace {

class CpuPainter final : public Painter {
 public:
  explicit CpuPainter(const PaintSettings& settings) : settings_(settings) {}

  io::Image paint(std::span<const io::PictureBody> bodies, const Camera& camera, std::span<const Line> lines) override {
    if (!lines.empty()) throw Error("--show", "the renderer gl", "cpu");
    io::PictureSettings s;
    s.width = settings_.width;
    s.height = settings_.height;
    s.colorBy = settings_.colorBy;
    s.fullValue = settings_.fullValue;
    s.eye = camera.eye;
    s.target = camera.target;
    s.up = camera.up;
    s.fieldOfView = camera.fieldOfView;
    return io::drawPicture(bodies, s);
  }

 private:
  PaintSettings settings_;
};

class CpuDevice final : public PaintDevice {
 public:
  std::unique_ptr<Painter> painter(std::span<const io::PictureBody>, const Vec3&, const Camera&, const PaintSettings& settings) override {
    return std::make_unique<CpuPainter>(settings);
  }
  std::string name() const override { return "CPU pictures"; }
  bool isSoftware() const override { return true; }
};

#if defined(RUBBLE_HAS_GL)
class GlPainter final : public Painter {
 public:
  GlPainter(std::span<const io::PictureBody> atStart, const Vec3& gravity, const Camera& camera, const PaintSettings& settings)
      : settings_(settings), stage_(atStart, gravity, camera, settings.width, settings.height) {
    quality_.samples = settings.samples;
  }

  io::Image paint(std::span<const io::PictureBody> bodies, const Camera& camera, std::span<const Line> lines) override {
    stage_.renderer().setLines(lines);
    stage_.setBodies(bodies, settings_.colorBy, settings_.fullValue);
    return stage_.picture(camera, quality_);
  }

 private:
  PaintSettings settings_;
  Stage stage_;
  Quality quality_;
};

class GlDevice final : public PaintDevice {
 public:
  std::unique_ptr<Painter> painter(std::span<const io::PictureBody> atStart, const Vec3& gravity, const Camera& camera,
                                   const PaintSettings& settings) override {
    return std::make_unique<GlPainter>(atStart, gravity, camera, settings);
  }
  std::string name() const override { return "OpenGL on " + context_.renderer(); }
  bool isSoftware() const override { return context_.isSoftware(); }

 private:
  HeadlessContext context_;
};
#endif

}  // namespace

std::unique_ptr<PaintDevice> makePaintDevice(const std::string& kind) {
  if (kind == "cpu") return std::make_unique<CpuDevice>();
  if (kind != "gl" && kind != "auto") throw Error("--renderer", "gl, cpu or auto", kind);
#if defined(RUBBLE_HAS_GL)
  try {
    return std::make_unique<GlDevice>();
  } catch (const Error&) {
    if (kind == "gl") throw;
  }
#else
  if (kind == "gl")
    throw Error("--renderer", "a build with libepoxy and EGL (Debian: apt-get install libepoxy-dev libegl-dev)", "one without");
#endif
  return std::make_unique<CpuDevice>();
}

std::string openglStatus() {
#if defined(RUBBLE_HAS_GL)
  return "on: OpenGL through EGL";
#else
  return "off: built without libepoxy or EGL";
#endif
}

}  // namespace rubble::render
