#include <numbers>

#include <rubble/scene.h>

namespace rubble {

MassProperties massProperties(const Shape& shape, double density) {
  constexpr double kPi = std::numbers::pi;
  switch (shape.type) {
    case ShapeType::Sphere: {
      const double r = shape.radius, m = density * 4 / 3 * kPi * r * r * r, i = .4 * m * r * r;
      return {m, {i, i, i}};
    }
    case ShapeType::Box: {
      const Vec3 h = shape.halfExtents;
      const double m = density * 8 * h.x * h.y * h.z;
      return {m, {m / 3 * (h.y * h.y + h.z * h.z), m / 3 * (h.x * h.x + h.z * h.z), m / 3 * (h.x * h.x + h.y * h.y)}};
    }
    case ShapeType::Capsule: {
      const double r = shape.radius, l = shape.halfLength;
      const double cylinder = density * kPi * r * r * 2 * l, sphere = density * 4 / 3 * kPi * r * r * r;
      // each half sphere has its centre of mass 3/8 r beyond the end of the cylinder
      const double axial = cylinder * r * r / 2 + sphere * .4 * r * r;
      const double across = cylinder * (r * r / 4 + l * l / 3) + sphere * (.4 * r * r + l * l + .75 * l * r);
      return {cylinder + sphere, {across, across, axial}};
    }
    case ShapeType::Plane: break;
  }
  return {};
}

}  // namespace rubble
