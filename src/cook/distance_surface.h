#pragma once
/// Signed distance fields on a lattice: interpolation and surface extraction.
#include <rubble/mesh.h>

namespace rubble {

/// Trilinear interpolation at a point. Points outside are clamped to the lattice. [m]
double distanceAt(const ShapeGeometry& field, const Vec3& point);
/// Unit gradient at a point.
Vec3 distanceNormal(const ShapeGeometry& field, const Vec3& point);

/// The zero surface by surface nets (Gibson 1998): one vertex per cell that it crosses, projected onto the
/// surface.
ShapeMesh distanceSurface(const ShapeGeometry& field);

}  // namespace rubble
