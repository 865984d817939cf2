#pragma once
/// Mass of polyhedra, and of rounded ones, in closed form.
#include "cook/hull.h"
#include "cook/solid_mass.h"

namespace rubble {

SolidSums polyhedronSums(const Hull& hull);
/// Of a convex polyhedron with a layer of thickness `radius` around it: the points within that distance.
SolidSums roundedSums(const Hull& core, double radius);
/// A box about the origin as a polyhedron.
Hull boxHull(const Vec3& halfExtents);

}  // namespace rubble
