#pragma once
/// Gear: couples the rotations of two bodies about their axes. Each axis is fixed in a frame body (the
/// housing, the arm of planets, or the world). theta_i is the twist of Q_i = q_i f_i about x relative to W_i
/// = q_frame,i w_i, continued over full revolutions.
///
///   c = theta_A + rho theta_B                         [rad], F [N m] on A, rho F on B; the reaction acts on
///                                                     the frame bodies
///   J_A = R(W_A) g_A,  J_frame,A = -J_A,  J_B = rho R(W_B) g_B,  J_frame,B = -J_B
///   G: twistCurvature with F, rho F
///
/// All moments add up to zero, so a floating gearbox conserves its momentum.
#include "forces/angular_parts.h"

namespace rubble::RUBBLE_CORE {

/// World frame of a wheel's axis, and the frame of the wheel relative to it.
RUBBLE_HD inline Quat axisInFrame(const FrameBodyPose& x, const Quat& base) { return x.frameBody.q * base; }
RUBBLE_HD inline Quat inFrameBody(const FrameBodyPose& x, const Quat& base, const Quat& frame) {
  return shortArc(conjugate(axisInFrame(x, base)) * x.q * frame);
}

/// dtheta/dx of a wheel or of its frame body, and column norms of f theta.
RUBBLE_HD inline Vec3 turnGradient(const FrameBodyPose& x, const Quat& base, const Quat& frame,
                                   bool ofFrameBody) {
  const Vec3 g = rotate(axisInFrame(x, base), twistGradient(inFrameBody(x, base, frame)));
  return ofFrameBody ? -g : g;
}
RUBBLE_HD inline Vec6 turnCurvature(const FrameBodyPose& x, const Quat& base, const Quat& frame, Real f) {
  return {{0, 0, 0}, twistCurvature(axisInFrame(x, base), twistGradient(inFrameBody(x, base, frame)), f)};
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
  RUBBLE_HD static void constraint(const D& d, const M& m, const FrameBodyPose& a, const FrameBodyPose& b,
                                   Real (&c)[kRows]) {
    c[0] = m.twistA.nearest(twistAngle(inFrameBody(a, d.baseA, d.frameA))) +
           d.ratio * m.twistB.nearest(twistAngle(inFrameBody(b, d.baseB, d.frameB)));
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const FrameBodyPose& a, const FrameBodyPose& b,
                                 int side, Vec6 (&j)[kRows]) {
    j[0] = {{0, 0, 0},
            (side & 1) == 0 ? turnGradient(a, d.baseA, d.frameA, side >= 2)
                            : d.ratio * turnGradient(b, d.baseB, d.frameB, side >= 2)};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const FrameBodyPose& a, const FrameBodyPose& b,
                                  int side, const Real (&f)[kRows]) {
    return (side & 1) == 0 ? turnCurvature(a, d.baseA, d.frameA, f[0])
                           : turnCurvature(b, d.baseB, d.frameB, d.ratio * f[0]);
  }
};

/// Constants of gears and racks, whose axes are fixed in frame bodies when the joint is made.
struct CoupledConstants {
  rubble::Quat baseA, baseB;
  rubble::Vec3 pointB;  ///< racks: anchor of B in its frame body [m]
  double ratio = 1;
};

struct GearJoint {
  static constexpr const char* kName = "gear";
  static constexpr bool kGrounded = false, kHasFrameBodies = true;
  using Parts = PartList<GearAxis>;
  struct Memory {
    RevolutionCounter twistA, twistB;
    template <class D>
    RUBBLE_HD void remember(const D& d, const FrameBodyPose& a, const FrameBodyPose& b, const Vec3d&) {
      twistA.follow(twistAngle(inFrameBody(a, d.baseA, d.frameA)));
      twistB.follow(twistAngle(inFrameBody(b, d.baseB, d.frameB)));
    }
  };
  struct Data {
    Quat frameA, frameB;  ///< joint -> body; x is the axis
    Quat baseA, baseB;    ///< joint -> frame body; the twist is 0 where both agree
    Real ratio;           ///< rho: revolutions of A per revolution of B, in the opposite direction [1]
    static Data of(const EngineJoint& j) {
      const auto own = j.constants.get<CoupledConstants>();
      return {Quat(j.frameA), Quat(j.frameB), Quat(own.baseA), Quat(own.baseB), Real(own.ratio)};
    }
  };
};

/// Builds a gear or a rack.
inline void buildCoupling(JointBuild& b) {
  const JointDef& def = b.def;
  const JointBodies& at = b.bodies;
  const auto base = [](const JointBodyState& frameBody, const JointBodyState& body,
                       const rubble::Quat& frame) {
    return normalize(conjugate(frameBody.orientation) * body.orientation * frame);
  };
  CoupledConstants own{
      base(at.frameBodyA, at.a, def.frameA), base(at.frameBodyB, at.b, def.frameB),
      rotateInverse(at.frameBodyB.orientation, at.b.point(def.anchorB) - at.frameBodyB.position), 0};
  if (b.before) own = b.before->constants.get<CoupledConstants>();
  own.ratio = def.ratio;
  b.joint.constants.set(own);
  b.joint.isRigid = false;
  JointAxis& axis = b.joint.axes[0];
  // an axis without limits is locked: a gear without coupling has no use
  if (axis.min == -kFree && axis.max == kFree) axis.min = axis.max = 0;
  axis.limitStiffness = def.stiffness;
  axis.limitDamping = def.damping;
}

struct GearKind {
  using Joint = GearJoint;
  static constexpr JointType kType = JointType::Gear;
  static constexpr const char* kName = "gear";
  static constexpr const char*
      kDoc = "the turns of A and B about axes fixed in frame bodies: theta_A + ratio theta_B is kept";
  static constexpr auto kFields = std::tuple_cat(kFrameFields, kRatioField, kStiffnessField, kDampingFields,
                                                 kBreakTorqueField);
  static void build(JointBuild& b) { buildCoupling(b); }
};

}  // namespace rubble::RUBBLE_CORE
