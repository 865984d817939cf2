#pragma once
/// The one way to a picture for programs: OpenGL where there is a context to be had, else the drawing on the CPU of io/picture.h.
#include <memory>
#include <span>
#include <string>

#include "io/picture.h"
#include "render/camera.h"
#include "render/overlay.h"

namespace rubble::render {

struct PaintSettings {
  int width = 1280, height = 720;
  int samples = 1;
  io::ColorBy colorBy = io::ColorBy::Body;
  double fullValue = 0;  ///< value of the hottest colour; 0: the largest one of each picture
};

/// Draws the pictures of one run. Colours and light are chosen from the scene as it begins.
class Painter {
 public:
  virtual ~Painter() = default;
  /// Throws Error for lines if it cannot draw them.
  virtual io::Image paint(std::span<const io::PictureBody> bodies, const Camera& camera, std::span<const Line> lines = {}) = 0;
};

/// What draws. Painters must not outlive it.
class PaintDevice {
 public:
  virtual ~PaintDevice() = default;
  virtual std::unique_ptr<Painter> painter(std::span<const io::PictureBody> atStart, const Vec3& gravity, const Camera& camera,
                                           const PaintSettings& settings) = 0;
  /// "OpenGL on NVIDIA H200", "OpenGL on llvmpipe (...)", "CPU pictures".
  virtual std::string name() const = 0;
  virtual bool isSoftware() const = 0;
};

/// `kind`: "gl", "cpu", or "auto" for the first that works. Throws Error if it is not to be had, or the kind is unknown.
std::unique_ptr<PaintDevice> makePaintDevice(const std::string& kind);

/// What this build can draw, for listings: "on: OpenGL through EGL", "off: built without libepoxy or EGL".
std::string openglStatus();

}  // namespace rubble::render
