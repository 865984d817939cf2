#pragma once
#include <vector>

#include <rubble/scene.h>

namespace rubble::io::draw {

struct Range {
  double low = 0, high = 0;
  double middle() const { return (low + high) / 2; }
  double half() const { return (high - low) / 2; }
};

/// The range of the values; without their outermost half percent at each end if those lie far out: one brick that flew away must not
/// shrink all the others. `values` is not empty.
Range coreRange(std::vector<double> values);

/// Half extents of a box about the shape's origin, along its axes or within its bounding sphere [m]; 0 for a plane.
Vec3 shapeExtent(const Shape& shape);

/// Radius of a sphere about a shape's origin that holds it [m]; 0 for a plane.
double boundingRadius(const Shape& shape);

}  // namespace rubble::io::draw
