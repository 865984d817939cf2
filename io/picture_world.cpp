#include <algorithm>
#include <array>
#include <cmath>

#include "io/picture_extent.h"
#include "io/picture_values.h"

namespace rubble::io {
namespace {

/// Room left around the bodies.
constexpr double kMargin = 1.12;

using namespace draw;

Range rangeAlong(std::span<const PictureBody> bodies, const Vec3& axis) {
  std::vector<double> lows, highs;
  for (const bool onlyMoving : {true, false}) {
    for (const PictureBody& body : bodies) {
      if (body.shape.type == ShapeType::Plane || (onlyMoving && body.motion == Motion::Static)) continue;
      const double at = dot(axis, body.position), extent = extentAlong(body, axis);
      if (!std::isfinite(at + extent)) continue;
      lows.push_back(at - extent);
      highs.push_back(at + extent);
    }
    if (!lows.empty()) break;
  }
  if (lows.empty()) return {-1, 1};
  return {coreRange(std::move(lows)).low, coreRange(std::move(highs)).high};
}

double halfSize(const Shape& shape) {
  const Vec3& h = shape.halfExtents;
  if (shape.type == ShapeType::Box) return std::cbrt(h.x * h.y * h.z);
  return shape.geometry ? .6 * boundingRadius(shape) : shape.radius;
}

}  // namespace

double extentAlong(const PictureBody& body, const Vec3& axis) {
  const Vec3 local = rotateInverse(body.orientation, axis);
  switch (body.shape.type) {
    case ShapeType::Box:
      return dot(abs(local), body.shape.halfExtents);
    case ShapeType::Sphere:
      return body.shape.radius;
    case ShapeType::Capsule:
      return body.shape.radius + body.shape.halfLength * std::fabs(local.z);
    case ShapeType::Plane:
      return 0;
    default:
      break;
  }
  return dot(abs(local), shapeExtent(body.shape));
}

double typicalSize(std::span<const PictureBody> bodies) {
  constexpr double kOfObject = .1;
  std::vector<double> sizes, objects;
  for (const PictureBody& body : bodies) {
    if (body.shape.type == ShapeType::Plane || body.motion == Motion::Static) continue;
    if (body.deforms) objects.push_back(kOfObject * boundingRadius(body.shape));
    else sizes.push_back(halfSize(body.shape));
  }
  if (sizes.empty()) sizes = std::move(objects);
  if (sizes.empty()) return 1;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return std::max(1e-6, *middle);
}

std::vector<PictureBody> pictureBodies(const World& world, ColorBy colorBy) {
  std::vector<PictureBody> bodies;
  const std::vector<double> values = bodyValues(world, colorBy);
  for (const BodyId id : world.bodies()) {
    const BodyDef& definition = world.definition(id);
    const BodyState state = world.state(id);
    bodies.push_back({definition.shape, state.position, state.orientation, length(state.velocity), static_cast<std::uint32_t>(id.index),
                      definition.motion});
    if (!values.empty()) bodies.back().value = values[bodies.size() - 1];
  }
  addDeformables(world, bodies, colorBy);
  addRopes(world, bodies);
  return bodies;
}

std::vector<PictureBody> pictureBodies(const Scene& scene, bool withEvents) {
  std::vector<PictureBody> bodies;
  const auto add = [&](const BodyDef& body) {
    bodies.push_back(
        {body.shape, body.position, body.orientation, length(body.velocity), static_cast<std::uint32_t>(bodies.size()), body.motion});
  };
  for (const BodyDef& body : scene.bodies) add(body);
  for (const Event& event : scene.events)
    for (const BodyDef& body : event.add)
      if (withEvents) add(body);
  addDeformables(scene, bodies);
  return bodies;
}

void frameBodies(std::span<const PictureBody> bodies, const Vec3& gravity, PictureSettings& settings, const Framing& framing) {
  const Vec3 up = normalize(-gravity, {0, 0, 1});
  Vec3 right = normalize(std::fabs(up.x) < .9 ? Vec3{1, 0, 0} - up * up.x : Vec3{0, 1, 0} - up * up.y);
  Vec3 away = cross(up, right);
  if (rangeAlong(bodies, away).half() > rangeAlong(bodies, right).half()) {
    // Look along the thin side.
    const Vec3 turned = away;
    away = -right;
    right = turned;
  }
  const std::array<Vec3, 3> axes{right, away, up};
  std::array<Range, 3> ranges;
  for (std::size_t i = 0; i < 3; ++i) ranges[i] = rangeAlong(bodies, axes[i]);
  for (std::size_t i = 0; i < 2; ++i) {
    const double room = 2 * framing.spread * ranges[2].half();
    ranges[i] = {ranges[i].low - room, ranges[i].high + room};
  }
  settings.up = up;
  settings.target = axes[0] * ranges[0].middle() + axes[1] * ranges[1].middle() + axes[2] * ranges[2].middle();

  const Vec3 forward = normalize(framing.direction, normalize(away - right * .55 - up * .42));
  const Vec3 cameraRight = normalize(cross(forward, up), right);
  const Vec3 cameraUp = cross(cameraRight, forward);
  const double tall = std::tan(settings.fieldOfView / 2), wide = tall * settings.width / settings.height;
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      p += axes[k] * ((corner >> i & 1) ? ranges[k].half() : -ranges[k].half());
    }
    const double behind = -dot(p, forward);
    distance = std::max(
        {distance, kMargin * std::fabs(dot(p, cameraRight)) / wide + behind, kMargin * std::fabs(dot(p, cameraUp)) / tall + behind});
  }
  settings.eye = settings.target - forward * std::max(distance, 1e-3);
}

}  // namespace rubble::io
