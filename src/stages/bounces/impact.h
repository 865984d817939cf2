#pragma once
/// A contact of two bodies in an impact: the response of their velocities to impulses at its points.
#include "stages/bodies/bodies.h"

namespace rubble::RUBBLE_CORE {

/// Response of a body to an impulse.
struct Mobility {
  Real inverseMass;
  Sym3 inertia;  ///< 0 if the body does not rotate
  int locks;
  bool moves;

  RUBBLE_HD Vec3 linear(const Vec3& impulse) const {
    return moves ? unlocked(inverseMass * impulse, locks) : Vec3{0, 0, 0};
  }
  RUBBLE_HD Vec3 angular(Vec3 moment) const {
    if (!moves) return {0, 0, 0};
    moment = unlocked(moment, locks >> 3);
    return unlocked(solve(Block3{inertia, moment}), locks >> 3);
  }
  RUBBLE_HD Real energy(const BodyMotion& m) const {
    return moves ? (dot(m.v, m.v) / inverseMass + dot(m.w, inertia * m.w)) / 2 : Real(0);
  }
};
RUBBLE_HD inline Mobility mobility(const SolverData& s, int body) {
  if (!isDynamic(s, body)) return {0, {}, 0, false};
  const BodyTarget& t = s.target[body];
  // at the present orientation: with the inertia at x^t a rotated body would gain energy
  const Sym3 inertia = rotateDiagonal(s.orientation[body], s.params[body].inertia);
  Mobility m{Real(1) / t.mass.mass, inertia, t.locks, true};
  const auto keep = [&](int axis) { return (m.locks >> (3 + axis) & 1) == 0; };
  if (!keep(0) || !keep(1)) m.inertia.xy = 0;
  if (!keep(0) || !keep(2)) m.inertia.xz = 0;
  if (!keep(1) || !keep(2)) m.inertia.yz = 0;
  return m;
}

RUBBLE_HD inline BodyMotion motionOf(const SolverData& s, int body) {
  return {s.velocity[body], s.angularVelocity[body]};
}

/// A contact between two moving bodies.
struct Impact {
  const ContactRows& r;
  Mobility a, b;

  RUBBLE_HD Impact(const SolverData& s, const ContactRows& rows)
      : r(rows), a(mobility(s, rows.a)), b(mobility(s, rows.b)) {}
  /// Levers end at the surfaces of the bodies: a gap at x^t has closed at the impact.
  RUBBLE_HD Vec3 leverA(int k) const { return r.place[k].rA - (half(k) * r.n); }
  RUBBLE_HD Vec3 leverB(int k) const { return r.place[k].rA + r.offset + (half(k) * r.n); }
  RUBBLE_HD Real half(int k) const { return max(-r.place[k].c0, Real(0)) / 2; }
  RUBBLE_HD Vec3 relative(int k, const BodyMotion& ma, const BodyMotion& mb) const {
    return ma.v + cross(ma.w, leverA(k)) - mb.v - cross(mb.w, leverB(k));
  }
  RUBBLE_HD Real closing(int k, const BodyMotion& ma, const BodyMotion& mb) const {
    return dot(r.n, relative(k, ma, mb));
  }
  /// Adds an impulse at point k on B, and its opposite on A.
  RUBBLE_HD void strike(int k, const Vec3& impulse, BodyMotion& ma, BodyMotion& mb) const {
    ma.v -= a.linear(impulse), ma.w -= a.angular(cross(leverA(k), impulse));
    mb.v += b.linear(impulse), mb.w += b.angular(cross(leverB(k), impulse));
  }
  RUBBLE_HD Real energy(const BodyMotion& ma, const BodyMotion& mb) const {
    return a.energy(ma) + b.energy(mb);
  }
  /// Adds impulses along the normal that push the bodies apart.
  RUBBLE_HD void push(const Real (&p)[kLanes], Real times, BodyMotion& ma, BodyMotion& mb) const {
    Real sum = 0;
    Vec3 momentA{0, 0, 0}, momentB{0, 0, 0};
    for (int k = 0; k < kLanes; ++k) {
      sum += p[k];
      momentA += cross(leverA(k), p[k] * r.n), momentB += cross(leverB(k), p[k] * r.n);
    }
    ma.v -= a.linear(times * sum * r.n), ma.w -= a.angular(times * momentA);
    mb.v += b.linear(times * sum * r.n), mb.w += b.angular(times * momentB);
  }
};

/// Is the point active in the step?
RUBBLE_HD inline bool actsAt(const ContactRows& r, int k) { return r.load[k].kN > Real(0); }

}  // namespace rubble::RUBBLE_CORE
