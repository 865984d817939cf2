#pragma once
/// Mass, centre and inertia of solids: exact for polyhedra, summed for composites.
#include <array>
#include <span>

#include <rubble/scene.h>

namespace rubble {

/// Volume integrals at density 1 about the origin of some frame: m, the integral of x [m4] and of x x^T [m5]
/// (xx, yy, zz, xy, xz, yz).
struct SolidSums {
  double volume = 0;
  Vec3 first;
  std::array<double, 6> second{};

  SolidSums& operator+=(const SolidSums& b);
};

/// Of the tetrahedron (origin, a, b, c), negative if a, b, c are clockwise seen from outside. A closed
/// surface sums to its solid.
SolidSums tetrahedronSums(const Vec3& a, const Vec3& b, const Vec3& c);
/// Of a box about the origin.
SolidSums boxSums(const Vec3& halfExtents);
/// Of a body whose properties are known, in the frame of its shape.
SolidSums sumsOf(const MassProperties& mass);
/// The same solid after x -> position + rotate(q, x), `density` times as heavy.
SolidSums placed(const SolidSums& s, const Vec3& position, const Quat& q, double density);

/// Mass, centre, principal moments and axes. Axes of a frame that is principal already are kept as they are.
MassProperties principal(const SolidSums& s);

}  // namespace rubble
