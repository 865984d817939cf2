#pragma once
/// Frames of bodies in, pictures out: keeps the renderer's bodies in step with a simulation or a recording.
#include <optional>

#include "render/palette.h"
#include "render/renderer.h"
#include "render/shape_meshes.h"

namespace rubble::render {

class Stage {
 public:
  /// `bodies` is the scene as it begins: light, colours and scale are taken from it and from the first camera.
  Stage(std::span<const io::PictureBody> bodies, const Vec3& gravity, const Camera& camera, int width, int height);

  /// Bodies as they are now. Those that keep their key keep their colour.
  void setBodies(std::span<const io::PictureBody> bodies, io::ColorBy colorBy = io::ColorBy::Body, double fullSpeed = 0);
  io::Image picture(const Camera& camera, const Quality& quality);

  Renderer& renderer() { return renderer_; }
  const Setting& setting() const { return setting_; }

 private:
  bool sameBodies(std::span<const io::PictureBody> bodies) const;
  void setSurfaces(std::span<const io::PictureBody> bodies, io::ColorBy colorBy, double fullSpeed);

  Palette palette_;
  Renderer renderer_;
  ShapeMeshes meshes_;
  Setting setting_;
  std::vector<std::uint32_t> keys_;
  std::vector<Shape> shapes_;
  std::vector<Pose> poses_;
  bool hasSurfaces_ = false;
};

/// Direction to the sun: high, over the left shoulder of whoever looks through the camera.
Vec3 sunFor(const Camera& camera, const Vec3& up);

}  // namespace rubble::render
