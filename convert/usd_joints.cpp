/// Joints of USD: PhysicsRevoluteJoint and the like, with PhysicsLimitAPI and PhysicsDriveAPI.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <rubble/error.h>

#include "convert/usd_reader.h"

namespace rubble::convert {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::array kAxes{"transX", "transY", "transZ", "rotX", "rotY", "rotZ"};

}  // namespace

std::optional<Pose> UsdReader::endOf(const Placed& joint, const char* body, const char* position,
                                     const char* rotation, int& link) {
  const UsdPrim prim = at(*joint.prim);
  const Vec3 point = prim.vector(position).value_or(Vec3{});
  const Quat turn = prim.quaternion(rotation).value_or(Quat{});
  Affine frame = placed_.front().world;
  link = -1;
  if (const auto* target = prim.targets(body)) {
    const auto found = byPath_.find(inInstance(joint, target->front()));
    if (found == byPath_.end()) return std::nullopt;
    frame = placed_[found->second].world, link = placed_[found->second].link;
  }
  // the position is scaled with its body, the orientation is not
  const Pose world{frame * point, normalize(frame.rigid().q * turn)};
  return link < 0 ? world : inverse(model_.links[static_cast<std::size_t>(link)].pose) * world;
}

void UsdReader::addDrive(const UsdPrim& prim, const std::string& name, bool turns, JointAxis& axis) {
  if (!prim.prim().hasSchema("PhysicsDriveAPI:" + name)) return;
  const std::string key = "drive:" + name + ":physics:";
  const double mass = kilogramsPerUnit_, area = metersPerUnit_ * metersPerUnit_;
  // of angles: for a degree
  const double perUnit = turns ? mass * area / kDegree : mass, unit = turns ? kDegree : metersPerUnit_;
  axis.driveStiffness = prim.number(key + "stiffness", 0) * perUnit;
  axis.driveDamping = prim.number(key + "damping", 0) * perUnit;
  axis.targetPosition = prim.number(key + "targetPosition", 0) * unit;
  axis.targetSpeed = prim.number(key + "targetVelocity", 0) * unit;
  axis.maxDriveForce = prim.number(key + "maxForce", INFINITY, true) * mass * (turns ? area : metersPerUnit_);
  if (axis.driveStiffness < 0 || axis.driveDamping < 0 || axis.maxDriveForce < 0)
    prim.fail(key + "stiffness", "numbers of at least 0", "less");
  if (prim.text(key + "type", "force") == "acceleration")
    report_.note(Effect::Approximate, prim.place(), "drive.type",
                 "a drive of accelerations has its stiffness and damping as for a mass or inertia of 1");
}

bool UsdReader::addAxes(const UsdPrim& prim, std::array<JointAxis, 6>& axes, int main) {
  const std::string& type = prim.prim().type;
  const auto lock = [](JointAxis& axis) { axis.min = axis.max = 0; };
  const auto limit = [&](JointAxis& axis, const std::string& low, const std::string& high, double unit) {
    axis.min = prim.number(low, -INFINITY, true) * unit, axis.max = prim.number(high, INFINITY, true) * unit;
    if (axis.min > axis.max) lock(axis);
  };
  // the axis of the joint is x in its frame
  const bool turns = type == "PhysicsRevoluteJoint", slides = type == "PhysicsPrismaticJoint";
  if (turns || slides || type == "PhysicsFixedJoint") {
    std::for_each(axes.begin(), axes.end(), lock);
    if (type == "PhysicsFixedJoint") return true;
    JointAxis& own = axes[turns ? 3 : 0] = {};
    limit(own, "physics:lowerLimit", "physics:upperLimit", turns ? kDegree : metersPerUnit_);
    addDrive(prim, turns ? "angular" : "linear", turns, own);
    own.armature = prim.number("physxJoint:armature", 0) * kilogramsPerUnit_ *
                   (turns ? metersPerUnit_ * metersPerUnit_ : 1);
    if (own.armature < 0) prim.fail("physxJoint:armature", "a number of at least 0", "less");
    return true;
  }
  if (type != "PhysicsJoint" && type != "PhysicsSphericalJoint") return false;
  if (type == "PhysicsSphericalJoint") {
    for (std::size_t i = 0; i < 3; ++i) lock(axes[i]);
    return true;
  }
  for (std::size_t i = 0; i < 6; ++i) {
    // axis i of the frame of the model
    JointAxis& own = axes[i < 3 ? (i + 3 - static_cast<std::size_t>(main)) % 3
                                : 3 + (i - static_cast<std::size_t>(main)) % 3];
    const std::string name = kAxes[i];
    if (prim.prim().hasSchema("PhysicsLimitAPI:" + name))
      limit(own, "limit:" + name + ":physics:low", "limit:" + name + ":physics:high",
            i < 3 ? metersPerUnit_ : kDegree);
    addDrive(prim, name, i >= 3, own);
  }
  return true;
}

void UsdReader::addJoint(const UsdPrim& prim, const Placed& placed) {
  const std::string& path = placed.path;
  const std::string what = prim.prim().type + inQuotes(prim.prim().name);
  if (!prim.flag("physics:jointEnabled", true))
    return report_.note(Effect::None, prim.place(), what, "it is not enabled");
  const std::string& type = prim.prim().type;
  const std::string axisName = prim.text("physics:axis", "X");
  const int main = type == "PhysicsJoint" || type == "PhysicsFixedJoint" ? 0
                   : axisName == "Y"                                     ? 1
                   : axisName == "Z"                                     ? 2
                                                                         : 0;
  FreeJoint out;
  out.place = prim.place();
  const auto endB = endOf(placed, "physics:body0", "physics:localPos0", "physics:localRot0", out.linkB),
             endA = endOf(placed, "physics:body1", "physics:localPos1", "physics:localRot1", out.linkA);
  if (!endA || !endB) return report_.note(Effect::Lost, prim.place(), what, "one of its bodies is not there");
  const Pose &a = *endA, &b = *endB;
  JointDef joint;
  const double force = prim.number("physics:breakForce", INFINITY, true),
               torque = prim.number("physics:breakTorque", INFINITY, true);
  const auto add = [&](JointDef made, const std::string& name) {
    made.name = name;
    made.collide = prim.flag("physics:collisionEnabled", false);
    if (std::isfinite(force) && force > 0) made.breakForce = force * kilogramsPerUnit_ * metersPerUnit_;
    if (std::isfinite(torque) && torque > 0)
      made.breakTorque = torque * kilogramsPerUnit_ * metersPerUnit_ * metersPerUnit_;
    out.joint = std::move(made);
    model_.joints.push_back(out);
  };
  const auto distance = [&](const char* low, const char* high) {
    JointDef rod;
    rod.type = jointType("tendon");
    rod.axes[0].min = length(std::max(prim.number(low, -1, true), 0.));
    const double most = prim.number(high, -1, true);
    rod.axes[0].max = most < 0 ? kFree : length(most);
    if (rod.axes[0].min > rod.axes[0].max) std::swap(rod.axes[0].min, rod.axes[0].max);
    TendonFields fields;
    fields.path = {0, a.p.x, a.p.y, a.p.z, 1, 1, b.p.x, b.p.y, b.p.z, 0};
    rod.own = fields;
    return rod;
  };
  if (type == "PhysicsDistanceJoint") {
    joint = distance("physics:minDistance", "physics:maxDistance");
  } else {
    std::array<JointAxis, 6> axes;
    if (!addAxes(prim, axes, main))
      return report_.note(Effect::Lost, prim.place(), what, "a joint of this type");
    joint = jointOfAxes(axes);
    if (type == "PhysicsSphericalJoint") {
      const double toY = prim.number("physics:coneAngle0Limit", -1),
                   toZ = prim.number("physics:coneAngle1Limit", -1);
      constexpr double kNarrowest = 1e-3;
      if (toY >= 0 || toZ >= 0) {
        joint = {};
        joint.type = JointType::SwingTwist;
        joint.swingZ = toY < 0 ? kFree : std::max(toY * kDegree, kNarrowest);
        joint.swingY = toZ < 0 ? kFree : std::max(toZ * kDegree, kNarrowest);
      }
    }
    joint.anchorA = a.p, joint.anchorB = b.p;
    joint.frameA = normalize(a.q * frameOfAxis(main)), joint.frameB = normalize(b.q * frameOfAxis(main));
  }
  prim.flag("physics:excludeFromArticulation", false);
  if (type == "PhysicsJoint" && prim.prim().hasSchema("PhysicsLimitAPI:distance"))
    add(distance("limit:distance:physics:low", "limit:distance:physics:high"), path.substr(1) + "/distance");
  add(std::move(joint), path.substr(1));
}

}  // namespace rubble::convert
