#pragma once
/// Shapes as the solver stores them, and the result of the narrow phase.
#include "collision/shape_kind.h"
#include "math/sym.h"
#include "solver/pose_algebra.h"

namespace rubble::RUBBLE_CORE {

/// A shape in the frame of its body: origin at the center of mass, principal axes.
struct ShapeData {
  Vec3 half;  ///< box: half extents; capsule: (0, 0, half length of its axis); others: half extents about the
              ///< origin, without radius [m]
  Real radius;  ///< radius of spheres and capsules; rounding radius of the others [m]
  ShapeKind kind;
  int data;  ///< offset of its header in ShapeTables::index; -1: none
};

RUBBLE_HD constexpr bool isPrimitive(ShapeKind kind) { return kind <= ShapeKind::Plane; }
/// Convex, with a support function.
RUBBLE_HD constexpr bool isConvex(ShapeKind kind) {
  return kind != ShapeKind::Plane && kind <= ShapeKind::Triangle;
}
/// Has contacts with several normals at a time: a pair has kSurfaceSlots manifolds.
RUBBLE_HD constexpr bool isSurface(ShapeKind kind) { return kind >= ShapeKind::Mesh; }

/// Four adjacent numbers: a vertex, a plane (normal, offset), or samples.
struct alignas(4 * sizeof(Real)) Vec4 {
  Real x, y, z, w;
};
RUBBLE_HD inline Vec3 xyz(const Vec4& v) { return {v.x, v.y, v.z}; }

/// A part of a compound, in the frame of the body.
struct ShapePart {
  ShapeData shape;
  Vec3 position;  ///< [m]
  Quat rotation;
  Real radius;  ///< bounding sphere about `position` [m]
  int surface;  ///< its material; -1: that of the body
};

/// Geometry shared by bodies. A header begins with the offsets of its vectors and indices:
///   hull          index[data + 0..3] = vectors, indices, vertices, faces;  vectors: vertices, then planes;
///                 indices: offset of the first vertex of each face (and an end offset), then the vertices of
///                 the faces, counter-clockwise from outside
///   compound      ..., ..., first part, parts
///   mesh          vectors, indices, nodes, triangles, vertices, two-sided;  see triangles.h
///   height field  vectors, indices, samples along x, along y;  see triangles.h
///   distance      vectors, indices, samples along x, y, z, surface points;  see lattice.h
struct ShapeTables {
  const Vec4* vector;
  const int* index;
  const ShapePart* part;
};

/// Radius of the bounding sphere about the center; 0 for a plane. [m]
RUBBLE_HD inline Real boundingRadius(const ShapeData& s) {
  return s.kind == ShapeKind::Plane ? Real(0) : s.radius + length(s.half);
}

/// Half extents of the world AABB about the center. [m]
RUBBLE_HD inline Vec3 boundingHalf(const ShapeData& s, const Quat& q) {
  const Mat3 r = rotationMatrix(q);
  const Vec3 e = abs(r.c0) * s.half.x + abs(r.c1) * s.half.y + abs(r.c2) * s.half.z;
  return e + Vec3{s.radius, s.radius, s.radius};
}

/// Load line of a contact: the weight of the upper body acts along gravity through its center of mass. All in
/// one frame.
struct Weight {
  Vec3 centerA, centerB;  ///< [m]
  Vec3 down;              ///< unit, along gravity; zero without gravity
};
/// Contacts steeper than this carry no weight (cosine between gravity and normal).
inline constexpr Real kSteepestFloor = Real(.2);

/// Intersection `foot` of the load line with the contact plane through x with normal n (from A to B). Returns
/// false if no weight acts on the plane.
RUBBLE_HD inline bool footOfWeight(const Weight& w, const Vec3& n, const Vec3& x, Vec3& foot) {
  const Real along = dot(w.down, n);
  if (!(std::fabs(along) > kSteepestFloor)) return false;
  const Vec3& center = along > Real(0) ? w.centerA : w.centerB;
  const Real fall = dot(x - center, n) / along;
  foot = center + w.down * fall;
  return fall > Real(0);
}

/// A contact point, relative to the center of the first body, world axes.
struct RawPoint {
  Vec3 onA, onB;    ///< on the two surfaces [m]
  int feature = 0;  ///< feature pair; the same in the next step if the configuration is
};

/// Result of the narrow phase.
struct RawManifold {
  Vec3 n;  ///< unit, from A to B
  int count = 0;
  bool normalOnB = false;  ///< the normal is fixed in B, else in A
  RawPoint points[kLanes];
  Real separation = 0;  ///< lower bound of the distance [m]; if not positive, none is known
};

}  // namespace rubble::RUBBLE_CORE
