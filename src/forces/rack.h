#pragma once
/// Rack and pinion: A turns about an axis that is fixed in the world, B travels along a direction t of the world. theta as for gears.
///
///   c = rho theta - t.(x_B - o)                       [m], F [N];  rho: travel for a radian [m], o: where B's anchor began
///   J_A = rho [0, R(W) g],  J_B = -[t, r_B x t];  G_A: twistCurvature with rho F, G_B = -F S(t, r_B)
#include "forces/gear.h"
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

struct RackAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = true;
  static constexpr Real kStiffnessShare = kCouplingShare;

  template <class D, class M>
  RUBBLE_HD static double turns(const D& d, const M& m) { return static_cast<double>(d.ratio) * m.twist.turned(); }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    const Vec3 way = b.p + rotate(b.q, d.anchorB) - m.begin;
    c[0] = d.ratio * m.twist.nearest(twistAngle(seenFromBase(d.baseA, a.q, d.frameA))) - dot(d.direction, way);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side, Vec6 (&j)[kRows]) {
    if (side == 0)
      j[0] = {{0, 0, 0}, d.ratio * rotate(d.baseA, twistGradient(seenFromBase(d.baseA, a.q, d.frameA)))};
    else
      j[0] = -Vec6{d.direction, cross(rotate(b.q, d.anchorB), d.direction)};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int side, const Real (&f)[kRows]) {
    if (side == 0) return {{0, 0, 0}, twistCurvature(d.baseA, twistGradient(seenFromBase(d.baseA, a.q, d.frameA)), d.ratio * f[0])};
    return {{0, 0, 0}, turningColumnNorms(f[0] * d.direction, rotate(b.q, d.anchorB))};
  }
};

struct RackJoint {
  static constexpr const char* kName = "rack";
  static constexpr bool kGrounded = true;
  using Parts = PartList<RackAxis>;
  struct Memory {
    TurnCounter twist;
    Vec3 begin;  ///< o, from p_B^t [m]
    template <class D>
    RUBBLE_HD void remember(const D& d, const Pose& a, const Pose&, const Vec3d& origin) {
      twist.follow(twistAngle(seenFromBase(d.baseA, a.q, d.frameA)));
      begin = Vec3(d.pointB - origin);
    }
  };
  struct Data {
    Vec3d pointB;      ///< o, world [m]
    Vec3 anchorA, anchorB;  ///< in the frame of their body [m]; A's is not used
    Quat frameA;       ///< joint -> A: x is the axis
    Quat baseA;        ///< the same axis in the world, where the angle is 0
    Vec3 direction;    ///< t, unit, world
    Real ratio;        ///< rho [m]
  };
};

}  // namespace rubble::RUBBLE_CORE
