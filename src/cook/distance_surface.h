#pragma once
/// Signed distances at the points of a lattice: value and surface.
#include "cook/shape_mesh.h"

namespace rubble {

/// The distance at a point by linear interpolation in its cell; outside of the lattice that of the nearest
/// point of it. [m]
double distanceAt(const ShapeGeometry& field, const Vec3& point);
/// Its gradient, unit.
Vec3 distanceNormal(const ShapeGeometry& field, const Vec3& point);

/// The surface of distance 0, a corner for each cell that it passes through (surface nets, Gibson 1998),
/// moved onto the surface.
ShapeMesh distanceSurface(const ShapeGeometry& field);

}  // namespace rubble
