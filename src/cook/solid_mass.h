#pragma once
/// Mass, center of mass and inertia of solids: exact for polyhedra, summed for compounds.
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

/// Of the tetrahedron (origin, a, b, c). Negative if a, b, c are clockwise seen from outside. The triangles
/// of a closed surface sum to its solid.
SolidSums tetrahedronSums(const Vec3& a, const Vec3& b, const Vec3& c);
/// Of a box about the origin.
SolidSums boxSums(const Vec3& halfExtents);
/// Of a body with known mass properties, in its shape frame.
SolidSums sumsOf(const MassProperties& mass);
/// The solid transformed by x -> position + rotate(q, x), with its density scaled by `density`.
SolidSums placed(const SolidSums& s, const Vec3& position, const Quat& q, double density);

/// Mass, center of mass, principal moments and axes. Axes of a frame that is already principal are kept.
MassProperties principal(const SolidSums& s);

}  // namespace rubble
