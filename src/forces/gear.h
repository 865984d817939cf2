#pragma once
/// Gear: couples the rotations of two bodies about their axes. Each axis is fixed in a carrier (the housing,
/// the arm of planets, or the world). theta_i is the twist of Q_i = q_i f_i about x relative to W_i =
/// q_carrier,i w_i, continued over full revolutions.
///
///   c = theta_A + rho theta_B                         [rad], F [N m] on A, rho F on B; the reaction acts on
///                                                     the carriers
///   J_A = R(W_A) g_A,  J_carrier,A = -J_A,  J_B = rho R(W_B) g_B,  J_carrier,B = -J_B
///   G: twistCurvature with F, rho F
///
/// All moments add up to zero, so a floating gearbox conserves its momentum.
#include "forces/angular_parts.h"

namespace rubble::RUBBLE_CORE {

/// World frame of a wheel's axis, and the frame of the wheel relative to it.
RUBBLE_HD inline Quat carriedAxis(const CarriedPose& x, const Quat& base) { return x.carrier.q * base; }
RUBBLE_HD inline Quat seenFromCarrier(const CarriedPose& x, const Quat& base, const Quat& frame) {
  return shortArc(conjugate(carriedAxis(x, base)) * x.q * frame);
}

/// dtheta/dx of a wheel or of its carrier, and column norms of f theta.
RUBBLE_HD inline Vec3 turnGradient(const CarriedPose& x, const Quat& base, const Quat& frame,
                                   bool ofCarrier) {
  const Vec3 g = rotate(carriedAxis(x, base), twistGradient(seenFromCarrier(x, base, frame)));
  return ofCarrier ? -g : g;
}
RUBBLE_HD inline Vec6 turnCurvature(const CarriedPose& x, const Quat& base, const Quat& frame, Real f) {
  return {{0, 0, 0}, twistCurvature(carriedAxis(x, base), twistGradient(seenFromCarrier(x, base, frame)), f)};
}

struct GearAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = true;
  static constexpr Real kStiffnessShare = kCouplingShare;

  template <class D, class M> RUBBLE_HD static double turns(const D& d, const M& m) {
    return m.twistA.turned() + static_cast<double>(d.ratio) * m.twistB.turned();
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const CarriedPose& a, const CarriedPose& b,
                                   Real (&c)[kRows]) {
    c[0] = m.twistA.nearest(twistAngle(seenFromCarrier(a, d.baseA, d.frameA))) +
           d.ratio * m.twistB.nearest(twistAngle(seenFromCarrier(b, d.baseB, d.frameB)));
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const CarriedPose& a, const CarriedPose& b, int side,
                                 Vec6 (&j)[kRows]) {
    j[0] = {{0, 0, 0},
            (side & 1) == 0 ? turnGradient(a, d.baseA, d.frameA, side >= 2)
                            : d.ratio * turnGradient(b, d.baseB, d.frameB, side >= 2)};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const CarriedPose& a, const CarriedPose& b, int side,
                                  const Real (&f)[kRows]) {
    return (side & 1) == 0 ? turnCurvature(a, d.baseA, d.frameA, f[0])
                           : turnCurvature(b, d.baseB, d.frameB, d.ratio * f[0]);
  }
};

struct GearJoint {
  static constexpr const char* kName = "gear";
  static constexpr bool kGrounded = false, kCarried = true;
  using Parts = PartList<GearAxis>;
  struct Memory {
    TurnCounter twistA, twistB;
    template <class D>
    RUBBLE_HD void remember(const D& d, const CarriedPose& a, const CarriedPose& b, const Vec3d&) {
      twistA.follow(twistAngle(seenFromCarrier(a, d.baseA, d.frameA)));
      twistB.follow(twistAngle(seenFromCarrier(b, d.baseB, d.frameB)));
    }
  };
  struct Data {
    Quat frameA, frameB;  ///< joint -> body; x is the axis
    Quat baseA, baseB;    ///< joint -> carrier; the twist is 0 where both agree
    Real ratio;           ///< rho: revolutions of A per revolution of B, in the opposite direction [1]
  };
};

}  // namespace rubble::RUBBLE_CORE
