#include "io/picture_extent.h"

#include <algorithm>

namespace rubble::io::draw {

Range coreRange(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 200;
  const Range all{values.front(), values.back()};
  const Range core{values[cut], values[values.size() - 1 - cut]};
  constexpr double kFar = 2.5;
  return all.half() <= kFar * core.half() ? all : core;
}

double boundingRadius(const Shape& shape) {
  switch (shape.type) {
    case ShapeType::Box:
      return length(shape.halfExtents);
    case ShapeType::Sphere:
      return shape.radius;
    case ShapeType::Capsule:
      return shape.radius + shape.halfLength;
    case ShapeType::Plane:
      break;
  }
  return 0;
}

}  // namespace rubble::io::draw
