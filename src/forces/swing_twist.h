#pragma once
/// Ball joint with limits: the anchors coincide (AnchorRows). The x axis of A swings within a cone about that
/// of B (DirectionAxis<SwingCone>) and twists within limits (TwistAxis). A drive acts toward an orientation
/// (DriveRows), and friction against any rotation (AngularFrictionRows).
#include <cmath>
#include <numbers>

#include "forces/hinge.h"
#include "math/portable.h"

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
struct AngularFrictionRows {
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
  using Parts = PartList<AnchorRows, DriveRows, AngularFrictionRows, DirectionAxis<SwingCone>, TwistAxis>;
  struct Memory {
    RevolutionCounter twist;
    Quat start;  ///< joint frame of A relative to that of B, at x^t
    template <class D> RUBBLE_HD void remember(const D& d, const Pose& a, const Pose& b, const Vec3d&) {
      start = frameAInB(d, a, b);
      twist.follow(twistAngle(start));
    }
  };
  struct Constants {
    rubble::Quat driveTarget;
    double coneY = 1, coneZ = 1;
  };
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]
    Quat frameA, frameB;    ///< joint -> body
    Quat driveTarget;       ///< joint frame of A relative to that of B
    Real coneY, coneZ;      ///< factors of the elliptic cone, see SwingCone [1]
    static Data of(const EngineJoint& j) {
      const auto own = j.constants.get<Constants>();
      return {Vec3(j.anchorA),       Vec3(j.anchorB), Quat(j.frameA), Quat(j.frameB),
              Quat(own.driveTarget), Real(own.coneY), Real(own.coneZ)};
    }
  };
};

struct SwingTwistKind {
  using Joint = SwingTwistJoint;
  static constexpr JointType kType = JointType::SwingTwist;
  static constexpr const char* kName = "swing_twist";
  static constexpr const char* kDoc = "ball joint whose x axis swings in a cone and twists within limits";
  static constexpr FieldRules kAngle{FieldRange::Positive, "free"};
  static constexpr auto kFields = std::tuple_cat(
      kAnchorFields, kFrameFields, kStiffnessField, kDampingFields, kMaxForceField,
      std::tuple{field("swing_y", "rad", "half angle of the cone about y", &JointDef::swingY, kAngle),
                 field("swing_z", "rad", "half angle of the cone about z", &JointDef::swingZ, kAngle)},
      kFrictionField,
      std::tuple{field("drive_orientation", "1", "wanted orientation of A's frame seen from B's",
                       &JointDef::driveOrientation),
                 field("drive_stiffness", "N m/rad", "towards drive_orientation", &JointDef::driveStiffness,
                       kDrives),
                 field("drive_damping", "N m s/rad", "of that drive", &JointDef::driveDamping, kDrives),
                 field("max_drive_torque", "N m", "of that drive", &JointDef::maxDriveTorque, kDrives)},
      kBreakFields);

  static void build(JointBuild& b) {
    const JointDef& def = b.def;
    EngineGroup drive{GroupMode::Hold, def.driveStiffness, def.driveDamping, def.maxDriveTorque};
    if (!(def.driveStiffness > 0 || def.driveDamping > 0) || !(b.moment() > 0)) drive = b.off();
    b.joint.groups = {b.anchors(), drive, b.friction()};
    // With one direction free the cone is nearly half a revolution wide there, so that the other limit is
    // unchanged.
    constexpr double kWidest = .999 * std::numbers::pi;
    const double y = portable::tan(std::min(def.swingY, kWidest) / 2),
                 z = portable::tan(std::min(def.swingZ, kWidest) / 2), wide = std::max(y, z);
    b.joint.constants.set(SwingTwistJoint::Constants{normalize(def.driveOrientation), wide / y, wide / z});
    b.joint.axes[0].min = -kFree;
    b.joint.axes[0].max = def.swingY == kFree && def.swingZ == kFree ? kFree : 2 * portable::atan(wide);
  }
  static void check(const JointDef& def, const Path& path) {
    // a narrower cone must be a hinge
    constexpr double kNarrowest = 1e-3;
    for (const auto& [angle, name] : {std::pair{def.swingY, ".swingY"}, {def.swingZ, ".swingZ"}})
      if (!(angle >= kNarrowest))
        throw Error(path + name, "an angle of at least 0.001 rad", numberText(angle));
  }
};

}  // namespace rubble::RUBBLE_CORE
