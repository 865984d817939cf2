#pragma once
/// Fixed joint (weld): the anchors coincide and the relative orientation is kept.
///
///   rows 0-2    the ball joint
///   rows 3-5    C = 2 u,  e = q_B^-1 q_A q_AB^-1 = (s, u), short arc     [rad for small angles], F [N m]
///   J_A = (s 1 - [u]) R_B^T,  J_B = -J_A
///   G_A = G_B = -(F.u) / 2 on the angular diagonal
#include "forces/ball.h"

namespace rubble::RUBBLE_CORE {

struct FixedJoint {
  static constexpr const char* kName = "fixed";
  static constexpr int kRows = 6;
  static constexpr int kGroupCount = 2;
  static constexpr RowGroup kGroups[kGroupCount] = {{0, 3, RowUnit::Linear}, {3, 3, RowUnit::Angular}};

  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frame of their body [m]
    Quat aToB;              ///< wanted q_B^-1 q_A
  };

  RUBBLE_HD static Real lever2(const Data& d, int side) { return BallJoint::lever2({d.anchorA, d.anchorB}, side); }

  RUBBLE_HD static Quat deviation(const Data& d, const Pose& a, const Pose& b) {
    return shortArc(conjugate(b.q) * a.q * conjugate(d.aToB));
  }
  template <int N>
  RUBBLE_HD static void constraint(const Data& d, const Pose& a, const Pose& b, Real (&c)[N]) {
    BallJoint::constraint({d.anchorA, d.anchorB}, a, b, c);
    const Quat e = deviation(d, a, b);
    for (int i = 0; i < 3; ++i) c[3 + i] = Real(2) * e.v[i];
  }
  template <int N>
  RUBBLE_HD static void jacobian(const Data& d, const Pose& a, const Pose& b, int side, Vec6 (&j)[N]) {
    BallJoint::jacobian({d.anchorA, d.anchorB}, a, b, side, j);
    const Quat e = deviation(d, a, b);
    const Real sign = side == 0 ? Real(1) : Real(-1);
    // row i of (s 1 - [u]) R_B^T, as a vector: R_B (s e_i + u x e_i)
    const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; ++i) j[3 + i] = {{0, 0, 0}, sign * rotate(b.q, e.s * axes[i] + cross(e.v, axes[i]))};
  }
  template <int N>
  RUBBLE_HD static Vec6 curvature(const Data& d, const Pose& a, const Pose& b, int side, const Real (&f)[N]) {
    Vec6 g = BallJoint::curvature({d.anchorA, d.anchorB}, a, b, side, f);
    const Quat e = deviation(d, a, b);
    const Real turning = std::fabs(f[3] * e.v.x + f[4] * e.v.y + f[5] * e.v.z) / 2;
    g.ang += {turning, turning, turning};
    return g;
  }
};

}  // namespace rubble::RUBBLE_CORE
