#pragma once
/// Inertia: where a body would go without constraints, and what it costs to go elsewhere.
#include "math/sym.h"
#include "solver/pose_algebra.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S8} M = diag(m 1, I_w), I_w = R I_b R^T, frozen at x^t for the step. [kg, kg m2]
template <class L>
struct MassMatrixT {
  L mass;
  Sym3T<L> inertia;
};
using MassMatrix = MassMatrixT<Real>;
RUBBLE_HD inline MassMatrix massMatrix(Real mass, const Vec3& principalInertia, const Quat& q) {
  return {mass, rotateDiagonal(q, principalInertia)};
}

/// \eq{S2} y - x^t = dt v + dt^2 a_ext, the linear part of the inertial target. [m]
RUBBLE_HD inline Vec3 inertialDisplacement(const Vec3& v, const Vec3& acceleration, Real dt) {
  return dt * (v + dt * acceleration);
}

/// Spin after one step without constraints that keeps the angular momentum (METHOD of discrete mechanics: Pi+(w1) = Pi-(w0) + dt T), in the
/// body's frame. [rad/s] `w0` spin, `torque` [N m], `inertia` principal moments [kg m2].
RUBBLE_HD inline Vec3 torqueFreeSpin(const Vec3& w0, const Vec3& torque, const Vec3& inertia, Real dt) {
  constexpr int kNewtonSteps = 5;                // a fixed count keeps every backend alike
  constexpr Real kConvergent = Real(1);          // the iteration contracts up to 1 rad a step; above, the spin is kept
  const Vec3 inverse{Real(1) / inertia.x, Real(1) / inertia.y, Real(1) / inertia.z};
  const Vec3 explicitSpin = w0 + dt * mul(inverse, torque);
  const bool spherical = inertia.x == inertia.y && inertia.y == inertia.z;
  if (spherical || dot(w0, w0) * dt * dt > kConvergent || dot(w0, w0) + dot(torque, torque) == Real(0)) return explicitSpin;

  const auto momentum = [&](const Vec3& w, Real sign) {
    const Vec3 x = dt * w, iw = mul(inertia, w);
    const Real a2 = dot(x, x), a = std::sqrt(a2);
    const SinCos half = sinCos(a / 2);
    const Real c = a < Real(.1) ? Real(1) / 12 + a2 / 720 : (Real(1) - (a / 2) * half.cos / half.sin) / a2;
    const Vec3 xi = cross(x, iw);
    return iw + (sign / 2) * xi + c * cross(x, xi);
  };
  const Vec3 wanted = momentum(w0, Real(-1)) + dt * torque;
  Vec3 w = w0;
  for (int i = 0; i < kNewtonSteps; ++i) {
    // Jn = I + dt/2 ([w] I - [I w])
    const Mat3 wi = crossMatrix(w), iw = crossMatrix(mul(inertia, w));
    const Vec3 c0 = dt / 2 * (wi.c0 * inertia.x - iw.c0) + Vec3{inertia.x, 0, 0};
    const Vec3 c1 = dt / 2 * (wi.c1 * inertia.y - iw.c1) + Vec3{0, inertia.y, 0};
    const Vec3 c2 = dt / 2 * (wi.c2 * inertia.z - iw.c2) + Vec3{0, 0, inertia.z};
    const Vec3 error = momentum(w, Real(1)) - wanted;
    const Vec3 k0 = cross(c1, c2), k1 = cross(c2, c0), k2 = cross(c0, c1);
    const Real det = dot(c0, k0);
    w -= Vec3{dot(k0, error), dot(k1, error), dot(k2, error)} / det;
  }
  return isFinite(w) ? w : explicitSpin;
}

/// \eq{S1} The inertial part of the objective whose minimum is the implicit Euler step: |x - y|_M^2 / (2 dt^2); the potentials of all
/// forces are added to it. [J]
RUBBLE_HD inline Real inertialEnergy(const MassMatrix& m, const Pose& x, const Pose& y, Real dt) {
  const Vec6 d = difference(x, y);
  return (m.mass * dot(d.lin, d.lin) + dot(d.ang, m.inertia * d.ang)) / (2 * dt * dt);
}

/// Share of the external acceleration that a body followed in the last step, for the initial guess x^t + dt v + c dt^2 a (adaptive rule of
/// vertex block descent): 0 for a body at rest, 1 for a falling one. `v`, `previous` velocities [m/s], `acceleration` [m/s2].
RUBBLE_HD inline Real followedShare(const Vec3& v, const Vec3& previous, const Vec3& acceleration, Real dt) {
  const Real a2 = dot(acceleration, acceleration);
  if (!(a2 > Real(0))) return 0;
  const Real c = dot(v - previous, acceleration) / (dt * a2);
  return isFinite(c) ? clamp(c, Real(0), Real(1)) : Real(0);
}

}  // namespace rubble::RUBBLE_CORE
