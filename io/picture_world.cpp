#include <algorithm>
#include <cmath>

#include "cook/shape_traits.h"
#include "io/picture_values.h"

namespace rubble::io {
namespace {

/// Half extents of a box about the shape's origin, along its axes or within its bounding sphere [m]; 0 for a
/// plane.
Vec3 shapeExtent(const Shape& shape) {
  const double r = shape.radius, l = shape.halfLength;
  switch (shape.type) {
    case ShapeType::Box:
      return shape.halfExtents;
    case ShapeType::Sphere:
      return {r, 0, 0};
    case ShapeType::Capsule:
      return {0, 0, r + l};
    case ShapeType::Cylinder:
    case ShapeType::Cone:
      return {r, 0, l};
    case ShapeType::Plane:
      return {};
    default:
      break;
  }
  Vec3 far;
  const auto support = traitsOf(shape.type).support;
  for (int i = 0; i < 3 && support; ++i) {
    Vec3 axis;
    axis[i] = 1;
    far[i] = std::max(support(shape, axis)[i], -support(shape, -axis)[i]);
  }
  if (!shape.geometry) return far;
  const ShapeGeometry& g = *shape.geometry;
  const auto add = [&](const Vec3& p) {
    for (int i = 0; i < 3; ++i) far[i] = std::max(far[i], std::fabs(p[i]));
  };
  for (const Vec3& p : g.points) add(p);
  for (const ShapePartDef& part : g.parts) {
    const double reach = length(shapeExtent(part.shape));
    add(abs(part.position) + Vec3{reach, reach, reach});
  }
  if (shape.type == ShapeType::HeightField) {
    add({(g.counts[0] - 1) * g.spacing.x, (g.counts[1] - 1) * g.spacing.y, 0});
    for (const double h : g.samples) add({0, 0, h});
  }
  if (shape.type == ShapeType::DistanceField) {
    add(g.origin);
    add(g.origin + Vec3{(g.counts[0] - 1) * g.spacing.x, (g.counts[1] - 1) * g.spacing.y,
                        (g.counts[2] - 1) * g.spacing.z});
  }
  return far;
}

double halfSize(const Shape& shape) {
  const Vec3& h = shape.halfExtents;
  if (shape.type == ShapeType::Box) return std::cbrt(h.x * h.y * h.z);
  return shape.geometry ? .6 * boundingRadius(shape) : shape.radius;
}

}  // namespace

bool sameShape(const Shape& a, const Shape& b) {
  return a.type == b.type && a.halfExtents == b.halfExtents && a.radius == b.radius &&
         a.halfLength == b.halfLength && a.rounding == b.rounding && a.geometry == b.geometry;
}

double boundingRadius(const Shape& shape) { return length(shapeExtent(shape)); }

double extentAlong(const PictureBody& body, const Vec3& axis) {
  const Vec3 local = rotateInverse(body.orientation, axis);
  switch (body.shape.type) {
    case ShapeType::Box:
      return dot(abs(local), body.shape.halfExtents);
    case ShapeType::Sphere:
      return body.shape.radius;
    case ShapeType::Capsule:
      return body.shape.radius + body.shape.halfLength * std::fabs(local.z);
    case ShapeType::Cylinder:
    case ShapeType::Cone:
      return body.shape.radius * std::hypot(local.x, local.y) + body.shape.halfLength * std::fabs(local.z);
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
    if (body.deforms)
      objects.push_back(kOfObject * boundingRadius(body.shape));
    else
      sizes.push_back(halfSize(body.shape));
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
    bodies.push_back({definition.shape, state.position, state.orientation, length(state.velocity),
                      static_cast<std::uint32_t>(id.index), definition.motion});
    if (!values.empty()) bodies.back().value = values[bodies.size() - 1];
  }
  if (colorBy == ColorBy::Body) drawMachines(world, bodies);
  addDeformables(world, bodies, colorBy);
  addRopes(world, bodies);
  return bodies;
}

std::vector<PictureBody> pictureBodies(const Scene& scene, bool withEvents) {
  std::vector<PictureBody> bodies;
  const auto add = [&](const BodyDef& body) {
    bodies.push_back({body.shape, body.position, body.orientation, length(body.velocity),
                      static_cast<std::uint32_t>(bodies.size()), body.motion});
  };
  for (const BodyDef& body : scene.bodies) add(body);
  for (const Event& event : scene.events)
    for (const BodyDef& body : event.add)
      if (withEvents) add(body);
  addDeformables(scene, bodies);
  return bodies;
}

}  // namespace rubble::io
