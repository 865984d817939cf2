#pragma once
/// What joints read of their bodies at the start of a step, and the inertias of their rows.
#include "solver/row.h"

namespace rubble::RUBBLE_CORE {

/// What a joint reads of one of its bodies at the start of a step.
struct JointBody {
  Real mass;      ///< 0: not dynamic [kg]
  Vec3 inertia;   ///< principal moments [kg m2]
  Vec6 change;    ///< motion in this step without joints, to first order [m, rad]
  Vec6 velocity;  ///< at x^t [m/s, rad/s]
};

/// Row inertia of a group: mass [kg], or moment of inertia including the lever [kg m2].
RUBBLE_HD inline Real rowInertia(const JointBody& body, RowUnit unit, Real lever2) {
  if (unit == RowUnit::Linear) return body.mass;
  return min(min(body.inertia.x, body.inertia.y), body.inertia.z) + body.mass * lever2 / 3;
}
/// Row inertia of a coordinate with Jacobian j: m / |j|^2, or the moment of inertia about its axis, including
/// the lever r of the joint.
RUBBLE_HD inline Real axisInertia(const JointBody& body, const Quat& q, const Vec6& j, const Vec3& r) {
  const Real l2 = lengthSquared(j.lin), a2 = lengthSquared(j.ang);
  if (l2 > Real(0)) return body.mass / l2;
  if (!(a2 > Real(0))) return rowInertia(body, RowUnit::Angular, lengthSquared(r));
  const Vec3 local = rotateInverse(q, j.ang);
  return (dot(local, mul(body.inertia, local)) / a2 + body.mass * lengthSquared(cross(j.ang, r)) / a2) / a2;
}

/// Anchor of a joint in the frame of a body.
template <class D> RUBBLE_HD Vec3 localLever(const D& d, int side) {
  if constexpr (requires { d.anchorA; })
    return side == 0 ? d.anchorA : d.anchorB;
  else
    return {0, 0, 0};
}
template <class D> RUBBLE_HD Vec3 leverOf(const D& d, const Quat& q, int side) {
  if constexpr (requires { d.anchorA; })
    return rotate(q, localLever(d, side));
  else
    return {0, 0, 0};
}

/// The smaller of the inertias of the two dynamic bodies.
template <class Of> RUBBLE_HD Real lighter(const JointBody& a, const JointBody& b, Of&& of) {
  const Real ia = a.mass > Real(0) ? of(a, 0) : Real(0), ib = b.mass > Real(0) ? of(b, 1) : Real(0);
  return ia > Real(0) && ib > Real(0) ? min(ia, ib) : max(ia, ib);
}

}  // namespace rubble::RUBBLE_CORE
