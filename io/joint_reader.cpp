#include "io/joint_reader.h"

#include <cmath>

#include "io/body_reader.h"
#include "io/shape_json.h"

namespace rubble::io {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// `word` is infinite ("-word" for the lower side of a limit); else a number.
template <class Field> void readField(ObjectReader& object, const Field& field, double& out) {
  const auto node = object.get(field.key);
  if (!node) return;
  const std::string unit = std::string(" [") + field.unit + "]";
  const bool any = field.range == FieldRange::Any, positive = field.range == FieldRange::Positive;
  const std::string text = std::string("a number") +
                           (any        ? ""
                            : positive ? " above 0"
                                       : " of at least 0") +
                           unit + (field.word ? std::string(", or \"") + field.word + "\"" : "");
  if (field.word && node->value().is_string() && node->value().template get<std::string>() == field.word)
    out = std::isinf(out) && out < 0 ? -kInfinity : kInfinity;
  else
    out = node->number({any ? -kInfinity : 0, !positive, kInfinity, text.c_str()}).value_or(out);
}

struct Placed {
  Vec3 position;
  Quat orientation;
};
Placed poseOf(const Scene& scene, int index) {
  if (index == kWorld) return {};
  const BodyDef& body = scene.bodies[static_cast<std::size_t>(index)];
  return {body.position, body.orientation};
}

void readAnchors(ObjectReader& object, JointDef& joint, const Scene& scene) {
  const auto anchor = object.get("anchor");
  object.read("anchor_a", joint.anchorA);
  object.read("anchor_b", joint.anchorB);
  const bool own = object.get("anchor_a") || object.get("anchor_b");
  const bool needed = joint.type != JointType::Gear && joint.type != JointType::AngularSpring;
  if (anchor && own)
    anchor->faultText(
        "expected either \"anchor\" (a point of the world) or \"anchor_a\" and \"anchor_b\", got both");
  if (needed && !anchor && !own)
    object.node().faultText(
        "expected \"anchor\", a point of the world [m], or \"anchor_a\" and \"anchor_b\", got none");
  if (!anchor || own) return;
  const Vec3 point = anchor->vector().value_or(Vec3{});
  const Placed a = poseOf(scene, joint.bodyA), b = poseOf(scene, joint.bodyB);
  joint.anchorA = rotateInverse(a.orientation, point - a.position);
  joint.anchorB = rotateInverse(b.orientation, point - b.position);
}

/// The axes: "axis" or "frame" in the world as the scene begins ("axis_b": another one for B), or "frame_a"
/// and "frame_b" on the bodies.
void readFrames(ObjectReader& object, JointDef& joint, const Scene& scene) {
  const Quat a = poseOf(scene, joint.bodyA).orientation, b = poseOf(scene, joint.bodyB).orientation;
  const auto direction = [](const Node& node) {
    const Vec3 axis = node.vector().value_or(Vec3{1, 0, 0});
    if (axis == Vec3{}) node.faultText("expected a direction, got zeros");
    return frameAlong(axis);
  };
  Quat inWorldA, inWorldB;
  if (const auto axis = object.get("axis")) inWorldA = inWorldB = direction(*axis);
  if (const auto axis = object.get("axis_b")) inWorldB = direction(*axis);
  if (const auto frame = object.get("frame")) inWorldA = inWorldB = readOrientation(*frame);
  if (usesFrames(joint.type)) {
    joint.frameA = normalize(conjugate(a) * inWorldA);
    joint.frameB = normalize(conjugate(b) * inWorldB);
  }
  if (const auto frame = object.get("frame_a")) joint.frameA = readOrientation(*frame);
  if (const auto frame = object.get("frame_b")) joint.frameB = readOrientation(*frame);
}

bool keepsOrientation(JointType type) {
  return type == JointType::Fixed || type == JointType::Slider || type == JointType::AngularSpring;
}

void readAxes(ObjectReader& object, JointDef& joint) {
  const auto found = object.get("axes");
  if (!found) return;
  const std::size_t most = axesInFile(joint.type);
  const std::vector<Node> elements = found->elements("a list of axes");
  if (elements.size() > most)
    found->faultText("expected up to " + std::to_string(most) + " axes for a joint of this type, got " +
                     std::to_string(elements.size()));
  for (std::size_t i = 0; i < elements.size() && i < most; ++i) {
    JointAxis& axis = joint.axes[i];
    ObjectReader reader(elements[i], "an axis");
    bool locked = false;
    reader.read("locked", locked);
    if (locked) axis.min = axis.max = 0;
    for (const AxisField& field : axisFields()) readField(reader, field, axis.*field.member);
    reader.finish();
  }
}

}  // namespace

bool usesFrames(JointType type) {
  switch (type) {
    case JointType::Hinge:
    case JointType::Slider:
    case JointType::SwingTwist:
    case JointType::Universal:
    case JointType::SixDof:
    case JointType::Gear:
    case JointType::Rack:
      return true;
    default:
      return false;
  }
}

std::size_t axesInFile(JointType type) {
  switch (type) {
    case JointType::SixDof:
      return 6;
    case JointType::SwingTwist:
      return 2;
    case JointType::Ball:
    case JointType::Fixed:
    case JointType::AngularSpring:
    case JointType::Universal:
    case JointType::Grab:
      return 0;
    default:
      return 1;
  }
}

const std::vector<std::string>& jointKeywords() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (int type = 0; type <= static_cast<int>(JointType::Grab); ++type)
      all.emplace_back(keyword(static_cast<JointType>(type)));
    return all;
  }();
  return names;
}

const std::vector<JointField>& jointFields() {
  static const std::vector<JointField> fields = {
      {"stiffness", &JointDef::stiffness, FieldRange::Positive, "hard", "N/m",
       "of the anchors or of the length"},
      {"damping", &JointDef::damping, FieldRange::NotNegative, nullptr, "N s/m", "beside a stiffness"},
      {"damping_ratio", &JointDef::dampingRatio, FieldRange::NotNegative, nullptr, "1",
       "in place of damping: of critical, for the two bodies alone"},
      {"angular_stiffness", &JointDef::angularStiffness, FieldRange::Positive, "hard", "N m/rad",
       "of the orientation"},
      {"angular_damping", &JointDef::angularDamping, FieldRange::NotNegative, nullptr, "N m s/rad",
       "beside an angular stiffness"},
      {"angular_damping_ratio", &JointDef::angularDampingRatio, FieldRange::NotNegative, nullptr, "1",
       "in place of angular damping"},
      {"max_force", &JointDef::maxForce, FieldRange::Positive, "hard", "N",
       "ball, fixed, grab: the anchors are held with this force at most"},
      {"max_torque", &JointDef::maxTorque, FieldRange::Positive, "hard", "N m",
       "fixed, angular_spring: the orientation is held with this torque at most"},
      {"length", &JointDef::length, FieldRange::Any, nullptr, "m",
       "distance, rope, spring, pulley; below 0: as it is at the beginning"},
      {"ratio", &JointDef::ratio, FieldRange::Any, nullptr, "1",
       "gear, pulley; rack: travel of B for a radian of A [m]"},
      {"swing_y", &JointDef::swingY, FieldRange::Positive, "free", "rad",
       "swing_twist: half angle of the cone about y"},
      {"swing_z", &JointDef::swingZ, FieldRange::Positive, "free", "rad",
       "swing_twist: half angle of the cone about z"},
      {"friction", &JointDef::friction, FieldRange::NotNegative, nullptr, "N m",
       "ball, swing_twist: torque that resists any turn"},
      {"drive_stiffness", &JointDef::driveStiffness, FieldRange::NotNegative, "hard", "N m/rad",
       "swing_twist: towards drive_orientation"},
      {"drive_damping", &JointDef::driveDamping, FieldRange::NotNegative, nullptr, "N m s/rad",
       "swing_twist"},
      {"max_drive_torque", &JointDef::maxDriveTorque, FieldRange::NotNegative, "hard", "N m", "swing_twist"},
      {"break_force", &JointDef::breakForce, FieldRange::Positive, "never", "N",
       "the joint breaks when its force reaches this"},
      {"break_torque", &JointDef::breakTorque, FieldRange::Positive, "never", "N m",
       "the joint breaks when its torque reaches this"},
  };
  return fields;
}

const std::vector<AxisField>& axisFields() {
  static const std::vector<AxisField> fields = {
      {"min", &JointAxis::min, FieldRange::Any, "free", "m, rad", "lower limit"},
      {"max", &JointAxis::max, FieldRange::Any, "free", "m, rad", "upper limit; equal ones lock the axis"},
      {"limit_stiffness", &JointAxis::limitStiffness, FieldRange::Positive, "hard", "N/m, N m/rad",
       "of the limits"},
      {"limit_damping", &JointAxis::limitDamping, FieldRange::NotNegative, nullptr, "N s/m, N m s/rad",
       "of limits with a stiffness"},
      {"target_position", &JointAxis::targetPosition, FieldRange::Any, nullptr, "m, rad", "of the drive"},
      {"target_speed", &JointAxis::targetSpeed, FieldRange::Any, nullptr, "m/s, rad/s", "of the drive"},
      {"drive_stiffness", &JointAxis::driveStiffness, FieldRange::NotNegative, "hard", "N/m, N m/rad",
       "towards the target position; 0: none"},
      {"drive_damping", &JointAxis::driveDamping, FieldRange::NotNegative, "hard", "N s/m, N m s/rad",
       "towards the target speed; 0: none; hard: a motor"},
      {"max_drive_force", &JointAxis::maxDriveForce, FieldRange::NotNegative, "hard", "N, N m",
       "largest force of the drive"},
      {"friction", &JointAxis::friction, FieldRange::NotNegative, nullptr, "N, N m",
       "resists any motion, up to this"},
  };
  return fields;
}

void readJoint(ObjectReader& object, JointDef& out, const Scene& scene) {
  readAnchors(object, out, scene);
  readFrames(object, out, scene);
  const auto given = object.get("orientation_a_to_b");
  if (given) {
    out.orientationAtoB = readOrientation(*given);
    if (!keepsOrientation(out.type))
      given->faultText(
          "expected only for a joint of type \"fixed\", \"slider\" or \"angular_spring\", got one for "
          "another");
  } else if (keepsOrientation(out.type)) {
    out.orientationAtoB = normalize(conjugate(poseOf(scene, out.bodyB).orientation) *
                                    poseOf(scene, out.bodyA).orientation);
  }
  if (const auto found = object.get("drive_orientation")) out.driveOrientation = readOrientation(*found);
  object.read("pulley_a", out.pulleyA);
  object.read("pulley_b", out.pulleyB);
  readJointValues(object, out);
}

void readJointValues(ObjectReader& object, JointDef& out) {
  for (const JointField& field : jointFields()) readField(object, field, out.*field.member);
  readAxes(object, out);
  object.read("collide", out.collide);
}

}  // namespace rubble::io
