#pragma once
/// Shapes as the solver keeps them, and what a pair test gives.
#include "math/sym.h"
#include "solver/pose_algebra.h"

namespace rubble::RUBBLE_CORE {

/// Kinds up to Plane are plain: their pairs have one manifold each, tested by the fast kernel. The others
/// keep data in shared tables.
enum class ShapeKind : int {
  Sphere,
  Capsule,
  Box,
  Plane,
  RoundBox,
  Cylinder,
  Cone,
  Hull,
  Triangle,
  Compound,
  Mesh,
  HeightField,
  Distance
};

/// A shape in its body's frame, whose origin is the centre of mass and whose axes are principal.
struct ShapeData {
  Vec3 half;    ///< box: half edges; capsule: (0, 0, half length of its axis); others: half extents about the
                ///< origin, without radius [m]
  Real radius;  ///< sphere, capsule; rounding of the others [m]
  ShapeKind kind;
  int data;  ///< place of its header in ShapeTables::index; -1: has none
};

RUBBLE_HD constexpr bool isPrimitive(ShapeKind kind) { return kind <= ShapeKind::Plane; }
/// Convex, with a support function.
RUBBLE_HD constexpr bool isConvex(ShapeKind kind) {
  return kind != ShapeKind::Plane && kind <= ShapeKind::Triangle;
}
/// Touches another shape in places with several normals: a pair has kSurfaceSlots manifolds.
RUBBLE_HD constexpr bool isSurface(ShapeKind kind) { return kind >= ShapeKind::Mesh; }

/// Lane4 numbers side by side: a vertex, a plane (normal, offset), samples.
struct alignas(4 * sizeof(Real)) Vec4 {
  Real x, y, z, w;
};
RUBBLE_HD inline Vec3 xyz(const Vec4& v) { return {v.x, v.y, v.z}; }

/// A part of a compound, in the frame of its body.
struct ShapePart {
  ShapeData shape;
  Vec3 position;  ///< [m]
  Quat rotation;
  Real radius;  ///< bounding sphere about `position` [m]
  int surface;  ///< its material, -1: that of the body
};

/// What many bodies share: geometry that does not fit a ShapeData. A header begins with the places of its
/// vectors and indices:
///   hull          index[data + 0..3] = vectors, indices, vertices, faces;  vectors: vertices, then planes;
///                 indices: first vertex of each
///                 face (and of one more), then the vertices of the faces, counter-clockwise from outside
///   compound      ..., ..., first part, parts
///   mesh          vectors, indices, nodes, triangles, vertices, two-sided;  see triangles.h
///   height field  vectors, indices, samples along x, along y;  see triangles.h
///   distance      vectors, indices, samples along x, y, z, surface points;  see lattice.h
struct ShapeTables {
  const Vec4* vector;
  const int* index;
  const ShapePart* part;
};

/// Radius of the sphere about the centre that holds the shape; 0 for a plane. [m]
RUBBLE_HD inline Real boundingRadius(const ShapeData& s) {
  return s.kind == ShapeKind::Plane ? Real(0) : s.radius + length(s.half);
}

/// Half extents of the world-aligned box about the centre that holds the shape. [m]
RUBBLE_HD inline Vec3 boundingHalf(const ShapeData& s, const Quat& q) {
  const Mat3 r = rotationMatrix(q);
  const Vec3 e = abs(r.c0) * s.half.x + abs(r.c1) * s.half.y + abs(r.c2) * s.half.z;
  return e + Vec3{s.radius, s.radius, s.radius};
}

/// What two bodies weigh on one another with: the weight of the upper one acts along a line through its
/// centre of mass. All in one frame.
struct Weight {
  Vec3 centreA, centreB;  ///< [m]
  Vec3 down;              ///< unit, along gravity; zero without
};
/// Contacts steeper than this are not there to carry a weight (cosine of gravity and normal).
inline constexpr Real kSteepestFloor = Real(.2);

/// Where the line of the weight meets the contact plane through x with normal n, from A to B. False: nothing
/// weighs on it.
RUBBLE_HD inline bool footOfWeight(const Weight& w, const Vec3& n, const Vec3& x, Vec3& foot) {
  const Real along = dot(w.down, n);
  if (!(std::fabs(along) > kSteepestFloor)) return false;
  const Vec3& centre = along > Real(0) ? w.centreA : w.centreB;
  const Real fall = dot(x - centre, n) / along;
  foot = centre + w.down * fall;
  return fall > Real(0);
}

/// A point of contact, relative to the centre of the first body, world axes.
struct RawPoint {
  Vec3 onA, onB;    ///< on the two surfaces [m]
  int feature = 0;  ///< what touches what; the same in the next step if the configuration is
};

/// The result of a pair test.
struct RawManifold {
  Vec3 n;  ///< from A to B, unit
  int count = 0;
  bool normalOnB = false;  ///< the normal turns with B (else with A)
  RawPoint points[kLanes];
  Real separation = 0;  ///< lower bound of the distance [m]; not above 0: none is known
};

}  // namespace rubble::RUBBLE_CORE
