#pragma once
/// Pictures without a display. Every build has this interface. One without the renderer refuses to make the
/// device.
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <rubble/appearance.h>

#include "io/picture.h"
#include "render/camera.h"
#include "render/overlay.h"

namespace rubble::render {

struct PaintSettings {
  int width = 1280, height = 720;
  int samples = 1;
  io::ColorBy colorBy = io::ColorBy::Body;
  double fullValue = 0;  ///< value of the hottest color; 0: the largest one of each picture
  /// As in Setting.
  std::optional<Vec3f> background = {};
  bool transparent = false;
  /// Direction of the sun: angle about up, from the right of the first camera, and height above the horizon
  /// [rad]. Otherwise the light is chosen for that camera.
  std::optional<std::array<double, 2>> sun = {};
  Appearance appearance = {};  ///< of the scene
};

/// Draws the pictures of one run. Colors and light are chosen from the scene as it begins. There may be
/// several at once, each used by one thread at a time. A call leaves the OpenGL context of its thread as it
/// was.
class Painter {
 public:
  virtual ~Painter() = default;
  virtual io::Image paint(std::span<const io::PictureBody> bodies, const Camera& camera,
                          std::span<const Line> lines = {}) = 0;
  /// View depth of each pixel of the last picture, rows from the top [m]; infinity in the sky.
  virtual std::vector<float> depths() const = 0;
  /// Its unit normals, three numbers in world axes a pixel; 0 in the sky.
  virtual std::vector<float> normals() const = 0;
};

/// What draws. Painters may outlive it. It draws for one thread at a time.
class PaintDevice {
 public:
  virtual ~PaintDevice() = default;
  virtual std::unique_ptr<Painter> painter(std::span<const io::PictureBody> atStart, const Vec3& gravity,
                                           const Camera& camera, const PaintSettings& settings) = 0;
  /// "OpenGL on NVIDIA H200", "OpenGL on llvmpipe (...)".
  virtual std::string name() const = 0;
  virtual bool isSoftware() const = 0;
};

/// OpenGL without a display. Throws Error with the names of the packages that are missing if the build or the
/// machine has none.
std::unique_ptr<PaintDevice> makePaintDevice();

/// What this build can draw, for listings: "on: OpenGL through EGL", or "off: ..." with the reason.
std::string openglStatus();
/// Captions and plots: "on", or "off: built without Cairo".
std::string cairoStatus();

}  // namespace rubble::render
