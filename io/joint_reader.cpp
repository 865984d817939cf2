#include "io/joint_reader.h"

#include <algorithm>
#include <cmath>

#include "io/body_reader.h"
#include "io/field_json.h"
#include "io/shape_json.h"

namespace rubble::io {
namespace {

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
  const bool needed = kindOf(joint.type).has("anchor_a");
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
  if (kindOf(joint.type).has("frame_a")) {
    joint.frameA = normalize(conjugate(a) * inWorldA);
    joint.frameB = normalize(conjugate(b) * inWorldB);
  }
  if (const auto frame = object.get("frame_a")) joint.frameA = readOrientation(*frame);
  if (const auto frame = object.get("frame_b")) joint.frameB = readOrientation(*frame);
}

void readAxes(ObjectReader& object, JointDef& joint) {
  const auto found = object.get("axes");
  if (!found) return;
  const auto most = static_cast<std::size_t>(kindOf(joint.type).axes);
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
    forEachField(kAxisFields, axis, [&](const FieldInfo& f, double& value) { readField(reader, f, value); });
    reader.finish();
  }
}

}  // namespace

const std::vector<JointField>& valueFields(const JointKind& kind) {
  static const std::vector<std::vector<JointField>> all = [] {
    const auto isPlacement = [](const JointField& field) {
      return std::apply([&](const auto&... place) { return (field.is(place.key) || ...); }, kPlacementFields);
    };
    std::vector<JointField> shared = sharedJointFields();
    std::erase_if(shared, isPlacement);
    std::vector<std::vector<JointField>> lists(jointKinds().size(), shared);
    for (std::size_t k = 0; k < lists.size(); ++k)
      lists[k].insert(lists[k].end(), jointKinds()[k].ownFields.begin(), jointKinds()[k].ownFields.end());
    return lists;
  }();
  return all[static_cast<std::size_t>(&kind - jointKinds().data())];
}

const std::vector<std::string>& jointKeywords() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const JointKind& kind : jointKinds()) all.emplace_back(kind.name);
    return all;
  }();
  return names;
}

void readJoint(ObjectReader& object, JointDef& out, const Scene& scene) {
  readAnchors(object, out, scene);
  readFrames(object, out, scene);
  const auto given = object.get("orientation_a_to_b");
  const bool kept = kindOf(out.type).has("orientation_a_to_b");
  if (given) {
    out.orientationAtoB = readOrientation(*given);
    if (!kept)
      given->faultText(
          "expected only for a joint of type \"fixed\", \"slider\" or \"angular_spring\", got one for "
          "another");
  } else if (kept) {
    out.orientationAtoB = normalize(conjugate(poseOf(scene, out.bodyB).orientation) *
                                    poseOf(scene, out.bodyA).orientation);
  }
  readJointValues(object, out);
}

void readJointValues(ObjectReader& object, JointDef& out) {
  for (const JointField& field : valueFields(kindOf(out.type)))
    field.visit(out, [&](auto& value) { readField(object, field, value); });
  readAxes(object, out);
  object.read("collide", out.collide);
  object.read("user_data", out.userData);
}

}  // namespace rubble::io
