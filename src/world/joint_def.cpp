#include <cmath>
#include <utility>

#include <rubble/error.h>
#include <rubble/joints.h>
#include <rubble/scene.h>
#include <rubble/world.h>

#include "cook/checks.h"
#include "world/joint_build.h"

namespace rubble {

namespace {

using namespace checks;

void validateAxis(const JointAxis& axis, const Path& path) {
  if (!(axis.min <= axis.max)) throw Error(path + ".min", "at most max, " + text(axis.max), text(axis.min));
  if (axis.friction > 0 && !std::isfinite(axis.friction))
    throw Error(path + ".friction", "a finite number; equal limits lock an axis", text(axis.friction));
  forEachField(kAxisFields, axis,
               [&](const FieldInfo& info, double value) { checks::field(info, value, path); });
}

}  // namespace

void validate(const JointDef& joint, const Path& path) {
  enumeration(static_cast<int>(joint.type), static_cast<int>(jointKinds().size()) - 1, path + ".type");
  const JointKind& kind = kindOf(joint.type);
  kind.check(joint, path);
  const auto check = [&](const JointField& info) {
    info.visit(joint, [&](const auto& value) { checks::field(info, value, path); });
  };
  for (const JointField& info : sharedJointFields()) check(info);
  for (const JointField& info : kind.ownFields) check(info);
  if (joint.dampingRatio > 0 && joint.stiffness == kHard)
    throw Error(path + ".dampingRatio", "a stiffness beside it", "a hard joint");
  if (joint.angularDampingRatio > 0 && joint.angularStiffness == kHard)
    throw Error(path + ".angularDampingRatio", "an angularStiffness beside it", "a hard joint");
  if (joint.ratio == 0) throw Error(path + ".ratio", "a number other than 0", "0");
  for (std::size_t i = 0; i < joint.axes.size(); ++i) validateAxis(joint.axes[i], (path + ".axes")[i]);
}

void checkFrameBody(JointType type, int body, int frameBody, const Path& path) {
  if (frameBody == kWorld) return;
  if (!kindOf(type).hasFrameBodies) throw Error(path, std::string("none for a ") + keyword(type), "a body");
  if (frameBody == body) throw Error(path, "another body than the one that moves in it", "the same");
}

const char* keyword(JointType type) {
  const auto at = static_cast<std::size_t>(type);
  return at < jointKinds().size() ? jointKinds()[at].name : "";
}
JointType jointType(const std::string& keyword) {
  for (const JointKind& kind : jointKinds())
    if (kind.name == keyword) return kind.type;
  throw Error("type", "the keyword of a joint type", "\"" + keyword + "\"");
}

Quat frameAlong(const Vec3& x) {
  const Vec3 axis = normalize(x, Vec3{1, 0, 0});
  // The shortest rotation of the x axis; 180 degrees about z if that is not unique.
  if (axis.x < -1 + 1e-9) return {0, 0, 0, 1};
  return normalize(Quat{1 + axis.x, 0, -axis.z, axis.y});
}

namespace {

/// Pose of the shape frame of a body, or of the world.
struct BodyPose {
  Vec3 position;
  Quat orientation;
};

BodyPose poseOf(const Scene& scene, int body) {
  if (body == kWorld) return {};
  if (body < 0 || static_cast<std::size_t>(body) >= scene.bodies.size())
    throw Error("body", "the index of one of " + std::to_string(scene.bodies.size()) + " bodies, or kWorld",
                std::to_string(body));
  const BodyDef& def = scene.bodies[static_cast<std::size_t>(body)];
  return {def.position, normalize(def.orientation)};
}

/// The joint at a world point with axes of the world.
JointDef placed(JointDef joint, const BodyPose& a, const BodyPose& b, const Vec3& point, const Quat& frame) {
  joint.anchorA = rotateInverse(a.orientation, point - a.position);
  joint.anchorB = rotateInverse(b.orientation, point - b.position);
  joint.frameA = normalize(conjugate(a.orientation) * frame);
  joint.frameB = normalize(conjugate(b.orientation) * frame);
  joint.orientationAtoB = normalize(conjugate(b.orientation) * a.orientation);
  return joint;
}

/// The moving side and the frame body of a hinge or slider. If A is the world or a static body the roles of A
/// and B are swapped: B moves the same way about the opposite axis.
struct Moving {
  int body, frameBody;
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
  const Quat a = poseOf(scene, joint.bodyA).orientation, b = poseOf(scene, joint.bodyB).orientation;
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
  joint.frameBodyA = a.frameBody, joint.frameBodyB = b.frameBody;
  joint.anchorA = a.anchor, joint.anchorB = b.anchor;
  joint.frameA = a.frame, joint.frameB = b.frame;
  joint.ratio = ratio;
  return joint;
}

}  // namespace

JointDef jointAt(const Scene& scene, JointDef joint, const Vec3& point, const Quat& frame) {
  const BodyPose a = poseOf(scene, joint.bodyA), b = poseOf(scene, joint.bodyB);
  return placed(std::move(joint), a, b, point, frame);
}
JointDef jointAt(const World& world, JointDef joint, BodyId bodyA, BodyId bodyB, const Vec3& point,
                 const Quat& frame) {
  const auto poseOf = [&](BodyId id) {
    if (id.index < 0) return BodyPose{};
    const BodyState now = world.state(id);
    return BodyPose{now.position, now.orientation};
  };
  return placed(std::move(joint), poseOf(bodyA), poseOf(bodyB), point, frame);
}
JointDef jointAt(const Scene& scene, JointType type, int bodyA, int bodyB, const Vec3& point,
                 const Quat& frame) {
  JointDef joint;
  joint.type = type;
  joint.bodyA = bodyA, joint.bodyB = bodyB;
  return jointAt(scene, std::move(joint), point, frame);
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
