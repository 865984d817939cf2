#pragma once
/// Constraints between points of two bodies. x_i = p_i + r_i with r_i = R_i a_i, d = x_A - x_B, b_i: axes of
/// the joint frame on B.
#include "forces/joint.h"

namespace rubble::RUBBLE_CORE {

/// Anchors of A and B: in the frames of their bodies, or, with rotations since x^t, in world axes at x^t [m].
template <class L> struct Anchors {
  Vec3T<L> anchorA, anchorB;
  static Anchors of(const EngineJoint& j) { return {Vec3T<L>(j.anchorA), Vec3T<L>(j.anchorB)}; }
};

template <class D> RUBBLE_HD RUBBLE_NEAR Vec3 anchorLever(const D& d, const Pose& pose, int side) {
  return rotate(pose.q, side == 0 ? d.anchorA : d.anchorB);
}

/// The anchors coincide, or keep an offset o from the memory of the joint.
///
///   C = x_A - x_B - o                                 [m], 3 rows, F [N]
///   J_A = [1, -[r_A]],  J_B = -[1, -[r_B]]
///   G_A = S(F, r_A), G_B = -S(F, r_B) (angular block): column norms of row.h
struct AnchorRows {
  static constexpr int kRows = 3;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = false;

  template <class D, class M, class L>
  RUBBLE_HD RUBBLE_NEAR static void constraint(const D& d, const M& memory, const PoseT<L>& a,
                                               const PoseT<L>& b, L (&c)[kRows]) {
    Vec3T<L> gap = (a.p - b.p) + rotate(a.q, d.anchorA) - rotate(b.q, d.anchorB);
    if constexpr (requires { memory.offset; })
      gap = gap - memory.offset;
    else
      (void)memory;
    c[0] = gap.x, c[1] = gap.y, c[2] = gap.z;
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    const Real sign = side == 0 ? Real(1) : Real(-1);
    const Vec3 r = sign * anchorLever(d, side == 0 ? a : b, side);
    // row i is sign (e_i, r x e_i)
    j[0] = {{sign, 0, 0}, {0, r.z, -r.y}};
    j[1] = {{0, sign, 0}, {-r.z, 0, r.x}};
    j[2] = {{0, 0, sign}, {r.y, -r.x, 0}};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                  const Real (&f)[kRows]) {
    return {{0, 0, 0}, turningColumnNorms({f[0], f[1], f[2]}, anchorLever(d, side == 0 ? a : b, side))};
  }
  /// Adds the rows including their curvature, which is about the center of the body wherever the block is
  /// about.
  template <class D, class Mask, class L>
  RUBBLE_HD RUBBLE_NEAR static void accumulate(const D& d, const PoseT<L>& a, const PoseT<L>& b, Mask onA,
                                               const Vec3T<L>& shift, const L (&f)[kRows], L k,
                                               Block6T<L>& block) {
    const Vec3T<L> r = select(onA, rotate(a.q, d.anchorA), rotate(b.q, d.anchorB)), force{f[0], f[1], f[2]};
    addAtLever(block, r + shift, select(onA, -force, force), k);
    const L zero = LaneAccess<L>::splat(0);
    accumulateCurvature(block, {{zero, zero, zero}, turningColumnNorms(force, r)});
  }
};

/// Jacobian of u.(x_A - x_B) for a direction u fixed in B: J_A = [u, r_A x u], J_B = -[u, (x_A - p_B) x u].
template <class D>
RUBBLE_HD Vec6 travelJacobian(const D& d, const Pose& a, const Pose& b, int side, const Vec3& u) {
  const Vec3 r = rotate(a.q, d.anchorA);
  return side == 0 ? Vec6{u, cross(r, u)} : -Vec6{u, cross(a.p + r - b.p, u)};
}
/// Column norms for the force vector f = sum F u. A: S(f, r_A) in the angular block. B: also the off-diagonal
/// block [f], and S(f, x_A - p_B).
template <class D>
RUBBLE_HD Vec6 travelCurvature(const D& d, const Pose& a, const Pose& b, int side, const Vec3& f) {
  const Vec3 r = rotate(a.q, d.anchorA);
  if (side == 0) return {{0, 0, 0}, turningColumnNorms(f, r)};
  const Real f2 = lengthSquared(f);
  const Vec3 turn = turningColumnNorms(f, a.p + r - b.p);
  const auto across = [&](Real c) { return max(f2 - c * c, Real(0)); };
  const Vec3 mixed{across(f.x), across(f.y), across(f.z)};
  return {{std::sqrt(mixed.x), std::sqrt(mixed.y), std::sqrt(mixed.z)},
          {std::sqrt(mixed.x + turn.x * turn.x), std::sqrt(mixed.y + turn.y * turn.y),
           std::sqrt(mixed.z + turn.z * turn.z)}};
}
RUBBLE_HD constexpr Vec3 unitAxis(int i) {
  return {i == 0 ? Real(1) : Real(0), i == 1 ? Real(1) : Real(0), i == 2 ? Real(1) : Real(0)};
}
template <class D> RUBBLE_HD Vec3 axisOfB(const D& d, const Pose& b, int i) {
  return rotate(b.q, rotate(d.frameB, unitAxis(i)));
}

/// Anchor A lies on the x axis of the joint frame on B.
///
///   C = (b_2.d, b_3.d)                                [m], 2 rows, F [N]
///   J, G as above, f = F_1 b_2 + F_2 b_3
struct OnLineRows {
  static constexpr int kRows = 2;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = false;

  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M&, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    const Vec3 gap = (a.p - b.p) + rotate(a.q, d.anchorA) - rotate(b.q, d.anchorB);
    for (int i = 0; i < kRows; ++i) c[i] = dot(axisOfB(d, b, i + 1), gap);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    for (int i = 0; i < kRows; ++i) j[i] = travelJacobian(d, a, b, side, axisOfB(d, b, i + 1));
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                  const Real (&f)[kRows]) {
    return travelCurvature(d, a, b, side, f[0] * axisOfB(d, b, 1) + f[1] * axisOfB(d, b, 2));
  }
};

/// Travel of anchor A along axis I of the joint frame on B.
///
///   c = b_I.d                                         [m], F [N];  J, G as above, f = F b_I
template <int I> struct TravelAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = true;

  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M&, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    const Vec3 gap = (a.p - b.p) + rotate(a.q, d.anchorA) - rotate(b.q, d.anchorB);
    c[0] = dot(axisOfB(d, b, I), gap);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    j[0] = travelJacobian(d, a, b, side, axisOfB(d, b, I));
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                  const Real (&f)[kRows]) {
    return travelCurvature(d, a, b, side, f[0] * axisOfB(d, b, I));
  }
};

/// A shorter distance has no direction [m].
inline constexpr Real kNoDistance = Real(1e-6);

/// |d| and its direction n; n = z if |d| <= kNoDistance.
RUBBLE_HD inline Real direction(const Vec3& d, Vec3& n) {
  const Real size = length(d);
  n = size > kNoDistance ? d / size : Vec3{0, 0, 1};
  return size;
}

/// Column norms of f d2|d|/dx2 for the body that moves one end of d, d = x + const, x = p + r:
///   D^T P D + [0, 0; 0, S(n, r)],  D = [1, -[r]],  P = (1 - n n^T) / |d|
/// Blocks P, -P [r], [r] P, -[r] P [r] + S(n, r). Under compression only S is used: with P struts oscillate.
RUBBLE_HD inline Vec6 lengthCurvature(Real f, const Vec3& n, Real size, const Vec3& r) {
  const Real force = absOf(f);
  if (f < Real(0) || !(size > kNoDistance)) {
    const Vec3 turn = turningColumnNorms(n, r);
    return {{0, 0, 0}, force * turn};
  }
  const auto project = [&](const Vec3& v) { return (v - n * dot(n, v)) / size; };
  Real lin[3], ang[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3 e = unitAxis(i), pe = project(e), re = cross(r, e), pre = project(re);
    const Vec3 turn = (n * r[i] + r * n[i]) / Real(2) - e * dot(n, r) - cross(r, pre);
    lin[i] = std::sqrt(lengthSquared(pe) + lengthSquared(cross(r, pe)));
    ang[i] = std::sqrt(lengthSquared(pre) + lengthSquared(turn));
  }
  return {{force * lin[0], force * lin[1], force * lin[2]}, {force * ang[0], force * ang[1], force * ang[2]}};
}

/// Distance of the anchors.
///
///   c = |d|, n = d / |d|                              [m], F [N], > 0: tension
///   J_A = [n, r_A x n],  J_B = -[n, r_B x n]
///   G: lengthCurvature with r_A, and with -r_B (B moves the other end of d: S changes its sign)
struct DistanceAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = true;

  template <class D> RUBBLE_HD static Vec3 span(const D& d, const Pose& a, const Pose& b) {
    return (a.p - b.p) + rotate(a.q, d.anchorA) - rotate(b.q, d.anchorB);
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M&, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    c[0] = length(span(d, a, b));
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    Vec3 n;
    direction(span(d, a, b), n);
    const Vec6 own{n, cross(anchorLever(d, side == 0 ? a : b, side), n)};
    j[0] = side == 0 ? own : -own;
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                  const Real (&f)[kRows]) {
    Vec3 n;
    const Real size = direction(span(d, a, b), n);
    // for B the span is -d, with direction -n
    return lengthCurvature(f[0], side == 0 ? n : -n, size, anchorLever(d, side == 0 ? a : b, side));
  }
};

}  // namespace rubble::RUBBLE_CORE
