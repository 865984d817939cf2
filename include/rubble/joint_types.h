#pragma once
/// Joint definitions by type. Each has the members of JointDef that its type reads, with their defaults, and
/// becomes a JointDef where one is wanted: world.addJoint(HingeJoint{.axis = {.max = 1.5}}, door, frame).
// Written by tools/make_joints.
// clang-format off
#include <rubble/scene.h>

namespace rubble {

/// Ball joint: two anchors coincide.
struct BallJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double maxForce = kHard;  ///< the anchors are held with this force at most, or kHard [N]
  double friction = 0;  ///< torque that resists any turn [N m]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Fixed joint: two anchors coincide and the relative orientation is kept.
struct FixedJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  Quat orientationAtoB = {};  ///< wanted orientation of A seen from B, a unit quaternion
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double angularStiffness = kHard;  ///< of the orientation, or kHard [N m/rad]
  double angularDamping = 0;  ///< beside an angular stiffness [N m s/rad]
  double angularDampingRatio = 0;  ///< in place of angular damping
  double maxForce = kHard;  ///< the anchors are held with this force at most, or kHard [N]
  double maxTorque = kHard;  ///< the orientation is held with this torque at most, or kHard [N m]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  /// the joint breaks when its torque reaches this, or kUnbreakable [N m]
  double breakTorque = kUnbreakable;
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Hinge: A turns about the x axis of the joint, counted over whole turns.
struct HingeJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  Quat frameA = {};  ///< axes of the joint on A, a unit quaternion
  Quat frameB = {};  ///< axes of the joint on B
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double angularStiffness = kHard;  ///< of the orientation, or kHard [N m/rad]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  /// the joint breaks when its torque reaches this, or kUnbreakable [N m]
  double breakTorque = kUnbreakable;
  JointAxis axis = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Slider: A travels along the x axis of the joint and does not turn.
struct SliderJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  Quat frameA = {};  ///< axes of the joint on A, a unit quaternion
  Quat frameB = {};  ///< axes of the joint on B
  Quat orientationAtoB = {};  ///< wanted orientation of A seen from B, a unit quaternion
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double angularStiffness = kHard;  ///< of the orientation, or kHard [N m/rad]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  /// the joint breaks when its torque reaches this, or kUnbreakable [N m]
  double breakTorque = kUnbreakable;
  JointAxis axis = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// The anchors keep a distance.
struct DistanceJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double length = -1;  ///< below 0: as it is at the beginning [m]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  JointAxis axis = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// The anchors keep a largest distance.
struct RopeJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double length = -1;  ///< below 0: as it is at the beginning [m]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  JointAxis axis = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Spring and damper between the anchors.
struct SpringJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double length = -1;  ///< below 0: as it is at the beginning [m]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  JointAxis axis = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Spring and damper towards a relative orientation; the anchors are free.
struct AngularSpringJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Quat orientationAtoB = {};  ///< wanted orientation of A seen from B, a unit quaternion
  double angularStiffness = kHard;  ///< of the orientation, or kHard [N m/rad]
  double angularDamping = 0;  ///< beside an angular stiffness [N m s/rad]
  double angularDampingRatio = 0;  ///< in place of angular damping
  double maxTorque = kHard;  ///< the orientation is held with this torque at most, or kHard [N m]
  /// the joint breaks when its torque reaches this, or kUnbreakable [N m]
  double breakTorque = kUnbreakable;
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Ball joint whose x axis swings in a cone and twists within limits.
struct SwingTwistJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  Quat frameA = {};  ///< axes of the joint on A, a unit quaternion
  Quat frameB = {};  ///< axes of the joint on B
  Quat driveOrientation = {};  ///< wanted orientation of A's frame seen from B's
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double maxForce = kHard;  ///< the anchors are held with this force at most, or kHard [N]
  double swingY = kFree;  ///< half angle of the cone about y, or kFree [rad]
  double swingZ = kFree;  ///< half angle of the cone about z, or kFree [rad]
  double friction = 0;  ///< torque that resists any turn [N m]
  double driveStiffness = 0;  ///< towards drive_orientation, or kHard [N m/rad]
  double driveDamping = 0;  ///< of that drive, or kHard [N m s/rad]
  double maxDriveTorque = kHard;  ///< of that drive, or kHard [N m]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  /// the joint breaks when its torque reaches this, or kUnbreakable [N m]
  double breakTorque = kUnbreakable;
  std::array<JointAxis, 2> axes = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Two shafts (x axes) joined by a cross of A's y and B's z axis.
struct UniversalJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  Quat frameA = {};  ///< axes of the joint on A, a unit quaternion
  Quat frameB = {};  ///< axes of the joint on B
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double angularStiffness = kHard;  ///< of the orientation, or kHard [N m/rad]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  /// the joint breaks when its torque reaches this, or kUnbreakable [N m]
  double breakTorque = kUnbreakable;
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Travel along and turn about three axes, each free, limited, locked or driven.
struct SixDofJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  Quat frameA = {};  ///< axes of the joint on A, a unit quaternion
  Quat frameB = {};  ///< axes of the joint on B
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  /// the joint breaks when its torque reaches this, or kUnbreakable [N m]
  double breakTorque = kUnbreakable;
  std::array<JointAxis, 6> axes = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// The turns of A and B about axes fixed in frame bodies: theta_A + ratio theta_B is kept.
struct GearJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  int frameBodyA = kWorld;
  int frameBodyB = kWorld;
  Quat frameA = {};  ///< axes of the joint on A, a unit quaternion
  Quat frameB = {};  ///< axes of the joint on B
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double ratio = 1;  ///< between the motion of A and of B; rack: travel of B for a radian of A [m]
  /// the joint breaks when its torque reaches this, or kUnbreakable [N m]
  double breakTorque = kUnbreakable;
  JointAxis axis = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Turn of A about an axis and travel of B along a line, both fixed in frame bodies: ratio theta - travel is
/// kept.
struct RackJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  int frameBodyA = kWorld;
  int frameBodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  Quat frameA = {};  ///< axes of the joint on A, a unit quaternion
  Quat frameB = {};  ///< axes of the joint on B
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double ratio = 1;  ///< between the motion of A and of B; rack: travel of B for a radian of A [m]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  JointAxis axis = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// A rope from A over two points of the world to B: the length of A's part + ratio of B's has a largest
/// value.
struct PulleyJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double length = -1;  ///< below 0: as it is at the beginning [m]
  double ratio = 1;  ///< between the motion of A and of B; rack: travel of B for a radian of A [m]
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  Vec3 pulleyA = {};  ///< point of the world that A's part runs over [m]
  Vec3 pulleyB = {};  ///< point of the world that B's part runs over [m]
  JointAxis axis = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Soft drag of A's anchor to B's, with a largest force.
struct DragJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  double stiffness = kHard;  ///< of the anchors or of the length, or kHard [N/m]
  double damping = 0;  ///< beside a stiffness [N s/m]
  double dampingRatio = 0;  ///< in place of damping: of critical, for the two bodies alone
  double maxForce = kHard;  ///< the anchors are held with this force at most, or kHard [N]
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Length over points of up to four bodies, and functions of the coordinates between them.
struct TendonJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  int frameBodyA = kWorld;
  int frameBodyB = kWorld;
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  /// five numbers for each point: side, x, y, z, weight of the segment [1, m]
  std::vector<double> path = {};
  /// thirteen numbers for each coordinate: kind, sides, axis, anchor, c_1-4 [1, m]
  std::vector<double> terms = {};
  /// thirteen numbers for each sphere or cylinder that the path goes around [1, m]
  std::vector<double> wraps = {};
  /// two numbers for each coordinate: tilts of the gimbal that it is an angle of [rad]
  std::vector<double> tilts = {};
  JointAxis axis = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

/// Three hinges in a row, about z of B, an axis between them and x of A; travel along axes of B.
struct GimbalJoint {
  std::string name = {};
  int bodyA = kWorld;
  int bodyB = kWorld;
  Vec3 anchorA = {};  ///< point on body A, in its frame [m]
  Vec3 anchorB = {};  ///< point on body B, in its frame [m]
  Quat frameA = {};  ///< axes of the joint on A, a unit quaternion
  Quat frameB = {};  ///< axes of the joint on B
  double breakForce = kUnbreakable;  ///< the joint breaks when its force reaches this, or kUnbreakable [N]
  /// the joint breaks when its torque reaches this, or kUnbreakable [N m]
  double breakTorque = kUnbreakable;
  Vec3 offsetB = {};  ///< from anchor B to the second axis, in the frame of B at angles of 0 [m]
  Vec3 offsetA = {};  ///< from there to anchor A, likewise [m]
  double tiltB = 0;  ///< 90 degrees less the angle between the first and the second axis [rad]
  double tiltA = 0;  ///< 90 degrees less the angle between the second and the third axis [rad]
  std::array<JointAxis, 6> axes = {};
  bool collide = false;
  std::uint64_t userData = 0;
  operator JointDef() const;
};

}  // namespace rubble
