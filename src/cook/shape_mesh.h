#pragma once
/// Triangulation of shape surfaces, for rendering and export.
#include <array>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

/// Corners have a position and a normal. A corner at a sharp edge occurs once per face. Authored frame.
struct ShapeMesh {
  std::vector<Vec3> points;                   ///< [m]
  std::vector<Vec3> normals;                  ///< outward, unit
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
};

/// `segments`: per full circle. A plane has no triangles. Throws Error for degenerate geometry.
ShapeMesh shapeMesh(const Shape& shape, int segments = 48);

}  // namespace rubble
