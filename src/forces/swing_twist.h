#pragma once
/// Ball joint with limits: the anchors coincide (AnchorRows). The x axis of A swings within a cone about that
/// of B (DirectionAxis<SwingCone>) and twists within limits (TwistAxis). A drive acts toward an orientation
/// (DriveRows), and friction against any rotation (TurnFrictionRows).
#include "forces/hinge.h"

namespace rubble::RUBBLE_CORE {

/// OrientationRows between the joint frames, toward data.driveTarget: e = Q_B^-1 Q_A, in the axes of B's
/// joint frame.
struct DriveRows {
  static constexpr int kRows = 3;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = false;

  template <class D> RUBBLE_HD static Quat error(const D& d, const Pose& a, const Pose& b) {
    return deviation(frameOfA(d, a), frameOfB(d, b), d.driveTarget);
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M&, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    orientationError(error(d, a, b), c);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    orientationJacobian(error(d, a, b), frameOfB(d, b), side, j);
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int,
                                  const Real (&f)[kRows]) {
    return orientationCurvature(error(d, a, b), f);
  }
};

/// The same toward the relative orientation at x^t: any rotation is an error, and the bound is the friction
/// torque.
struct TurnFrictionRows {
  static constexpr int kRows = 3;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = false;

  template <class D, class M>
  RUBBLE_HD static Quat error(const D& d, const M& m, const Pose& a, const Pose& b) {
    return deviation(frameOfA(d, a), frameOfB(d, b), m.start);
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    orientationError(error(d, m, a, b), c);
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M& m, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    orientationJacobian(error(d, m, a, b), frameOfB(d, b), side, j);
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M& m, const Pose& a, const Pose& b, int,
                                  const Real (&f)[kRows]) {
    return orientationCurvature(error(d, m, a, b), f);
  }
};

struct SwingTwistJoint {
  static constexpr const char* kName = "swing_twist";
  static constexpr bool kGrounded = false;
  using Parts = PartList<AnchorRows, DriveRows, TurnFrictionRows, DirectionAxis<SwingCone>, TwistAxis>;
  struct Memory {
    TurnCounter twist;
    Quat start;  ///< joint frame of A relative to that of B, at x^t
    template <class D> RUBBLE_HD void remember(const D& d, const Pose& a, const Pose& b, const Vec3d&) {
      start = frameAInB(d, a, b);
      twist.follow(twistAngle(start));
    }
  };
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]
    Quat frameA, frameB;    ///< joint -> body
    Quat driveTarget;       ///< joint frame of A relative to that of B
    Real coneY, coneZ;      ///< factors of the elliptic cone, see SwingCone [1]
  };
};

}  // namespace rubble::RUBBLE_CORE
