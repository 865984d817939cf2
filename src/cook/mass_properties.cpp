#include <numbers>

#include "cook/cook.h"
#include "cook/shape_mesh.h"
#include "cook/solid_mass.h"

namespace rubble {

namespace {

constexpr double kPi = std::numbers::pi;

/// Mass properties of the solid inside a closed surface. `symmetric`: center and axes are those of the frame.
MassProperties ofSurface(const ShapeMesh& mesh, double density, bool symmetric) {
  SolidSums sums;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(t[k])]; };
    sums += tetrahedronSums(at(0), at(1), at(2));
  }
  if (symmetric) {
    sums.first = {};
    for (std::size_t i = 3; i < 6; ++i) sums.second[i] = 0;
  }
  return principal(placed(sums, {}, Quat{}, density));
}

MassProperties scaled(MassProperties m, double density) {
  m.mass *= density;
  m.inertia *= density;
  return m;
}

}  // namespace

MassProperties massProperties(const Shape& shape, double density) {
  // relative error 2e-3
  constexpr int kSegments = 96;
  const double r = shape.radius, l = shape.halfLength;
  switch (shape.type) {
    case ShapeType::Sphere: {
      const double m = density * 4 / 3 * kPi * r * r * r, i = .4 * m * r * r;
      return {m, {i, i, i}, {}, {}};
    }
    case ShapeType::Box: {
      if (shape.rounding > 0) return ofSurface(shapeMesh(shape, kSegments), density, true);
      const Vec3 h = shape.halfExtents;
      const double m = density * 8 * h.x * h.y * h.z;
      return {
          m,
          {m / 3 * (h.y * h.y + h.z * h.z), m / 3 * (h.x * h.x + h.z * h.z), m / 3 * (h.x * h.x + h.y * h.y)},
          {},
          {}};
    }
    case ShapeType::Capsule: {
      const double cylinder = density * kPi * r * r * 2 * l, sphere = density * 4 / 3 * kPi * r * r * r;
      // the center of mass of a hemisphere is 3/8 r beyond the end of the cylinder
      const double axial = cylinder * r * r / 2 + sphere * .4 * r * r;
      const double across = cylinder * (r * r / 4 + l * l / 3) + sphere * (.4 * r * r + l * l + .75 * l * r);
      return {cylinder + sphere, {across, across, axial}, {}, {}};
    }
    case ShapeType::Cylinder: {
      if (shape.rounding > 0) return ofSurface(shapeMesh(shape, kSegments), density, true);
      const double m = density * kPi * r * r * 2 * l, across = m * (r * r / 4 + l * l / 3);
      return {m, {across, across, m * r * r / 2}, {}, {}};
    }
    case ShapeType::Cone: {
      const double h = 2 * l, m = density * kPi * r * r * h / 3,
                   across = m * (3 * r * r / 20 + 3 * h * h / 80);
      return {m, {across, across, .3 * m * r * r}, {0, 0, h / 4 - l}, {}};
    }
    case ShapeType::Hull:
      if (shape.rounding > 0) return ofSurface(shapeMesh(shape, kSegments), density, false);
      return scaled(cook(shape).unit, density);
    case ShapeType::Compound:
    case ShapeType::DistanceField:
      return scaled(cook(shape).unit, density);
    case ShapeType::Plane:
    case ShapeType::Mesh:
    case ShapeType::HeightField:
      break;
  }
  return {};
}

}  // namespace rubble
