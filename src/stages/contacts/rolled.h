#pragma once
/// Displacement of a contact point by the rotation of its body, for round shapes.
#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

/// Square of the rotation per step [rad2] below which roundness is ignored: the difference is 2e-7 of the
/// lever.
inline constexpr Real kUnrolled2 = Real(1e-4);

/// Cosine of the angle between the normal of a contact and the axis of a cylinder or cone above which it is
/// at its flat end [1].
inline constexpr Real kFlatEnd = Real(.99);

/// As sweptBy(), for rotations above that threshold.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Vec3 rolledBy(const SolverData& s, int body, Vec3 dw, Quat turn, Vec3 r,
                                                  Vec3 out) {
  const ShapeData& shape = s.params[body].shape;
  // round shapes are offsets by `radius` of a point, segment or polyhedron
  const Vec3 round = shape.radius * out, core = r - round;
  const Vec3 axis = rotate(s.orientation[body], {0, 0, 1}), rolled = dot(dw, axis) * axis;
  const bool hasSide = shape.kind == ShapeKind::Cylinder || shape.kind == ShapeKind::Cone;
  if (!hasSide || std::fabs(dot(out, axis)) > kFlatEnd) return rotate(turn, core) - core + cross(dw, round);
  return rotate(expRotation(dw - rolled), core) - core + cross(rolled, core) + cross(dw, round);
}

/// Displacement of the contact point at lever r by the rotation `dw` of its body [m]. `turn`: the same
/// rotation as a quaternion; `out`: outward normal of the body. The point moves with the body, except on
/// round features: they roll, the contact moves to another material point, and the arc of the old one is no
/// slip.
RUBBLE_HD inline Vec3 sweptBy(const SolverData& s, int body, const Vec3& dw, const Quat& turn, const Vec3& r,
                              const Vec3& out) {
  return dot(dw, dw) < kUnrolled2 ? rotate(turn, r) - r : rolledBy(s, body, dw, turn, r, out);
}

}  // namespace rubble::RUBBLE_CORE
