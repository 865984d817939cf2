#pragma once
/// Frames of bodies in, pictures out: keeps the renderer's bodies in step with a simulation or a recording.
#include <memory>
#include <string>

#include "io/look_table.h"
#include "render/palette.h"
#include "render/renderer.h"
#include "render/shape_meshes.h"

namespace rubble::render {

class Stage {
 public:
  /// `bodies` is the scene as it begins: light, colors and scale are taken from it and from the first
  /// camera, unless `appearance` says otherwise.
  Stage(std::span<const io::PictureBody> bodies, const Vec3& gravity, const Camera& camera, int width,
        int height, const Appearance& appearance = {});

  /// Bodies as they are now. Those that keep their key keep their color. `fullValue` has the hottest color;
  /// 0: the largest one of these.
  void setBodies(std::span<const io::PictureBody> bodies, io::ColorBy colorBy = io::ColorBy::Body,
                 double fullValue = 0);
  /// Bodies of a world as they are now, in their own colors. While none come or go and nothing deforms,
  /// poses go straight from the world's arrays to the GPU, on the device where that is possible.
  void follow(World& world);
  /// How the last follow() had its poses: "on the device", "from the host's arrays", "body by body (...)".
  const std::string& posesFrom() const { return posesFrom_; }
  io::Image picture(const Camera& camera, const Quality& quality);

  /// Keys of the bodies and of the deforming surfaces as they are drawn, in the order that the renderer names
  /// them in.
  const std::vector<std::uint32_t>& keys() const { return keys_; }
  const std::vector<std::uint32_t>& surfaceKeys() const { return surfaceKeys_; }

  Renderer& renderer() { return renderer_; }
  const Renderer& renderer() const { return renderer_; }
  Setting& setting() { return setting_; }
  const Setting& setting() const { return setting_; }
  /// What the hottest color stands for in the last picture.
  double fullValue() const { return fullValue_; }

 private:
  bool sameBodies(std::span<const io::PictureBody> bodies) const;
  void setParts(std::span<const io::PictureBody> all, io::ColorBy colorBy, double fullValue);
  void setLight(const Appearance& appearance, const Camera& camera);
  void setSurfaces(std::span<const io::PictureBody> bodies, io::ColorBy colorBy, double fullValue);

  Palette palette_;
  io::LookTable looks_;
  Renderer renderer_;
  ShapeMeshes meshes_;
  Setting setting_;
  std::vector<std::uint32_t> keys_, surfaceKeys_;
  std::vector<Shape> shapes_;
  std::vector<Pose> poses_;
  bool hasSurfaces_ = false;
  io::ColorBy coloredBy_ = io::ColorBy::Body;
  double fullValue_ = 0;

  struct Followed;
  void learn(World& world);
  std::shared_ptr<Followed> followed_;
  std::string posesFrom_;
  int bodiesSet_ = 0;  ///< calls of setBodies
};

/// Direction to the sun: high, over the left shoulder of whoever looks through the camera.
Vec3 sunFor(const Camera& camera, const Vec3& up);

}  // namespace rubble::render
