#pragma once
/// Rack and pinion: A rotates about an axis and B travels along a line. Axis and line are fixed in the
/// frame bodies of A and B, or in the world. theta as for gears. With p, R of the frame body of B, the
/// direction of the line is u = R t and its origin o = p + R s:
///
///   c = rho theta - u.d,  d = x_B - o                 [m], F [N];  rho: travel for a radian [m]
///   J_A = rho [0, R(W) g],  J_frame,A = -J_A,  J_B = -[u, r_B x u],  J_frame,B = [u, (x_B - p) x u]
///   G_A, G_frame,A: twistCurvature with rho F;  G_B, G_frame,B: travelCurvature with F u
#include "forces/gear.h"
#include "forces/linear_parts.h"

namespace rubble::RUBBLE_CORE {

struct RackAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = true;
  static constexpr Real kStiffnessShare = kCouplingShare;

  /// The travel of B in its frame body is that of an anchor of A in the frame of B in travelJacobian; so B
  /// takes the place of A there.
  struct Line {
    Vec3 anchorA;
  };
  template <class D> RUBBLE_HD static Vec3 along(const D& d, const FrameBodyPose& b) {
    return rotate(b.frameBody.q, d.direction);
  }

  template <class D, class M> RUBBLE_HD static double turns(const D& d, const M& m) {
    return static_cast<double>(d.ratio) * m.twist.turned();
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const FrameBodyPose& a, const FrameBodyPose& b,
                                   Real (&c)[kRows]) {
    const Vec3 way = (b.p - b.frameBody.p) + rotate(b.q, d.anchorB) - rotate(b.frameBody.q, m.begin);
    c[0] = d.ratio * m.twist.nearest(twistAngle(inFrameBody(a, d.baseA, d.frameA))) - dot(along(d, b), way);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const FrameBodyPose& a, const FrameBodyPose& b,
                                 int side, Vec6 (&j)[kRows]) {
    if ((side & 1) == 0)
      j[0] = {{0, 0, 0}, d.ratio * turnGradient(a, d.baseA, d.frameA, side >= 2)};
    else
      j[0] = -travelJacobian(Line{d.anchorB}, b, b.frameBody, side >= 2, along(d, b));
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const FrameBodyPose& a, const FrameBodyPose& b,
                                  int side, const Real (&f)[kRows]) {
    if ((side & 1) == 0) return turnCurvature(a, d.baseA, d.frameA, d.ratio * f[0]);
    return travelCurvature(Line{d.anchorB}, b, b.frameBody, side >= 2, f[0] * along(d, b));
  }
};

struct RackJoint {
  static constexpr const char* kName = "rack";
  static constexpr bool kGrounded = false, kHasFrameBodies = true;
  using Parts = PartList<RackAxis>;
  struct Memory {
    RevolutionCounter twist;
    Vec3 begin;  ///< s: o in the frame of B's frame body, or relative to p_B^t if the frame body is the world
                 ///< [m]
    template <class D>
    RUBBLE_HD void remember(const D& d, const FrameBodyPose& a, const FrameBodyPose&, const Vec3d& origin) {
      twist.follow(twistAngle(inFrameBody(a, d.baseA, d.frameA)));
      begin = Vec3(d.inWorld != 0 ? d.pointB - origin : d.pointB);
    }
  };
  struct Data {
    Vec3d pointB;           ///< o in the frame of B's frame body, or in the world [m]
    Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]; that of A is unused
    Quat frameA;            ///< joint -> A; x is the axis
    Quat baseA;             ///< joint -> frame body of A; the twist is 0 where both agree
    Vec3 direction;         ///< t, unit, in the frame of B's frame body
    Real ratio;             ///< rho [m]
    int inWorld;            ///< 1: the frame body of B is the world
    static Data of(const EngineJoint& j) {
      const auto own = j.constants.get<CoupledConstants>();
      return {own.pointB,      Vec3(j.anchorA),       Vec3(j.anchorB),
              Quat(j.frameA),  Quat(own.baseA),       Vec3(rotate(own.baseB, rubble::Vec3{1, 0, 0})),
              Real(own.ratio), j.frameBodyB == kWorld};
    }
  };
};

struct RackKind {
  using Joint = RackJoint;
  static constexpr JointType kType = JointType::Rack;
  static constexpr const char* kName = "rack";
  static constexpr const char* kDoc =
      "turn of A about an axis and travel of B along a line, both fixed in frame bodies: ratio theta - "
      "travel "
      "is kept";
  static constexpr auto kFields = std::tuple_cat(kAnchorFields, kFrameFields, kRatioField, kStiffnessField,
                                                 kDampingFields, kBreakForceField);
  static void build(JointBuild& b) { buildCoupling(b); }
};

}  // namespace rubble::RUBBLE_CORE
