#include "apps/viewer/thumbnails.h"

#include "render/framing.h"
#include "render/stage.h"
#include "scenes/registry.h"

namespace rubble::viewer {
namespace {

/// A scene is drawn after it has been looked at for so long [s].
constexpr double kPatience = 0.15;
/// Room around the bodies [1], and the vertical angle of view [rad].
constexpr double kRoom = 0.1, kFieldOfView = 0.5;

}  // namespace

io::Image thumbnailOf(const std::string& scene, int width, int height) {
  const scenes::Spec& spec = scenes::find(scene);
  const scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
  const std::vector<io::PictureBody> bodies = io::pictureBodies(job.scene);
  const double aspect = static_cast<double>(width) / height;
  const render::Camera camera = render::cameraShowing(
      bodies, job.scene.gravity, {job.camera.target - job.camera.eye, kRoom, aspect, kFieldOfView});
  render::Stage stage(bodies, job.scene.gravity, camera, width, height, job.appearance);
  stage.setBodies(bodies);
  constexpr render::Quality kQuick{1, 1024, 2, 4};
  return stage.picture(camera, kQuick);
}

GLuint Thumbnails::of(const std::string& scene, double now) {
  if (const auto found = drawn_.find(scene); found != drawn_.end())
    return found->second ? found->second->id() : 0;
  if (scene != asked_) asked_ = scene, since_ = now;
  if (now - since_ < kPatience) return 0;
  std::unique_ptr<render::gl::Texture>& texture = drawn_[scene];  // null if it cannot be drawn
  const io::Image image = thumbnailOf(scene, kWidth, kHeight);
  texture = std::make_unique<render::gl::Texture>(kWidth, kHeight, GL_RGBA8, GL_LINEAR);
  glBindTexture(GL_TEXTURE_2D, texture->id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kWidth, kHeight, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
  return texture->id();
}

}  // namespace rubble::viewer
