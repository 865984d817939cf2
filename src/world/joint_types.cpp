/// From the definitions by type to JointDef.
// Written by tools/make_joints.
// clang-format off
#include <algorithm>

#include <rubble/joint_types.h>

namespace rubble {

template <class J> static JointDef defOf(const J& joint, const char* type) {
  JointDef def;
  def.type = jointType(type);
  if constexpr (requires { joint.name; }) def.name = joint.name;
  if constexpr (requires { joint.bodyA; }) def.bodyA = joint.bodyA;
  if constexpr (requires { joint.bodyB; }) def.bodyB = joint.bodyB;
  if constexpr (requires { joint.frameBodyA; }) def.frameBodyA = joint.frameBodyA;
  if constexpr (requires { joint.frameBodyB; }) def.frameBodyB = joint.frameBodyB;
  if constexpr (requires { joint.anchorA; }) def.anchorA = joint.anchorA;
  if constexpr (requires { joint.anchorB; }) def.anchorB = joint.anchorB;
  if constexpr (requires { joint.frameA; }) def.frameA = joint.frameA;
  if constexpr (requires { joint.frameB; }) def.frameB = joint.frameB;
  if constexpr (requires { joint.orientationAtoB; }) def.orientationAtoB = joint.orientationAtoB;
  if constexpr (requires { joint.driveOrientation; }) def.driveOrientation = joint.driveOrientation;
  if constexpr (requires { joint.stiffness; }) def.stiffness = joint.stiffness;
  if constexpr (requires { joint.damping; }) def.damping = joint.damping;
  if constexpr (requires { joint.dampingRatio; }) def.dampingRatio = joint.dampingRatio;
  if constexpr (requires { joint.angularStiffness; }) def.angularStiffness = joint.angularStiffness;
  if constexpr (requires { joint.angularDamping; }) def.angularDamping = joint.angularDamping;
  if constexpr (requires { joint.angularDampingRatio; }) def.angularDampingRatio = joint.angularDampingRatio;
  if constexpr (requires { joint.maxForce; }) def.maxForce = joint.maxForce;
  if constexpr (requires { joint.maxTorque; }) def.maxTorque = joint.maxTorque;
  if constexpr (requires { joint.length; }) def.length = joint.length;
  if constexpr (requires { joint.ratio; }) def.ratio = joint.ratio;
  if constexpr (requires { joint.swingY; }) def.swingY = joint.swingY;
  if constexpr (requires { joint.swingZ; }) def.swingZ = joint.swingZ;
  if constexpr (requires { joint.friction; }) def.friction = joint.friction;
  if constexpr (requires { joint.driveStiffness; }) def.driveStiffness = joint.driveStiffness;
  if constexpr (requires { joint.driveDamping; }) def.driveDamping = joint.driveDamping;
  if constexpr (requires { joint.maxDriveTorque; }) def.maxDriveTorque = joint.maxDriveTorque;
  if constexpr (requires { joint.breakForce; }) def.breakForce = joint.breakForce;
  if constexpr (requires { joint.breakTorque; }) def.breakTorque = joint.breakTorque;
  if constexpr (requires { joint.pulleyA; }) def.pulleyA = joint.pulleyA;
  if constexpr (requires { joint.pulleyB; }) def.pulleyB = joint.pulleyB;
  if constexpr (requires { joint.collide; }) def.collide = joint.collide;
  if constexpr (requires { joint.userData; }) def.userData = joint.userData;
  if constexpr (requires { joint.axis; }) def.axes[0] = joint.axis;
  if constexpr (requires { joint.axes; }) std::ranges::copy(joint.axes, def.axes.begin());
  if constexpr (requires { joint.path; })
    def.own = TendonFields{joint.path, joint.terms, joint.wraps, joint.tilts};
  if constexpr (requires { joint.offsetB; })
    def.own = GimbalFields{joint.offsetB, joint.offsetA, joint.tiltB, joint.tiltA};
  return def;
}

BallJoint::operator JointDef() const { return defOf(*this, "ball"); }
FixedJoint::operator JointDef() const { return defOf(*this, "fixed"); }
HingeJoint::operator JointDef() const { return defOf(*this, "hinge"); }
SliderJoint::operator JointDef() const { return defOf(*this, "slider"); }
DistanceJoint::operator JointDef() const { return defOf(*this, "distance"); }
RopeJoint::operator JointDef() const { return defOf(*this, "rope"); }
SpringJoint::operator JointDef() const { return defOf(*this, "spring"); }
AngularSpringJoint::operator JointDef() const { return defOf(*this, "angular_spring"); }
SwingTwistJoint::operator JointDef() const { return defOf(*this, "swing_twist"); }
UniversalJoint::operator JointDef() const { return defOf(*this, "universal"); }
SixDofJoint::operator JointDef() const { return defOf(*this, "six_dof"); }
GearJoint::operator JointDef() const { return defOf(*this, "gear"); }
RackJoint::operator JointDef() const { return defOf(*this, "rack"); }
PulleyJoint::operator JointDef() const { return defOf(*this, "pulley"); }
DragJoint::operator JointDef() const { return defOf(*this, "drag"); }
TendonJoint::operator JointDef() const { return defOf(*this, "tendon"); }
GimbalJoint::operator JointDef() const { return defOf(*this, "gimbal"); }

}  // namespace rubble
