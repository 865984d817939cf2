#pragma once
/// Pulley: a rope from A over two fixed points in the world to B. d_i = x_i - o_i, n_i = d_i / |d_i|.
///
///   c = |d_A| + rho |d_B|                             [m], F [N] in the part of A, rho F in that of B
///   J_A = [n_A, r_A x n_A],  J_B = rho [n_B, r_B x n_B];  G_A, G_B: lengthCurvature with F and rho F
#include "forces/distance.h"

namespace rubble::RUBBLE_CORE {

struct PulleyAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = true;
  static constexpr Real kStiffnessShare = kCouplingShare;

  template <class D, class M>
  RUBBLE_HD static Vec3 span(const D& d, const M& m, const Pose& a, const Pose& b, int side) {
    return side == 0 ? a.p + rotate(a.q, d.anchorA) - m.overA : b.p + rotate(b.q, d.anchorB) - m.overB;
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    c[0] = length(span(d, m, a, b, 0)) + d.ratio * length(span(d, m, a, b, 1));
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M& m, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    Vec3 n;
    direction(span(d, m, a, b, side), n);
    j[0] = (side == 0 ? Real(1) : d.ratio) * Vec6{n, cross(anchorLever(d, side == 0 ? a : b, side), n)};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M& m, const Pose& a, const Pose& b, int side,
                                  const Real (&f)[kRows]) {
    Vec3 n;
    const Real size = direction(span(d, m, a, b, side), n);
    return lengthCurvature(side == 0 ? f[0] : d.ratio * f[0], n, size,
                           anchorLever(d, side == 0 ? a : b, side));
  }
};

struct PulleyJoint {
  static constexpr const char* kName = "pulley";
  static constexpr bool kGrounded = true;
  using Parts = PartList<PulleyAxis>;
  struct Memory {
    Vec3 overA, overB;  ///< o_A, o_B relative to p_B^t [m]
    template <class D> RUBBLE_HD void remember(const D& d, const Pose&, const Pose&, const Vec3d& origin) {
      overA = Vec3(d.pointA - origin);
      overB = Vec3(d.pointB - origin);
    }
  };
  struct Constants {
    rubble::Vec3 pointA, pointB;
    double ratio = 1;
  };
  struct Data {
    Vec3d pointA, pointB;   ///< o_A, o_B: points that the rope runs over, world [m]
    Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]
    Real ratio;             ///< rho [1]
    static Data of(const EngineJoint& j) {
      const auto own = j.constants.get<Constants>();
      return {own.pointA, own.pointB, Vec3(j.anchorA), Vec3(j.anchorB), Real(own.ratio)};
    }
  };
};

struct PulleyKind {
  using Joint = PulleyJoint;
  static constexpr JointType kType = JointType::Pulley;
  static constexpr const char* kName = "pulley";
  static constexpr const char* kDoc =
      "a rope from A over two points of the world to B: the length of A's part + ratio of B's has a largest "
      "value";
  static constexpr FieldRules kGiven{.always = true};
  static constexpr auto kFields = std::tuple_cat(
      LengthKind::kFields,
      std::tuple{
          field("pulley_a", "m", "point of the world that A's part runs over", &JointDef::pulleyA, kGiven),
          field("pulley_b", "m", "point of the world that B's part runs over", &JointDef::pulleyB, kGiven)},
      kRatioField);

  static void build(JointBuild& b) {
    const JointDef& def = b.def;
    JointAxis& axis = b.joint.axes[0];
    axis.targetPosition = b.lengthOr(length(b.bodies.a.point(def.anchorA) - def.pulleyA) +
                                     def.ratio * length(b.bodies.b.point(def.anchorB) - def.pulleyB));
    LengthKind::limit(b, axis);
    b.joint.isRigid = false;
    b.joint.constants.set(PulleyJoint::Constants{def.pulleyA, def.pulleyB, def.ratio});
  }
  static void check(const JointDef& def, const Path& path) {
    if (def.ratio < 0) throw Error(path + ".ratio", "a positive number for a pulley", numberText(def.ratio));
  }
};

}  // namespace rubble::RUBBLE_CORE
