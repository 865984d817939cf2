#pragma once
/// Shapes that several bodies have, each once.
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <rubble/scene.h>

namespace rubble::convert {

/// A shape, and three factors on its local axes. Boxes and spheres are those of size 1 times their size.
struct Prototype {
  Shape shape;
  Vec3 scale{1, 1, 1};
};
inline Prototype prototypeOf(const Shape& shape) {
  if (shape.type == ShapeType::Box && shape.rounding == 0) return {Shape::box({1, 1, 1}), shape.halfExtents};
  if (shape.type == ShapeType::Sphere) return {Shape::sphere(1), Vec3{1, 1, 1} * shape.radius};
  return {shape, {1, 1, 1}};
}

/// Numbers shapes in the order in which they come; equal ones have one number.
class ShapeNumbers {
 public:
  /// The number, and whether it is new.
  std::pair<int, bool> of(const Shape& s) {
    const auto [at, isNew] = numbers_.try_emplace({s.type, s.halfExtents.x, s.halfExtents.y, s.halfExtents.z,
                                                   s.radius, s.halfLength, s.rounding, s.geometry.get()},
                                                  static_cast<int>(numbers_.size()));
    return {at->second, isNew};
  }

 private:
  using Key = std::tuple<ShapeType, double, double, double, double, double, double, const ShapeGeometry*>;
  std::map<Key, int> numbers_;
};

}  // namespace rubble::convert
