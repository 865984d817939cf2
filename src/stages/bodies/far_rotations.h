#pragma once
/// Energy bound for bodies that rotate far in a step. Rows see the rotation to first order: levers are those
/// of x^t, and a point rotated by an angle a deviates by a^2 / 2. Impulses and torques are therefore
/// inconsistent to that order, which can add energy.
///
/// Rows against immovable surfaces do no work. A body with only such rows must not have more kinetic energy
/// than it would have without them. Linear and angular velocity are scaled together, which turns no
/// separation into an approach.
#include "stages/contacts/contacts.h"

namespace rubble::RUBBLE_CORE {

/// Square of the rotation per step above which the bound applies [rad2].
inline constexpr Real kFarRotation2 = Real(.01);

/// Is the contact with an immovable surface?
RUBBLE_HD inline bool isAtRest(const SolverData& s, const RowBodies& r, int other) {
  const BodyKind kind = s.params[other].kind;
  if (kind == BodyKind::Dynamic) return false;
  if (kind == BodyKind::Kinematic &&
      (s.velocity[other] != Vec3{0, 0, 0} || s.angularVelocity[other] != Vec3{0, 0, 0}))
    return false;
  if (s.surfaces == 0) return true;
  return pairMaterial(s, s.pair[s.activePair[r.manifold]], {r.a, r.b}).surfaceShift == Vec3{0, 0, 0};
}

/// Has the body rows, and are all of them contacts with immovable surfaces?
RUBBLE_HD inline bool isHeldAtRest(const SolverData& s, int i) {
  const int begin = s.incidenceOffset[i], end = s.incidenceOffset[i + 1];
  for (int k = begin; k < end; ++k) {
    const std::uint32_t code = s.incidence[k].code;
    if (constraintType(code) != kContactType) return false;
    const RowBodies r = s.rowBodies[constraintIndex(code)];
    if (!isAtRest(s, r, constraintSide(code) == 0 ? r.b : r.a)) return false;
  }
  return end > begin;
}

/// Share of its velocities that a body at orientation q keeps [1].
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Real keptMotion(const SolverData& s, int i, Quat q, Vec3 v, Vec3 w) {
  if (!isHeldAtRest(s, i)) return 1;
  const Vec3 principal = s.params[i].inertia;
  const Real mass = s.params[i].mass;
  const auto energy = [&](const Quat& frame, const Vec3& linear, const Vec3& spin) {
    const Vec3 own = rotateInverse(frame, spin);
    return mass * dot(linear, linear) + dot(own, mul(principal, own));
  };
  const BodyTarget& target = s.target[i];
  const Real inverseDt = s.step->inverseDt;
  const Real free = energy(s.orientation[i], inverseDt * target.y.p, inverseDt * logRotation(target.y.q));
  const Real now = energy(q, v, w);
  return now > free ? std::sqrt(free / now) : Real(1);
}

}  // namespace rubble::RUBBLE_CORE
