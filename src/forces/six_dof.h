#pragma once
/// Six degrees of freedom, each free, limited or locked, with its own drive and friction: travel along the
/// axes of B's joint frame (TravelAxis) and three rotations. Those of a six_dof joint are twist about x
/// (TwistAxis) and swing about y and z (DirectionAxis), those of a gimbal are Cardan angles.
#include "forces/hinge.h"

namespace rubble::RUBBLE_CORE {

/// Cardan angles of e, the frame of A in that of B: R(e) = R_z(q_2) R_y(q_1) R_x(q_0), with q_1 within 90
/// degrees. They turn about z of B, the line of nodes n, and x of A. With u = n x z and t = tan q_1:
///
///   g_0 = u / cos q_1,  g_1 = n,  g_2 = t u + z                         J_A = R(Q_B) g,  J_B = -J_A
///   d2q_0 = sym(n (g_2 + t u)^T) / cos q_1,  d2q_1 = -sym(u g_2^T)
///   d2q_2 = sym(n (t g_2 + u / cos^2 q_1)^T)
struct CardanAngles {
  Real cosine, tangent;  ///< of q_1
  Vec3 nodes, across;    ///< n and u, in the frame of B
  Real angle[3];         ///< [rad]

  RUBBLE_HD explicit CardanAngles(const Quat& e) {
    // floor of cos q_1: the outer two angles are undefined where q_1 is 90 degrees
    constexpr Real kFloor = Real(.05);
    const Vec3 x = rotate(e, Vec3{1, 0, 0}), y = rotate(e, Vec3{0, 1, 0}), z = rotate(e, Vec3{0, 0, 1});
    const Real along = std::sqrt(x.x * x.x + x.y * x.y);
    across = along > Real(0) ? Vec3{x.x / along, x.y / along, 0} : Vec3{1, 0, 0};
    nodes = {-across.y, across.x, 0};
    cosine = max(along, kFloor), tangent = -x.z / cosine;
    angle[0] = signedAngleOf(y.z, z.z), angle[1] = signedAngleOf(-x.z, along),
    angle[2] = signedAngleOf(x.y, x.x);
  }
  RUBBLE_HD Vec3 gradient(int i) const {
    return i == 0 ? across / cosine : i == 1 ? nodes : tangent * across + Vec3{0, 0, 1};
  }
  /// The second derivative is sym(left right^T), in the frame of B.
  RUBBLE_HD Vec3 left(int i) const { return i == 1 ? -across : nodes; }
  RUBBLE_HD Vec3 right(int i) const {
    const Vec3 outer = gradient(2);
    return i == 0   ? (outer + tangent * across) / cosine
           : i == 1 ? outer
                    : tangent * outer + across / (cosine * cosine);
  }
  /// Its column norms in world axes, times a force.
  RUBBLE_HD Vec3 curvature(int i, const Quat& frameB, Real force) const {
    return absOf(force) * symmetricColumnNorms(rotate(frameB, left(i)), rotate(frameB, right(i)));
  }
};

/// Rotation I of a joint with six degrees of freedom: `Plain`, or a Cardan angle if data.isGimbal.
template <int I, class Plain> struct SixDofTurn {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = true;

  template <class D, class M> RUBBLE_HD static double turns(const D&, const M& m) requires(I == 0) {
    return m.twist.turned();
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    if (!d.isGimbal) return Plain::constraint(d, m, a, b, c);
    c[0] = CardanAngles(frameAInB(d, a, b)).angle[I];
    if constexpr (I == 0) c[0] = m.twist.nearest(c[0]);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M& m, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    if (!d.isGimbal) return Plain::jacobian(d, m, a, b, side, j);
    const Vec3 g = rotate(frameOfB(d, b), CardanAngles(frameAInB(d, a, b)).gradient(I));
    j[0] = {{0, 0, 0}, side == 0 ? g : -g};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M& m, const Pose& a, const Pose& b, int side,
                                  const Real (&f)[kRows]) {
    if (!d.isGimbal) return Plain::curvature(d, m, a, b, side, f);
    return {{0, 0, 0}, CardanAngles(frameAInB(d, a, b)).curvature(I, frameOfB(d, b), f[0])};
  }
};

struct SixDofJoint {
  static constexpr const char* kName = "six_dof";
  static constexpr bool kGrounded = false;
  using Parts = PartList<TravelAxis<0>, TravelAxis<1>, TravelAxis<2>, SixDofTurn<0, TwistAxis>,
                         SixDofTurn<1, DirectionAxis<SwingY>>, SixDofTurn<2, DirectionAxis<SwingZ>>>;
  struct Constants {
    int isGimbal = 0;
  };
  struct Data : FramedData {
    int isGimbal;  ///< 0, 1: the rotations are Cardan angles
    static Data of(const EngineJoint& j) {
      return {FramedData::of(j), j.constants.get<Constants>().isGimbal};
    }
  };
  struct Memory {
    RevolutionCounter twist;  ///< of the rotation about x
    template <class D> RUBBLE_HD void remember(const D& d, const Pose& a, const Pose& b, const Vec3d&) {
      const Quat e = frameAInB(d, a, b);
      twist.follow(d.isGimbal ? CardanAngles(e).angle[0] : twistAngle(e));
    }
  };
};

/// If only one rotation is free, x must be its axis: only the twist continues beyond half a revolution.
struct SixDofKind {
  using Joint = SixDofJoint;
  static constexpr JointType kType = JointType::SixDof;
  static constexpr const char* kName = "six_dof";
  static constexpr const char*
      kDoc = "travel along and turn about three axes, each free, limited, locked or driven";
  static constexpr auto kFields = std::tuple_cat(kAnchorFields, kFrameFields, kBreakFields);

  static bool isLocked(const JointBuild& b, std::size_t axis) {
    return b.def.axes[axis].min == b.def.axes[axis].max;
  }
  static bool isRigid(const JointBuild& b) { return isLocked(b, 0) && isLocked(b, 1) && isLocked(b, 2); }
  /// If exactly one rotation is not locked, permutes the axes so that it is about x. Only that angle counts
  /// whole revolutions.
  static void build(JointBuild& b) {
    EngineJoint& j = b.joint;
    j.isRigid = isRigid(b);
    const bool x = isLocked(b, 3), y = isLocked(b, 4), z = isLocked(b, 5);
    j.turned = x && !y && z ? 1 : x && y && !z ? 2 : 0;
    for (std::size_t i = 0; i < 6; ++i)
      j.axes[i] = b.def.axes[i / 3 * 3 + (i + static_cast<std::size_t>(j.turned)) % 3];
    // cyclic permutation x -> y -> z: a rotation by 120 degrees about the diagonal
    const rubble::Quat third = j.turned == 0   ? rubble::Quat{}
                               : j.turned == 1 ? rubble::Quat{.5, .5, .5, .5}
                                               : rubble::Quat{-.5, .5, .5, .5};
    j.frameA = normalize(j.frameA * third);
    j.frameB = normalize(j.frameB * third);
  }
};

/// Three hinges in a row, as in gimbals and robots: the turns about z, y and x are their angles, however far
/// the others are turned, unless that about y reaches 90 degrees.
struct GimbalKind {
  using Joint = SixDofJoint;
  static constexpr const char* kName = "gimbal";
  static constexpr const char*
      kDoc = "three hinges in a row, about z of B, y between them and x of A; and travel along the axes of B";
  static constexpr auto kFields = SixDofKind::kFields;
  static void build(JointBuild& b) {
    b.joint.isRigid = SixDofKind::isRigid(b);
    b.joint.constants.set(SixDofJoint::Constants{1});
  }
};

}  // namespace rubble::RUBBLE_CORE
