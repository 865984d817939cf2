#include <cmath>
#include <utility>

#include <rubble/error.h>
#include <rubble/scene.h>

#include "cook/checks.h"

namespace rubble {

namespace {

using namespace checks;

void validateAxis(const JointAxis& axis, const std::string& path) {
  if (!(axis.min <= axis.max)) throw Error(path + ".min", "at most max, " + text(axis.max), text(axis.min));
  positiveOrInfinite(axis.limitStiffness, path + ".limitStiffness");
  notNegative(axis.limitDamping, path + ".limitDamping");
  finite(axis.targetPosition, path + ".targetPosition");
  finite(axis.targetSpeed, path + ".targetSpeed");
  notNegativeOrInfinite(axis.driveStiffness, path + ".driveStiffness");
  notNegativeOrInfinite(axis.driveDamping, path + ".driveDamping");
  notNegativeOrInfinite(axis.maxDriveForce, path + ".maxDriveForce");
  notNegativeOrInfinite(axis.friction, path + ".friction");
  if (!std::isfinite(axis.friction))
    throw Error(path + ".friction", "a finite number; equal limits lock an axis", text(axis.friction));
}

}  // namespace

void validate(const JointDef& joint, const std::string& path) {
  enumeration(joint.type, JointType::Grab, path + ".type");
  finite(joint.anchorA, path + ".anchorA");
  finite(joint.anchorB, path + ".anchorB");
  unit(joint.frameA, path + ".frameA");
  unit(joint.frameB, path + ".frameB");
  unit(joint.orientationAtoB, path + ".orientationAtoB");
  unit(joint.driveOrientation, path + ".driveOrientation");
  positiveOrInfinite(joint.stiffness, path + ".stiffness");
  positiveOrInfinite(joint.angularStiffness, path + ".angularStiffness");
  positiveOrInfinite(joint.breakForce, path + ".breakForce");
  positiveOrInfinite(joint.breakTorque, path + ".breakTorque");
  positiveOrInfinite(joint.maxForce, path + ".maxForce");
  positiveOrInfinite(joint.maxTorque, path + ".maxTorque");
  for (const auto& [value, name] : {std::pair{joint.damping, ".damping"},
                                    {joint.dampingRatio, ".dampingRatio"},
                                    {joint.angularDamping, ".angularDamping"},
                                    {joint.angularDampingRatio, ".angularDampingRatio"},
                                    {joint.friction, ".friction"}})
    notNegative(value, path + name);
  for (const auto& [value, name] : {std::pair{joint.driveStiffness, ".driveStiffness"},
                                    {joint.driveDamping, ".driveDamping"},
                                    {joint.maxDriveTorque, ".maxDriveTorque"}})
    notNegativeOrInfinite(value, path + name);
  if (joint.dampingRatio > 0 && joint.stiffness == kHard)
    throw Error(path + ".dampingRatio", "a stiffness beside it", "a hard joint");
  if (joint.angularDampingRatio > 0 && joint.angularStiffness == kHard)
    throw Error(path + ".angularDampingRatio", "an angularStiffness beside it", "a hard joint");
  finite(joint.ratio, path + ".ratio");
  if (joint.ratio == 0) throw Error(path + ".ratio", "a number other than 0", "0");
  if (joint.type == JointType::Pulley && joint.ratio < 0)
    throw Error(path + ".ratio", "a positive number for a pulley", text(joint.ratio));
  if (joint.type == JointType::Spring && joint.stiffness == kHard)
    throw Error(path + ".stiffness", "a finite stiffness for a spring", "hard");
  if (joint.type == JointType::Grab && joint.stiffness == kHard)
    throw Error(path + ".stiffness", "a finite stiffness for a grab", "hard");
  finite(joint.length, path + ".length");
  finite(joint.pulleyA, path + ".pulleyA");
  finite(joint.pulleyB, path + ".pulleyB");
  // a narrower cone must be a hinge
  constexpr double kNarrowest = 1e-3;
  for (const auto& [angle, name] : {std::pair{joint.swingY, ".swingY"}, {joint.swingZ, ".swingZ"}})
    if (!(angle >= kNarrowest)) throw Error(path + name, "an angle of at least 0.001 rad", text(angle));
  for (std::size_t i = 0; i < joint.axes.size(); ++i)
    validateAxis(joint.axes[i], path + ".axes[" + std::to_string(i) + "]");
}

const char* keyword(JointType type) {
  switch (type) {
    case JointType::Ball:
      return "ball";
    case JointType::Fixed:
      return "fixed";
    case JointType::Hinge:
      return "hinge";
    case JointType::Slider:
      return "slider";
    case JointType::Distance:
      return "distance";
    case JointType::Rope:
      return "rope";
    case JointType::Spring:
      return "spring";
    case JointType::AngularSpring:
      return "angular_spring";
    case JointType::SwingTwist:
      return "swing_twist";
    case JointType::Universal:
      return "universal";
    case JointType::SixDof:
      return "six_dof";
    case JointType::Gear:
      return "gear";
    case JointType::Rack:
      return "rack";
    case JointType::Pulley:
      return "pulley";
    case JointType::Grab:
      return "grab";
  }
  return "";
}

Quat frameAlong(const Vec3& x) {
  const Vec3 axis = normalize(x, Vec3{1, 0, 0});
  // The shortest rotation of the x axis; 180 degrees about z if that is not unique.
  if (axis.x < -1 + 1e-9) return {0, 0, 0, 1};
  return normalize(Quat{1 + axis.x, 0, -axis.z, axis.y});
}

namespace {

std::pair<Vec3, Quat> poseOf(const Scene& scene, int body) {
  if (body == kWorld) return {Vec3{}, Quat{}};
  const BodyDef& def = scene.bodies.at(static_cast<std::size_t>(body));
  return {def.position, normalize(def.orientation)};
}

/// The moving side and the frame body of a hinge or slider. If A is the world or a static body the roles of A
/// and B are swapped: B moves the same way about the opposite axis.
struct Moving {
  int body, carrier;
  Vec3 anchor;  ///< in the frame of the moving body
  Quat frame;   ///< in the frame of the moving body
};
Moving movingSide(const Scene& scene, int index, JointType type, const char* path) {
  if (index < 0 || static_cast<std::size_t>(index) >= scene.joints.size())
    throw Error(path, "the index of one of " + std::to_string(scene.joints.size()) + " joints",
                std::to_string(index));
  const JointDef& joint = scene.joints[static_cast<std::size_t>(index)];
  if (joint.type != type)
    throw Error(path, std::string("a ") + keyword(type), std::string("a ") + keyword(joint.type));
  const auto stands = [&](int body) {
    return body == kWorld || scene.bodies.at(static_cast<std::size_t>(body)).motion == Motion::Static;
  };
  const Quat a = poseOf(scene, joint.bodyA).second, b = poseOf(scene, joint.bodyB).second;
  const bool line = type == JointType::Slider;
  if (!stands(joint.bodyA))
    return {joint.bodyA, joint.bodyB, joint.anchorA,
            line ? normalize(conjugate(a) * b * joint.frameB) : joint.frameA};
  // 180 degrees about y
  return {joint.bodyB, joint.bodyA, joint.anchorB, normalize(joint.frameB * Quat{0, 0, 1, 0})};
}

JointDef coupling(JointType type, const Moving& a, const Moving& b, double ratio) {
  JointDef joint;
  joint.type = type;
  joint.bodyA = a.body, joint.bodyB = b.body;
  joint.carrierA = a.carrier, joint.carrierB = b.carrier;
  joint.anchorA = a.anchor, joint.anchorB = b.anchor;
  joint.frameA = a.frame, joint.frameB = b.frame;
  joint.ratio = ratio;
  return joint;
}

}  // namespace

JointDef jointAt(const Scene& scene, JointType type, int bodyA, int bodyB, const Vec3& point,
                 const Quat& frame) {
  const auto [pa, qa] = poseOf(scene, bodyA);
  const auto [pb, qb] = poseOf(scene, bodyB);
  JointDef joint;
  joint.type = type;
  joint.bodyA = bodyA, joint.bodyB = bodyB;
  joint.anchorA = rotateInverse(qa, point - pa);
  joint.anchorB = rotateInverse(qb, point - pb);
  joint.frameA = normalize(conjugate(qa) * frame);
  joint.frameB = normalize(conjugate(qb) * frame);
  joint.orientationAtoB = normalize(conjugate(qb) * qa);
  return joint;
}

JointDef gearBetween(const Scene& scene, int hingeA, int hingeB, double ratio) {
  return coupling(JointType::Gear, movingSide(scene, hingeA, JointType::Hinge, "hingeA"),
                  movingSide(scene, hingeB, JointType::Hinge, "hingeB"), ratio);
}
JointDef rackBetween(const Scene& scene, int hinge, int slider, double ratio) {
  return coupling(JointType::Rack, movingSide(scene, hinge, JointType::Hinge, "hinge"),
                  movingSide(scene, slider, JointType::Slider, "slider"), ratio);
}

}  // namespace rubble
