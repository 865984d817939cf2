#include "world/joint_build.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rubble/error.h>

namespace rubble {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

Vec3 worldPoint(const JointBodyState& body, const Vec3& local) {
  return body.position + rotate(body.orientation, local);
}

/// Reduced mass of two bodies. If one of them is static it is the mass of the other.
double reduced(double a, double b) { return a > 0 && b > 0 ? a * b / (a + b) : std::max(a, b); }

/// Moment of inertia about a world axis through the joint, or its mean over all axes if there is no axis.
double momentAbout(const JointBodyState& body, const Vec3& anchor, const Vec3* axis) {
  if (!(body.mass.mass > 0)) return 0;
  const Vec3 lever = rotate(body.orientation, anchor);
  if (!axis) {
    const Vec3& i = body.mass.inertia;
    return (i.x + i.y + i.z) / 3 + body.mass.mass * 2 * dot(lever, lever) / 3;
  }
  const Vec3 local = rotateInverse(body.orientation, *axis), across = cross(*axis, lever);
  return dot(local, mul(body.mass.inertia, local)) + body.mass.mass * dot(across, across);
}

double dampingOf(double damping, double ratio, double stiffness, double inertia) {
  return ratio > 0 ? 2 * ratio * std::sqrt(stiffness * inertia) : damping;
}

EngineGroup off() { return {EngineGroup::Mode::Off, kHard, 0, kHard}; }

class Builder {
 public:
  Builder(const JointDef& def, const JointBodies& bodies, const EngineJoint* before)
      : def_(def), bodies_(bodies), before_(before) {}
  EngineJoint build();

 private:
  double mass() const { return reduced(bodies_.a.mass.mass, bodies_.b.mass.mass); }
  double moment(const Vec3* axis) const {
    return reduced(momentAbout(bodies_.a, def_.anchorA, axis), momentAbout(bodies_.b, def_.anchorB, axis));
  }
  EngineGroup anchors() const {
    return {EngineGroup::Mode::Hold, def_.stiffness,
            dampingOf(def_.damping, def_.dampingRatio, def_.stiffness, mass()), def_.maxForce};
  }
  EngineGroup orientation() const {
    return {EngineGroup::Mode::Hold, def_.angularStiffness,
            dampingOf(def_.angularDamping, def_.angularDampingRatio, def_.angularStiffness, moment(nullptr)),
            def_.maxTorque};
  }
  void useAxes() { joint_.axes.assign(def_.axes.begin(), def_.axes.begin() + axisCount(def_.type)); }
  void lengthJoint();
  bool hasNoLength(double wanted) const;
  void swingTwist();
  void sixDof();
  void geared();

  const JointDef& def_;
  const JointBodies& bodies_;
  const EngineJoint* before_;
  EngineJoint joint_;
};

/// Distance, rope, spring, pulley: the only coordinate is a length.
void Builder::lengthJoint() {
  double now = length(worldPoint(bodies_.a, def_.anchorA) - worldPoint(bodies_.b, def_.anchorB));
  if (def_.type == JointType::Pulley)
    now = length(worldPoint(bodies_.a, def_.anchorA) - def_.pulleyA) +
          def_.ratio * length(worldPoint(bodies_.b, def_.anchorB) - def_.pulleyB);
  // as measured when the joint was made
  if (before_) now = before_->axes[0].targetPosition;
  const double wanted = def_.length < 0 ? now : def_.length;
  useAxes();
  JointAxis& axis = joint_.axes[0];
  // kept for later edits; only springs are driven toward it
  axis.targetPosition = wanted;
  joint_.isRigid = def_.type == JointType::Distance && def_.stiffness == kHard;
  const bool isPoint = def_.type != JointType::Pulley && hasNoLength(wanted);
  if (def_.type != JointType::Pulley) {
    joint_.groups = {anchors()};
    if (!isPoint) joint_.groups[0].mode = EngineGroup::Mode::Point;
  }
  if (isPoint) return;
  const double damping = dampingOf(def_.damping, def_.dampingRatio, def_.stiffness, mass());
  if (def_.type == JointType::Spring) {
    axis.driveStiffness = def_.stiffness;
    axis.driveDamping = damping;
  } else {
    axis.max = wanted;
    if (def_.type == JointType::Distance) axis.min = wanted;
    axis.limitStiffness = def_.stiffness;
    axis.limitDamping = damping;
  }
}

/// Returns whether a length is round-off relative to the lever arms and body sizes of the joint.
bool Builder::hasNoLength(double wanted) const {
  constexpr double kRoundOff = 1e-6;
  const auto size = [](const JointBodyState& body, const Vec3& anchor) {
    const Vec3& i = body.mass.inertia;
    return length(anchor) + (body.mass.mass > 0 ? std::sqrt((i.x + i.y + i.z) / (3 * body.mass.mass)) : 0);
  };
  const double a = size(bodies_.a, def_.anchorA), b = size(bodies_.b, def_.anchorB);
  return wanted <= kRoundOff * std::max(a, b);
}

void Builder::swingTwist() {
  joint_.type = EngineJointType::SwingTwist;
  const double inertia = moment(nullptr);
  EngineGroup drive{EngineGroup::Mode::Hold, def_.driveStiffness, def_.driveDamping, def_.maxDriveTorque};
  if (!(def_.driveStiffness > 0 || def_.driveDamping > 0) || def_.type == JointType::Ball || !(inertia > 0))
    drive = off();
  EngineGroup friction{EngineGroup::Mode::Friction, kHard, 0, def_.friction};
  if (!(def_.friction > 0)) friction = off();
  joint_.groups = {anchors(), drive, friction};
  joint_.driveTarget = normalize(def_.driveOrientation);
  joint_.axes.assign(2, {});
  if (def_.type == JointType::Ball) return;
  useAxes();
  // With one direction free the cone is nearly half a revolution wide there, so that the other limit is
  // unchanged.
  constexpr double kWidest = .999 * std::numbers::pi;
  const double y = std::tan(std::min(def_.swingY, kWidest) / 2),
               z = std::tan(std::min(def_.swingZ, kWidest) / 2), wide = std::max(y, z);
  joint_.coneY = wide / y, joint_.coneZ = wide / z;
  joint_.axes[0].min = -kFree;
  joint_.axes[0].max = def_.swingY == kFree && def_.swingZ == kFree ? kFree : 2 * std::atan(wide);
}

/// If exactly one rotation is not locked, permutes the axes so that it is about x. Only that angle counts
/// whole revolutions.
void Builder::sixDof() {
  const auto locked = [&](std::size_t i) { return def_.axes[i].min == def_.axes[i].max; };
  joint_.isRigid = locked(0) && locked(1) && locked(2);
  const bool x = locked(3), y = locked(4), z = locked(5);
  joint_.turned = x && !y && z ? 1 : x && y && !z ? 2 : 0;
  joint_.axes.resize(6);
  for (std::size_t i = 0; i < 6; ++i)
    joint_.axes[i] = def_.axes[i / 3 * 3 + (i + static_cast<std::size_t>(joint_.turned)) % 3];
  // cyclic permutation x -> y -> z: a rotation by 120 degrees about the diagonal
  const Quat third = joint_.turned == 0   ? Quat{}
                     : joint_.turned == 1 ? Quat{.5, .5, .5, .5}
                                          : Quat{-.5, .5, .5, .5};
  joint_.frameA = normalize(joint_.frameA * third);
  joint_.frameB = normalize(joint_.frameB * third);
}

/// The axes of gears and racks are fixed in their frame bodies when the joint is made.
void Builder::geared() {
  useAxes();
  joint_.isRigid = false;
  const JointBodyState &ca = bodies_.carrierA, &cb = bodies_.carrierB;
  joint_.baseA = before_ ? before_->baseA
                         : normalize(conjugate(ca.orientation) * bodies_.a.orientation * def_.frameA);
  joint_.baseB = before_ ? before_->baseB
                         : normalize(conjugate(cb.orientation) * bodies_.b.orientation * def_.frameB);
  joint_.direction = rotate(joint_.baseB, Vec3{1, 0, 0});
  joint_.pointB = before_ ? before_->pointB
                          : rotateInverse(cb.orientation, worldPoint(bodies_.b, def_.anchorB) - cb.position);
  JointAxis& axis = joint_.axes[0];
  // an axis without limits is locked: a gear without coupling has no use
  if (axis.min == -kFree && axis.max == kFree) axis.min = axis.max = 0;
  axis.limitStiffness = def_.stiffness;
  axis.limitDamping = def_.damping;
}

EngineJoint Builder::build() {
  EngineJoint& j = joint_;
  j.alive = true;
  j.anchorA = def_.anchorA, j.anchorB = def_.anchorB;
  j.frameA = normalize(def_.frameA), j.frameB = normalize(def_.frameB);
  j.aToB = normalize(def_.orientationAtoB);
  j.pointA = def_.pulleyA, j.pointB = def_.pulleyB;
  j.ratio = def_.ratio;
  j.breakForce = def_.breakForce, j.breakTorque = def_.breakTorque;
  const EngineGroup hard{EngineGroup::Mode::Hold, def_.stiffness, 0, kNever},
      stiff{EngineGroup::Mode::Hold, def_.angularStiffness, 0, kNever};
  switch (def_.type) {
    case JointType::Ball:
      j.type = EngineJointType::Ball;
      j.groups = {anchors()};
      if (def_.friction > 0) swingTwist();
      break;
    case JointType::Grab:
      j.type = EngineJointType::Ball;
      j.groups = {anchors()};
      j.isRigid = false;
      break;
    case JointType::Fixed:
      j.type = EngineJointType::Fixed;
      j.groups = {anchors(), orientation()};
      break;
    case JointType::AngularSpring:
      j.type = EngineJointType::Fixed;
      j.groups = {off(), orientation()};
      j.isRigid = false;
      break;
    case JointType::Hinge:
      j.type = EngineJointType::Hinge;
      j.groups = {hard, stiff};
      useAxes();
      break;
    case JointType::Slider:
      j.type = EngineJointType::Slider;
      j.groups = {hard, stiff};
      useAxes();
      break;
    case JointType::Distance:
    case JointType::Rope:
    case JointType::Spring:
      j.type = EngineJointType::Distance;
      lengthJoint();
      break;
    case JointType::Pulley:
      j.type = EngineJointType::Pulley;
      lengthJoint();
      break;
    case JointType::SwingTwist:
      swingTwist();
      break;
    case JointType::Universal:
      j.type = EngineJointType::Universal;
      j.groups = {hard, stiff};
      break;
    case JointType::SixDof:
      j.type = EngineJointType::SixDof;
      sixDof();
      break;
    case JointType::Gear:
      j.type = EngineJointType::Gear;
      geared();
      break;
    case JointType::Rack:
      j.type = EngineJointType::Rack;
      geared();
      break;
  }
  return j;
}

}  // namespace

int axisCount(JointType type) {
  switch (type) {
    case JointType::Hinge:
    case JointType::Slider:
    case JointType::Distance:
    case JointType::Rope:
    case JointType::Spring:
    case JointType::Gear:
    case JointType::Rack:
    case JointType::Pulley:
      return 1;
    case JointType::SwingTwist:
      return 2;
    case JointType::SixDof:
      return 6;
    default:
      return 0;
  }
}

bool hasLength(JointType type) {
  return type == JointType::Distance || type == JointType::Rope || type == JointType::Spring ||
         type == JointType::Pulley;
}

void checkCarrier(JointType type, int body, int carrier, const std::string& path) {
  if (carrier == kWorld) return;
  if (type != JointType::Gear && type != JointType::Rack)
    throw Error(path, std::string("none for a ") + keyword(type), "a body");
  if (carrier == body) throw Error(path, "another body than the one that moves in it", "the same");
}

EngineJoint engineJoint(const JointDef& def, const JointBodies& bodies, const EngineJoint* before) {
  return Builder(def, bodies, before).build();
}

}  // namespace rubble
