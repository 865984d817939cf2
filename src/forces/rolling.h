#pragma once
/// Rolling and torsional friction of a contact with normal n: moments that resist the relative rotation of
/// bodies A and B.
///
///   rotation    w = Dw_A - Dw_B since x^t; torsional part n.w, the rest is the rolling part           [rad]
///   torsion     C = n.w,             |F| <= l_t F_n                                                    [N m]
///   rolling     C = (1 - n n^T) w,   |F| <= l_r F_n                                                    [N m]
///   moment      on A: -(F_t n + F_r), on B: the opposite
///
/// F_n is the sum of the normal forces after the last iteration. l_t and l_r are the levers of the material
/// pair in meters: a wheel of radius r rolls down slopes steeper than l_r / r. C is linear in the
/// displacements, so there is no curvature term.
#include "forces/contact.h"

namespace rubble::RUBBLE_CORE {

struct RollingRows {
  Vec3 n;                   ///< unit normal of the contact
  Vec3 lambda;              ///< multipliers of both rows as a world vector [N m]
  Real kTwist, kRoll;       ///< [N m/rad]; 0: no such friction
  Real torsional, rolling;  ///< levers [m]
};

/// Moment on A, and Hessian of the angular block.
struct RollingMoment {
  Vec3 moment;
  Sym3 hessian;
};

RUBBLE_HD inline RollingMoment rollingMoment(const RollingRows& r, const Vec3& w, Real normalForce) {
  Vec3 t1, t2;
  tangentBasis(r.n, t1, t2);
  const TangentForce<Real> roll = frictionForce<Real>(r.kRoll, dot(t1, w), dot(t2, w), dot(t1, r.lambda),
                                                      dot(t2, r.lambda), normalForce, r.rolling, r.rolling,
                                                      true);
  const TangentForce<Real> twist = frictionForce<Real>(r.kTwist, dot(r.n, w), Real(0), dot(r.n, r.lambda),
                                                       Real(0), normalForce, r.torsional, r.torsional, true);
  return {t1 * roll.f1 + t2 * roll.f2 + r.n * twist.f1, pointHessian(r.n, t1, t2, twist.w11(), roll)};
}

RUBBLE_HD inline Real sumOfNormals(const ContactRows& m) {
  return (m.load[0].lambdaN + m.load[1].lambdaN) + (m.load[2].lambdaN + m.load[3].lambdaN);
}

/// Adds the moment and its Hessian to the block of A or B.
RUBBLE_HD inline void accumulateRolling(const RollingRows& r, const ContactRows& m, bool onA,
                                        const Displacement& a, const Displacement& b, Block6& block,
                                        Real weight = 1) {
  if (r.kRoll == Real(0) && r.kTwist == Real(0)) return;
  const RollingMoment o = rollingMoment(r, a.dw - b.dw, sumOfNormals(m));
  block.fa += o.moment * (onA ? Real(-1) : Real(1));
  block.aa += weight * o.hessian;
}

}  // namespace rubble::RUBBLE_CORE
