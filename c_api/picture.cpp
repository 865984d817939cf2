#include <rubble/c/recording.h>

#include <dlfcn.h>

#include "c_api/handles.h"
#include "c_api/recorded.h"
#include "io/definition_json.h"
#include "io/picture_values.h"
#include "render/framing.h"
#include "render/painter.h"

using namespace rubble;
using namespace rubble::c;

namespace {

/// Smooth edges at a cost that interactive use can bear: with a GPU, and in software.
constexpr int kSamplesGpu = 16, kSamplesSoftware = 4;

render::PaintSettings settingsOf(const std::string& text) {
  render::PaintSettings out;
  out.samples = 0;
  io::readDefinition(text, "options", [&](const io::Node& node) {
    io::ObjectReader object(node, "an object with options of a picture");
    const auto count = [&](const char* key, int& value) {
      if (const auto found = object.get(key))
        value = found->whole(1, "a whole number above 0").value_or(value);
    };
    count("width", out.width), count("height", out.height), count("samples", out.samples);
    if (const auto found = object.get("color_by"))
      if (const auto name = found->text()) out.colorBy = io::colorByNamed(*name);
    object.read("full_value", out.fullValue);
    object.finish();
  });
  return out;
}

/// libepoxy ends the process where it does not find EGL.
void requireEgl() {
#ifdef RUBBLE_HAS_GL
  void* const egl = dlopen("libEGL.so.1", RTLD_LAZY | RTLD_LOCAL);
  if (!egl) throw Error("render", "libEGL.so.1 (Debian: apt-get install libegl1 libgl1-mesa-dri)", "none");
  dlclose(egl);
#endif
}

}  // namespace

struct rb_painter {
  render::PaintSettings settings;
  std::unique_ptr<render::PaintDevice> device;
  std::unique_ptr<render::Painter> painter;  ///< made with the first picture, which colors are taken from
  io::Image image = {};

  void draw(const std::vector<io::PictureBody>& bodies, const Vec3& gravity, const Appearance& appearance,
            const rb_camera* view, rb_image* out) {
    render::Camera camera = cameraFor(bodies, gravity, view);
    if (!painter)
      settings.appearance = appearance, painter = device->painter(bodies, gravity, camera, settings);
    image = painter->paint(bodies, camera);
    need(out, "image") = {image.width, image.height, image.rgb.data()};
  }

  render::Camera cameraFor(const std::vector<io::PictureBody>& bodies, const Vec3& gravity,
                           const rb_camera* view) const {
    render::Framing framing;
    framing.aspect = static_cast<double>(settings.width) / settings.height;
    if (view) framing.fieldOfView = view->field_of_view;
    render::Camera camera = render::cameraShowing(bodies, gravity, framing);
    if (view) camera.eye = vec(view->eye), camera.target = vec(view->target);
    return camera;
  }
};

extern "C" {

rb_status rb_painter_create(const char* options, rb_painter** painter) {
  return guarded([&] {
    render::PaintSettings settings = settingsOf(textOr(options, "{}"));
    requireEgl();
    auto device = render::makePaintDevice();
    if (settings.samples == 0) settings.samples = device->isSoftware() ? kSamplesSoftware : kSamplesGpu;
    need(painter, "painter") = new rb_painter{settings, std::move(device), nullptr};
  });
}

void rb_painter_destroy(rb_painter* painter) { delete painter; }

rb_status rb_painter_draw_world(rb_painter* painter, const rb_world* world, const rb_camera* camera,
                                rb_image* image) {
  return guarded([&] {
    rb_painter& by = need(painter, "painter");
    const World& drawn = worldOf(world);
    by.draw(io::pictureBodies(drawn, by.settings.colorBy), drawn.gravity(), world->appearance, camera, image);
  });
}

rb_status rb_painter_draw_frame(rb_painter* painter, rb_recording* recording, int64_t index,
                                const rb_camera* camera, rb_image* image) {
  return guarded([&] {
    rb_painter& by = need(painter, "painter");
    io::RecordingReader& reader = need(recording, "recording").reader;
    by.draw(io::pictureBodies(reader, frameIndex(reader, index)), reader.header().gravity,
            reader.header().appearance, camera, image);
  });
}

rb_status rb_write_png(const char* file, const uint8_t* rgb, int32_t width, int32_t height) {
  return guarded([&] {
    if (width < 1 || height < 1) throw Error("size", "a width and a height above 0", "others");
    const std::size_t bytes = std::size_t{3} * static_cast<std::size_t>(width) *
                              static_cast<std::size_t>(height);
    need(rgb, "rgb");
    io::writePng({width, height, {rgb, rgb + bytes}}, textOr(file, ""));
  });
}
}
