#pragma once
/// Arcs: rows are linear in the rotation of a body, so in them a point of a drum goes on along its tangent.
/// It leaves out the same displacement in every step, and what the wall of the drum carries would sink in by
/// twenty times as much. For bodies that carry others, rows know the arc from the rotation at x^t.
#include "collision/shapes.h"
#include "stages/contacts/rolled.h"
#include "stages/pairs/pair_parts.h"

namespace rubble::RUBBLE_CORE {

/// May a body carry others around? A kinematic one does, and a concave one does what is in it.
RUBBLE_HD inline bool mayCarry(const BodyParams& p) {
  return p.kind == BodyKind::Kinematic || (p.kind == BodyKind::Dynamic && !isConvex(p.shape.kind));
}

/// Rotation in a step [rad], and its square below which an arc is as good as its tangent [rad2].
RUBBLE_HD inline Vec3 turnAhead(const SolverData& s, int body) {
  return s.step->dt * s.angularVelocity[body];
}
inline constexpr Real kStraight2 = Real(1e-7);

/// Do the points of a body go on arcs?
RUBBLE_HD inline bool goesOnArcs(const SolverData& s, int body) {
  if (!mayCarry(s.params[body])) return false;
  const Vec3 dw = turnAhead(s, body);
  return dot(dw, dw) > kStraight2;
}
/// The body of a pair on whose arcs its points go, or -1: a kinematic body, or the larger of two others.
RUBBLE_HD inline int arcBody(const SolverData& s, const OrderedPair& o) {
  const auto leads = [&](int body, int other) {
    const BodyParams &p = s.params[body], &its = s.params[other];
    return (p.kind == BodyKind::Kinematic || !mayCarry(its) || its.radius < p.radius) && goesOnArcs(s, body);
  };
  return leads(o.a, o.b) ? o.a : leads(o.b, o.a) ? o.b : -1;
}

/// Displacement of body `arc` at lever r that is not linear in its rotation [m]. `part`: of a compound, that
/// of the contact; `out`: its outward normal.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Vec3 arcShift(const SolverData& s, int arc, int part, Vec3 r, Vec3 out) {
  const Vec3 dw = turnAhead(s, arc);
  return rolledBy(s, arc, part, dw, expRotation(dw), r, out) - cross(dw, r);
}

}  // namespace rubble::RUBBLE_CORE
