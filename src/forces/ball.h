#pragma once
/// Ball joint: two anchors coincide.
///
///   C = x_A - x_B,  x_i = p_i + r_i,  r_i = R_i a_i                    [m], 3 rows, F [N]
///   J_A = [1, -[r_A]],  J_B = -[1, -[r_B]]
///   G_A = S(F, r_A), G_B = -S(F, r_B) (angular block): column norms of row.h
#include "forces/joint.h"

namespace rubble::RUBBLE_CORE {

struct BallJoint {
  static constexpr const char* kName = "ball";
  static constexpr int kRows = 3;
  static constexpr int kGroupCount = 1;
  static constexpr RowGroup kGroups[kGroupCount] = {{0, 3, RowUnit::Linear}};

  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frame of their body [m]
  };

  RUBBLE_HD static Real lever2(const Data& d, int side) { return lengthSquared(side == 0 ? d.anchorA : d.anchorB); }

  template <int N>
  RUBBLE_HD static void constraint(const Data& d, const Pose& a, const Pose& b, Real (&c)[N]) {
    const Vec3 gap = (a.p - b.p) + rotate(a.q, d.anchorA) - rotate(b.q, d.anchorB);
    c[0] = gap.x, c[1] = gap.y, c[2] = gap.z;
  }
  template <int N>
  RUBBLE_HD static void jacobian(const Data& d, const Pose& a, const Pose& b, int side, Vec6 (&j)[N]) {
    const Real sign = side == 0 ? Real(1) : Real(-1);
    const Vec3 r = sign * (side == 0 ? rotate(a.q, d.anchorA) : rotate(b.q, d.anchorB));
    // row i is sign (e_i, r x e_i)
    j[0] = {{sign, 0, 0}, {0, r.z, -r.y}};
    j[1] = {{0, sign, 0}, {-r.z, 0, r.x}};
    j[2] = {{0, 0, sign}, {r.y, -r.x, 0}};
  }
  template <int N>
  RUBBLE_HD static Vec6 curvature(const Data& d, const Pose& a, const Pose& b, int side, const Real (&f)[N]) {
    const Vec3 r = side == 0 ? rotate(a.q, d.anchorA) : rotate(b.q, d.anchorB);
    return {{0, 0, 0}, turningColumnNorms({f[0], f[1], f[2]}, r)};
  }
};

}  // namespace rubble::RUBBLE_CORE
