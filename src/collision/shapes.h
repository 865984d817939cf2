#pragma once
/// Shapes as the solver keeps them, and what a pair test gives.
#include "math/sym.h"
#include "solver/pose_algebra.h"

namespace rubble::RUBBLE_CORE {

enum class ShapeKind : int { Sphere, Capsule, Box, Plane };

/// A shape in its body's frame.
struct ShapeData {
  Vec3 half;       ///< box: half edges; capsule: (0, 0, half length of its axis) [m]
  Real radius;     ///< sphere, capsule [m]
  ShapeKind kind;
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

/// A point of contact, relative to the centre of the first body, world axes.
struct RawPoint {
  Vec3 onA, onB;  ///< on the two surfaces [m]
  int feature;    ///< what touches what; the same in the next step if the configuration is
};

/// The result of a pair test.
struct RawManifold {
  Vec3 n;               ///< from A to B, unit
  int count = 0;
  bool normalOnB = false;  ///< the normal turns with B (else with A)
  RawPoint points[kLanes];
  Real separation = 0;  ///< count 0: lower bound of the distance [m]
};

}  // namespace rubble::RUBBLE_CORE
