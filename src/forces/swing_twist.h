#pragma once
/// Ball joint with limits: the anchors coincide (AnchorRows); A's x axis swings inside a cone about B's
/// (DirectionAxis<SwingCone>) and twists between limits (TwistAxis); a drive pulls to an orientation
/// (DriveRows) and friction resists any turn (TurnFrictionRows).
#include "forces/hinge.h"

namespace rubble::RUBBLE_CORE {

/// The rows of OrientationRows between the joint's frames, towards data.driveTarget: e = Q_B^-1 Q_A, in the
/// axes of B's frame.
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

/// The same towards the relative orientation at x^t: any turn is an error, and the bound on its force is the
/// torque of friction.
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
    Quat start;  ///< frame of A seen from B at x^t
    template <class D> RUBBLE_HD void remember(const D& d, const Pose& a, const Pose& b, const Vec3d&) {
      start = frameAInB(d, a, b);
      twist.follow(twistAngle(start));
    }
  };
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frame of their body [m]
    Quat frameA, frameB;    ///< joint -> body
    Quat driveTarget;       ///< frame of A seen from B
    Real coneY, coneZ;      ///< shape of the cone, see SwingCone [1]
  };
};

}  // namespace rubble::RUBBLE_CORE
