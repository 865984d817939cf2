#pragma once
/// What rows give a body that turns far in a step. They know its turn to first order: their levers are those
/// of x^t, and a point of a body that turns by an angle a is elsewhere by half of a^2. So their impulses and
/// their torques fit one another no better than that, and energy comes from it. Rows that act on nothing
/// which moves do no work: a body with only such rows may have no more kinetic energy than it would have had
/// without them. Velocity and spin are reduced together, which turns no parting into an approach.
#include "stages/contacts/contacts.h"

namespace rubble::RUBBLE_CORE {

/// Bodies that turn further in a step than this are looked at, squared [rad2].
inline constexpr Real kFarTurn2 = Real(.01);

/// Is a contact one with a surface that does not move?
RUBBLE_HD inline bool isAtRest(const SolverData& s, const ContactRows& r, int other) {
  const BodyKind kind = s.params[other].kind;
  if (kind == BodyKind::Dynamic) return false;
  if (kind == BodyKind::Kinematic &&
      (s.velocity[other] != Vec3{0, 0, 0} || s.angularVelocity[other] != Vec3{0, 0, 0}))
    return false;
  if (s.surfaces == 0) return true;
  return pairMaterial(s, s.pair[s.activePair[r.manifold]], {r.a, r.b}).belt == Vec3{0, 0, 0};
}

/// Has a body rows, and do all of them act on what does not move?
RUBBLE_HD inline bool isHeldAtRest(const SolverData& s, int i) {
  const int begin = s.incidenceOffset[i], end = s.incidenceOffset[i + 1];
  for (int k = begin; k < end; ++k) {
    const std::uint32_t code = s.incidence[k].code;
    if (constraintType(code) != kContactType) return false;
    const ContactRows& r = s.contact[constraintIndex(code)];
    if (!isAtRest(s, r, constraintSide(code) == 0 ? r.b : r.a)) return false;
  }
  return end > begin;
}

/// Share of its velocity and spin that a body keeps, at orientation q.
RUBBLE_HD RUBBLE_APART inline Real keptMotion(const SolverData& s, int i, Quat q, Vec3 v, Vec3 w) {
  if (!isHeldAtRest(s, i)) return 1;
  const Vec3 principal = s.params[i].inertia;
  const Real mass = s.params[i].mass;
  const auto energy = [&](const Quat& frame, const Vec3& linear, const Vec3& spin) {
    const Vec3 own = rotateInverse(frame, spin);
    return mass * dot(linear, linear) + dot(own, mul(principal, own));
  };
  const BodyTarget& target = s.target[i];
  const Real inverseDt = s.step.inverseDt;
  const Real free = energy(s.orientation[i], inverseDt * target.y.p, inverseDt * logRotation(target.y.q));
  const Real now = energy(q, v, w);
  return now > free ? std::sqrt(free / now) : Real(1);
}

}  // namespace rubble::RUBBLE_CORE
