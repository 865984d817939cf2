#pragma once
/// The surface of a shape as triangles, for pictures, viewers and exports: the one place where shapes are
/// triangulated.
#include <array>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

/// Corners have a place and a normal each; those of a sharp edge occur once for each of its faces. Frame of
/// the author.
struct ShapeMesh {
  std::vector<Vec3> points;                   ///< [m]
  std::vector<Vec3> normals;                  ///< outward, unit
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
};

/// `segments`: of a full circle. A plane has none. Throws Error for geometry that nothing can be made of.
ShapeMesh shapeMesh(const Shape& shape, int segments = 48);

}  // namespace rubble
