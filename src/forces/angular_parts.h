#pragma once
/// Constraints between the orientations of two bodies. Q_A = q_A f_A and Q_B = q_B f_B are the joint frames
/// on both bodies; e = Q_B^-1 Q_A = (s, u), short arc, is the frame of A relative to B.
#include "forces/joint.h"
#include "math/trig.h"

namespace rubble::RUBBLE_CORE {

/// A rotation angle that is continued beyond half a revolution.
struct RevolutionCounter {
  Real angle;  ///< at x^t, in [-pi, pi] [rad]
  int turns;   ///< full revolutions in addition

  RUBBLE_HD static Real wrap(Real angle) {
    constexpr Real kTurn = Real(6.283185307179586);
    return angle - kTurn * std::floor(angle / kTurn + Real(.5));
  }
  /// Shifts an angle by full revolutions to the branch closest to the angle at x^t.
  RUBBLE_HD Real nearest(Real raw) const { return angle + wrap(raw - angle); }
  RUBBLE_HD void follow(Real raw) {
    constexpr Real kTurn = Real(6.283185307179586), kHalf = kTurn / 2;
    angle = nearest(raw);
    if (angle > kHalf) angle -= kTurn, ++turns;
    if (angle < -kHalf) angle += kTurn, --turns;
  }
  RUBBLE_HD double turned() const { return 6.283185307179586 * turns; }
};

/// Memory of a joint with one continued angle: the twist of its frames about x.
struct TwistMemory {
  RevolutionCounter twist;
  template <class D> RUBBLE_HD void remember(const D& d, const Pose& a, const Pose& b, const Vec3d&);
};

/// Floor of s^2 + u_x^2 in the twist [1]. The twist is undefined where the swing is half a revolution.
inline constexpr Real kTwistFloor = Real(.01);

/// Twist of e about x: theta = 2 atan2(u_x, s), with N = s^2 + u_x^2
///   g = (1, (s u_z + u_x u_y) / N, (u_x u_z - s u_y) / N),  m = (0, g_z, -g_y)
///   J_A = R(Q_B) g,  J_B = -J_A,  d2theta = -(1/2) R(Q_B) (g m^T + m g^T) R(Q_B)^T on both bodies
RUBBLE_HD inline Real twistAngle(const Quat& e) { return Real(2) * signedAngleOf(e.v.x, e.s); }
RUBBLE_HD inline Vec3 twistGradient(const Quat& e) {
  const Real n = max(e.s * e.s + e.v.x * e.v.x, kTwistFloor);
  return {Real(1), (e.s * e.v.z + e.v.x * e.v.y) / n, (e.v.x * e.v.z - e.s * e.v.y) / n};
}
/// Column norms of (a b^T + b a^T) / 2.
RUBBLE_HD inline Vec3 symmetricColumnNorms(const Vec3& a, const Vec3& b) {
  const Real aa = dot(a, a), bb = dot(b, b), ab = dot(a, b);
  const auto norm = [&](Real ac, Real bc) {
    return std::sqrt(max((aa * bc * bc + bb * ac * ac) / 4 + ab * ac * bc / 2, Real(0)));
  };
  return {norm(a.x, b.x), norm(a.y, b.y), norm(a.z, b.z)};
}
RUBBLE_HD inline Vec3 twistCurvature(const Quat& frameB, const Vec3& g, Real force) {
  return absOf(force) * symmetricColumnNorms(rotate(frameB, g), rotate(frameB, Vec3{0, g.z, -g.y}));
}

template <class D> RUBBLE_HD Quat frameOfA(const D& d, const Pose& a) { return a.q * d.frameA; }
template <class D> RUBBLE_HD Quat frameOfB(const D& d, const Pose& b) { return b.q * d.frameB; }
template <class D> RUBBLE_HD Quat frameAInB(const D& d, const Pose& a, const Pose& b) {
  return shortArc(conjugate(frameOfB(d, b)) * frameOfA(d, a));
}

template <class D>
RUBBLE_HD void TwistMemory::remember(const D& d, const Pose& a, const Pose& b, const Vec3d&) {
  twist.follow(twistAngle(frameAInB(d, a, b)));
}

/// Twist of the joint frames about x, continued over full revolutions.
struct TwistAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = true;

  template <class D, class M> RUBBLE_HD static double turns(const D&, const M& m) { return m.twist.turned(); }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    c[0] = m.twist.nearest(twistAngle(frameAInB(d, a, b)));
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    const Vec3 g = rotate(frameOfB(d, b), twistGradient(frameAInB(d, a, b)));
    j[0] = {{0, 0, 0}, side == 0 ? g : -g};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int,
                                  const Real (&f)[kRows]) {
    return {{0, 0, 0}, twistCurvature(frameOfB(d, b), twistGradient(frameAInB(d, a, b)), f[0])};
  }
};

/// The relative orientation equals `rest`.
///
///   C = 2 v,  (t, v) = e rest^-1 in the axes of B, short arc       [rad for small angles], 3 rows, F [N m]
///   J_A = (t 1 - [v]) R(Q_B)^T,  J_B = -J_A
///   G_A = G_B = -(F.v) / 2 on the angular diagonal
RUBBLE_HD inline Quat deviation(const Quat& frameA, const Quat& frameB, const Quat& rest) {
  return shortArc(conjugate(frameB) * frameA * conjugate(rest));
}
RUBBLE_HD inline void orientationError(const Quat& e, Real (&c)[3]) {
  for (int i = 0; i < 3; ++i) c[i] = Real(2) * e.v[i];
}
RUBBLE_HD inline void orientationJacobian(const Quat& e, const Quat& frameB, int side, Vec6 (&j)[3]) {
  const Real sign = side == 0 ? Real(1) : Real(-1);
  // row i of (s 1 - [u]) R_B^T as a vector: R_B (s e_i + u x e_i)
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i) j[i] = {{0, 0, 0}, sign * rotate(frameB, e.s * axes[i] + cross(e.v, axes[i]))};
}
RUBBLE_HD inline Vec6 orientationCurvature(const Quat& e, const Real (&f)[3]) {
  const Real turning = absOf(f[0] * e.v.x + f[1] * e.v.y + f[2] * e.v.z) / 2;
  return {{0, 0, 0}, {turning, turning, turning}};
}

/// Rest orientation q_B^-1 q_A = data.aToB, in the axes of B.
struct OrientationRows {
  static constexpr int kRows = 3;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = false;

  template <class D> RUBBLE_HD static Quat error(const D& d, const Pose& a, const Pose& b) {
    return deviation(a.q, b.q, d.aToB);
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M&, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    orientationError(error(d, a, b), c);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    orientationJacobian(error(d, a, b), b.q, side, j);
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int,
                                  const Real (&f)[kRows]) {
    return orientationCurvature(error(d, a, b), f);
  }
};

/// The x axes of both frames are parallel. a: x axis of A, b_i: axes of B, in world axes.
///
///   C = (b_2.a, b_3.a)                                [1: sine of the angle], 2 rows, F [N m]
///   J_A = [0, a x b_i],  J_B = -J_A,  G = S(F_1 b_2 + F_2 b_3, a) on both bodies
struct ParallelRows {
  static constexpr int kRows = 2;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = false;

  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M&, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    const Vec3 x = rotate(frameOfA(d, a), Vec3{1, 0, 0});
    c[0] = dot(rotate(frameOfB(d, b), Vec3{0, 1, 0}), x);
    c[1] = dot(rotate(frameOfB(d, b), Vec3{0, 0, 1}), x);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    const Vec3 x = rotate(frameOfA(d, a), Vec3{side == 0 ? Real(1) : Real(-1), 0, 0});
    j[0] = {{0, 0, 0}, cross(x, rotate(frameOfB(d, b), Vec3{0, 1, 0}))};
    j[1] = {{0, 0, 0}, cross(x, rotate(frameOfB(d, b), Vec3{0, 0, 1}))};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int,
                                  const Real (&f)[kRows]) {
    const Vec3 force = rotate(frameOfB(d, b), Vec3{0, f[0], f[1]});
    return {{0, 0, 0}, turningColumnNorms(force, rotate(frameOfA(d, a), Vec3{1, 0, 0}))};
  }
};

/// A scalar function c(a) of the direction a of A's x axis in the frame of B.
///   J_A = R(Q_B) (a x grad c),  J_B = -J_A
///   d2c = R(Q_B) ([a]^T hess c [a] + S(grad c, a)) R(Q_B)^T on both bodies
/// Fn: evaluate(data, a, gradient, hessian) returns c.
template <class Fn> struct DirectionAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = true;

  template <class D> RUBBLE_HD static Vec3 seenFromB(const D& d, const Pose& a, const Pose& b) {
    return rotate(frameAInB(d, a, b), Vec3{1, 0, 0});
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M&, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    Vec3 gradient;
    Sym3 hessian;
    c[0] = Fn::evaluate(d, seenFromB(d, a, b), gradient, hessian);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    const Vec3 x = seenFromB(d, a, b);
    Vec3 gradient;
    Sym3 hessian;
    Fn::evaluate(d, x, gradient, hessian);
    const Vec3 g = rotate(frameOfB(d, b), cross(x, gradient));
    j[0] = {{0, 0, 0}, side == 0 ? g : -g};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int,
                                  const Real (&f)[kRows]) {
    const Vec3 x = seenFromB(d, a, b);
    Vec3 g;
    Sym3 h;
    Fn::evaluate(d, x, g, h);
    const Quat frame = frameOfB(d, b);
    Real norm[3];
    for (int i = 0; i < 3; ++i) {
      const Real unit[3] = {i == 0 ? Real(1) : Real(0), i == 1 ? Real(1) : Real(0),
                            i == 2 ? Real(1) : Real(0)};
      const Vec3 w = rotateInverse(frame, Vec3{unit[0], unit[1], unit[2]});
      // [a]^T y = -a x y
      const Vec3 column = -cross(x, h * cross(x, w)) + (g * dot(x, w) + x * dot(g, w)) / Real(2) -
                          w * dot(g, x);
      norm[i] = absOf(f[0]) * length(column);
    }
    return {{0, 0, 0}, {norm[0], norm[1], norm[2]}};
  }
};

/// 2 atan2(n, d) for linear n(a), d(a) with gradients dn, dd. The half-angle form has no fold at 90 degrees
/// and is singular only where n = d = 0.
RUBBLE_HD inline Real halfAngle(Real n, Real d, const Vec3& dn, const Vec3& dd, Vec3& gradient,
                                Sym3& hessian) {
  const Real r2 = max(n * n + d * d, kTwistFloor), r4 = r2 * r2;
  gradient = (dn * d - dd * n) * (Real(2) / r2);
  const Real nn = -4 * n * d / r4, nd = 2 * (n * n - d * d) / r4;
  hessian = outer(dn, nn);
  hessian += outer(dd, -nn);
  // nd (dn dd^T + dd dn^T) by polarization
  hessian += outer(dn + dd, nd / 2);
  hessian += outer(dn - dd, -nd / 2);
  return Real(2) * signedAngleOf(n, d);
}

/// Swing about y: 2 atan2(-a_z, 1 + a_x); about z: 2 atan2(a_y, 1 + a_x). Equals the rotation angle where the
/// other swing is 0.
struct SwingY {
  template <class D> RUBBLE_HD static Real evaluate(const D&, const Vec3& a, Vec3& gradient, Sym3& hessian) {
    return halfAngle(-a.z, Real(1) + a.x, {0, 0, -1}, {1, 0, 0}, gradient, hessian);
  }
};
struct SwingZ {
  template <class D> RUBBLE_HD static Real evaluate(const D&, const Vec3& a, Vec3& gradient, Sym3& hessian) {
    return halfAngle(a.y, Real(1) + a.x, {0, 1, 0}, {1, 0, 0}, gradient, hessian);
  }
};

/// Swing away from x in any direction: 2 atan2(rho, 1 + a_x), rho^2 = (y a_z)^2 + (z a_y)^2, with factors
/// (data.coneY, data.coneZ) = (y, z) >= 1. With both 1 it is the angle between the x axes. For limits Ly
/// about y and Lz about z let T = max(tan(L/2)), y = T / tan(Ly/2) and z = T / tan(Lz/2). The elliptic cone
/// of both limits is then the level 2 atan(T).
struct SwingCone {
  template <class D>
  RUBBLE_HD static Real evaluate(const D& d, const Vec3& a, Vec3& gradient, Sym3& hessian) {
    // the tip of the cone has no direction; no row acts there unless the cone is closed
    constexpr Real kTip = Real(1e-6);
    const Real y = d.coneY * a.z, z = d.coneZ * a.y;
    const Real rho = std::sqrt(y * y + z * z), safe = max(rho, kTip);
    const Vec3 slope{0, d.coneZ * z / safe, d.coneY * y / safe};
    const Real value = halfAngle(rho, Real(1) + a.x, slope, {1, 0, 0}, gradient, hessian);
    // curvature of rho: (dc/drho) d2rho, d2rho = (diag(0, z^2, y^2) - slope slope^T) / rho
    const Real n2 = max(rho * rho + (Real(1) + a.x) * (Real(1) + a.x), kTwistFloor);
    const Real perRho = Real(2) * (Real(1) + a.x) / n2 / safe;
    Sym3 bend{0, 0, 0, perRho * d.coneZ * d.coneZ, 0, perRho * d.coneY * d.coneY};
    bend += outer(slope, -perRho);
    hessian += bend;
    return value;
  }
};

}  // namespace rubble::RUBBLE_CORE
