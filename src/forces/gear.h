#pragma once
/// Gear: the turns of two bodies about axes that are fixed in the world go together. theta_i: twist of Q_i = q_i f_i about x of the frame W_i,
/// which the world keeps; both counted over whole turns.
///
///   c = theta_A + rho theta_B                         [rad], F [N m] on A, rho F on B; the bearings take the reaction
///   J_A = R(W_A) g_A,  J_B = rho R(W_B) g_B;  G_A, G_B: twistCurvature with F, rho F
#include "forces/angular_parts.h"

namespace rubble::RUBBLE_CORE {

/// frame of a body seen from the world's frame of its axis
RUBBLE_HD inline Quat seenFromBase(const Quat& base, const Quat& body, const Quat& frame) { return shortArc(conjugate(base) * body * frame); }

struct GearAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = true;
  static constexpr Real kStiffnessShare = kCouplingShare;

  template <class D, class M>
  RUBBLE_HD static double turns(const D& d, const M& m) { return m.twistA.turned() + static_cast<double>(d.ratio) * m.twistB.turned(); }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    c[0] = m.twistA.nearest(twistAngle(seenFromBase(d.baseA, a.q, d.frameA))) +
           d.ratio * m.twistB.nearest(twistAngle(seenFromBase(d.baseB, b.q, d.frameB)));
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side, Vec6 (&j)[kRows]) {
    j[0] = {{0, 0, 0}, side == 0 ? rotate(d.baseA, twistGradient(seenFromBase(d.baseA, a.q, d.frameA)))
                                 : d.ratio * rotate(d.baseB, twistGradient(seenFromBase(d.baseB, b.q, d.frameB)))};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int side, const Real (&f)[kRows]) {
    return {{0, 0, 0}, side == 0 ? twistCurvature(d.baseA, twistGradient(seenFromBase(d.baseA, a.q, d.frameA)), f[0])
                                 : twistCurvature(d.baseB, twistGradient(seenFromBase(d.baseB, b.q, d.frameB)), d.ratio * f[0])};
  }
};

struct GearJoint {
  static constexpr const char* kName = "gear";
  static constexpr bool kGrounded = true;
  using Parts = PartList<GearAxis>;
  struct Memory {
    TurnCounter twistA, twistB;
    template <class D>
    RUBBLE_HD void remember(const D& d, const Pose& a, const Pose& b, const Vec3d&) {
      twistA.follow(twistAngle(seenFromBase(d.baseA, a.q, d.frameA)));
      twistB.follow(twistAngle(seenFromBase(d.baseB, b.q, d.frameB)));
    }
  };
  struct Data {
    Quat frameA, frameB;  ///< joint -> body: x is the axis
    Quat baseA, baseB;    ///< the same axes in the world, where the angles are 0
    Real ratio;           ///< rho: turns of A for each turn of B, the other way [1]
  };
};

}  // namespace rubble::RUBBLE_CORE
