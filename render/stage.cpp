#include "render/stage.h"

#include <algorithm>
#include <cmath>

#include "io/picture_values.h"

namespace rubble::render {
namespace {

Pose poseOf(const io::PictureBody& body, const Vec3& origin) {
  const Vec3f p(body.position - origin);
  const QuatT<float> q(body.orientation);
  return {p.x, p.y, p.z, 0, q.v.x, q.v.y, q.v.z, q.s};
}

}  // namespace

Vec3 sunFor(const Camera& camera, const Vec3& up) {
  const Vec3 ahead = camera.target - camera.eye;
  const Vec3 level = ahead - up * dot(ahead, up);
  const Vec3 back = -normalize(level, cross(up, normalize(cross(Vec3{0, 1, 0}, up), {1, 0, 0})));
  const Vec3 right = cross(up, back);
  return normalize(up * .92 - right * .80 + back * .30);
}

Stage::Stage(std::span<const io::PictureBody> bodies, const Vec3& gravity, const Camera& camera, int width,
             int height, const Appearance& appearance)
    : palette_(bodies, normalize(-gravity, {0, 0, 1})),
      looks_(appearance.looks, bodies),
      renderer_(width, height) {
  setting_.up = normalize(-gravity, {0, 0, 1});
  setLight(appearance, camera);
  setting_.bodySize = palette_.bodySize();
  setting_.sceneSize = length(camera.target - camera.eye);
  renderer_.setOrigin(camera.target);
  setBodies(bodies);
}

void Stage::setLight(const Appearance& appearance, const Camera& camera) {
  const Daylight& day = appearance.daylight;
  setting_.toSun = day.toSun ? *day.toSun : sunFor(camera, setting_.up);
  setting_.sunlight = linearColor(Vec3f(day.sunColor)) * static_cast<float>(day.sunStrength);
  setting_.skylight = day.skyStrength;
  setting_.lamps.clear();
  for (const PointLight& light : appearance.lights)
    setting_.lamps.push_back(
        {light.position, linearColor(Vec3f(light.color)) * static_cast<float>(light.intensity)});
}

bool Stage::sameBodies(std::span<const io::PictureBody> bodies) const {
  if (bodies.size() != keys_.size()) return false;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].key != keys_[i] || !io::sameShape(bodies[i].shape, shapes_[i])) return false;
  return true;
}

void Stage::setSurfaces(std::span<const io::PictureBody> bodies, io::ColorBy colorBy, double fullValue) {
  std::vector<Surface> surfaces;
  surfaceKeys_.clear();
  for (const io::PictureBody& body : bodies) {
    const ShapeGeometry& g = *body.shape.geometry;
    Surface& surface = surfaces.emplace_back();
    surfaceKeys_.push_back(body.key);
    const Vec3 from = body.position - renderer_.origin();
    for (const Vec3& p : g.points) surface.vertices.emplace_back(from + p);
    for (const auto& t : g.triangles)
      surface.triangles.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                                   static_cast<std::uint32_t>(t[2])});
    surface.color = colorBy == io::ColorBy::Body
                        ? palette_.softColor(body.key)
                        : valueColor(io::shownValue(body, colorBy), colorBy, fullValue);
    if (colorBy != io::ColorBy::Body && !io::quantity(colorBy).isKind && fullValue > 0)
      for (const float value : body.vertexValues)
        surface.heat.push_back(static_cast<float>(value / fullValue));
    surface.finish = g.twoSided ? Finish::Cloth : Finish::Plastic;
  }
  if (hasSurfaces_ || !surfaces.empty()) renderer_.setSurfaces(surfaces);
  hasSurfaces_ = !surfaces.empty();
}

void Stage::setBodies(std::span<const io::PictureBody> bodies, io::ColorBy colorBy, double fullValue) {
  if (looks_.empty()) return setParts(bodies, colorBy, fullValue);
  setParts(looks_.applied(bodies), colorBy, fullValue);
}

void Stage::setParts(std::span<const io::PictureBody> all, io::ColorBy colorBy, double fullValue) {
  ++bodiesSet_;
  if (fullValue <= 0) fullValue = io::largestValue(all, colorBy);
  fullValue_ = fullValue;
  const auto firstSurface = std::find_if(all.begin(), all.end(),
                                         [](const io::PictureBody& body) { return body.deforms; });
  const std::span<const io::PictureBody> bodies(all.begin(), firstSurface);
  if (!sameBodies(bodies) || keys_.empty()) {
    std::vector<BodyLook> looks;
    keys_.clear();
    shapes_.clear();
    for (const io::PictureBody& body : bodies) {
      looks.push_back(meshes_.withMesh(renderer_.bodies(), palette_.look(body), body.shape));
      keys_.push_back(body.key);
      shapes_.push_back(body.shape);
    }
    renderer_.bodies().setLooks(looks);
  }
  if (colorBy != io::ColorBy::Body || coloredBy_ != colorBy) {
    std::vector<Vec3f> colors;
    for (const io::PictureBody& body : bodies) {
      const bool own = colorBy == io::ColorBy::Body || body.motion == Motion::Static ||
                       body.shape.type == ShapeType::Plane;
      colors.push_back(own ? palette_.look(body).color
                           : valueColor(io::shownValue(body, colorBy), colorBy, fullValue));
    }
    renderer_.bodies().setColors(colors);
  }
  coloredBy_ = colorBy;
  setSurfaces({firstSurface, all.end()}, colorBy, fullValue);
  poses_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) poses_[i] = poseOf(bodies[i], renderer_.origin());
  renderer_.bodies().setPoses(poses_);
}

io::Image Stage::picture(const Camera& camera, const Quality& quality) {
  renderer_.draw(camera, setting_, quality);
  return renderer_.read();
}

}  // namespace rubble::render
