#pragma once
/// What a rotation moves a point of contact by, where bodies are round.
#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

/// Square of the rotation in a step [rad2] up to which it does not matter what is round: the difference is
/// 2e-7 of the lever.
inline constexpr Real kUnrolled2 = Real(1e-4);

/// What sweptBy() says, for a rotation that counts.
RUBBLE_HD RUBBLE_APART inline Vec3 rolledBy(const SolverData& s, int body, Vec3 dw, Quat turn, Vec3 r,
                                            Vec3 out) {
  const ShapeData& shape = s.params[body].shape;
  // about points, edges and segments at a distance `radius`
  const Vec3 round = shape.radius * out, core = r - round;
  if (shape.kind != ShapeKind::Cylinder && shape.kind != ShapeKind::Cone)
    return rotate(turn, core) - core + cross(dw, round);
  const Vec3 axis = rotate(s.orientation[body], {0, 0, 1}), rolled = dot(dw, axis) * axis;
  return rotate(expRotation(dw - rolled), core) - core + cross(rolled, core) + cross(dw, round);
}

/// What the rotation `dw` (as a quaternion: `turn`) of a body moves the point that touches by, at lever r
/// [m]. `out`: the normal out of the body. The point is carried along, but for what is round: as that rolls,
/// another point of it touches, and the one that touched goes on an arc that is no slip.
RUBBLE_HD inline Vec3 sweptBy(const SolverData& s, int body, const Vec3& dw, const Quat& turn, const Vec3& r,
                              const Vec3& out) {
  return dot(dw, dw) < kUnrolled2 ? rotate(turn, r) - r : rolledBy(s, body, dw, turn, r, out);
}

}  // namespace rubble::RUBBLE_CORE
