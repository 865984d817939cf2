#include "io/picture_extent.h"

#include <algorithm>
#include <cmath>

namespace rubble::io::draw {

Range coreRange(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 200;
  const Range all{values.front(), values.back()};
  const Range core{values[cut], values[values.size() - 1 - cut]};
  constexpr double kFar = 2.5;
  return all.half() <= kFar * core.half() ? all : core;
}

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
  if (!shape.geometry) return {};
  const ShapeGeometry& g = *shape.geometry;
  Vec3 far;
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
    add(g.origin + Vec3{(g.counts[0] - 1) * g.spacing.x, (g.counts[1] - 1) * g.spacing.y, (g.counts[2] - 1) * g.spacing.z});
  }
  return far;
}

double boundingRadius(const Shape& shape) {
  const Vec3 far = shapeExtent(shape);
  return length(far);
}

}  // namespace rubble::io::draw
