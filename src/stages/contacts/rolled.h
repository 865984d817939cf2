#pragma once
/// Displacement of a contact point by the rotation of its body, for round shapes.
#include "stages/contacts/round_sides.h"

namespace rubble::RUBBLE_CORE {

/// Square of the rotation per step [rad2] below which roundness is ignored: the difference is 2e-7 of the
/// lever.
inline constexpr Real kUnrolled2 = Real(1e-4);

/// The part of A, or of B, at the contact of rows r.
RUBBLE_HD inline int partAt(const SolverData& s, const ContactRows& r, bool onA) {
  const PairParts parts = partsOf(s, s.pair[s.activePair[r.manifold]], {r.a, r.b});
  return onA ? parts.ofA : parts.ofB;
}

/// As sweptBy(), for rotations above that threshold. `part`: of a compound, that of the contact.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Vec3 rolledBy(const SolverData& s, int body, int part, Vec3 dw, Quat turn,
                                                  Vec3 r, Vec3 out) {
  const PlacedPart own = placedPart(s.shapeTables(), s.params[body].shape, s.orientation[body], part);
  // round shapes are offsets by `radius` of a point, segment or polyhedron
  const ShapeData& shape = own.shape;
  const Vec3 round = shape.radius * out, core = r - own.at - round, moved = rotate(turn, own.at) - own.at;
  const Vec3 axis = rotate(own.q, {0, 0, 1}), rolled = dot(dw, axis) * axis;
  if (!isOnSide(shape, dot(out, axis))) return moved + (rotate(turn, core) - core + cross(dw, round));
  return moved + (rotate(expRotation(dw - rolled), core) - core + cross(rolled, core) + cross(dw, round));
}

/// Displacement of the point at lever r from A (or B) of rows `of` by the rotation `dw` of that body [m].
/// `turn`: the same rotation as a quaternion. The point moves with the body, except on round features: they
/// roll, the contact moves to another material point, and the arc of the old one is no slip.
RUBBLE_HD inline Vec3 sweptBy(const SolverData& s, const ContactRows& of, bool onA, const Vec3& dw,
                              const Quat& turn, const Vec3& r) {
  if (dot(dw, dw) < kUnrolled2) return rotate(turn, r) - r;
  return rolledBy(s, onA ? of.a : of.b, partAt(s, of, onA), dw, turn, r, onA ? of.n : -of.n);
}

}  // namespace rubble::RUBBLE_CORE
