#include "io/field_json.h"
#include "io/joint_reader.h"

namespace rubble::io {
namespace {

using Ordered = nlohmann::ordered_json;

Ordered axisJson(const JointAxis& axis) {
  Ordered json = Ordered::object();
  forEachField(kAxisFields, axis, [&, usual = JointAxis{}](const auto& field, double value) {
    if (!sameBits(value, usual.*field.member)) json[field.key] = fieldJson(field, value);
  });
  return json;
}

}  // namespace

nlohmann::ordered_json jointJson(const JointDef& joint,
                                 const std::function<nlohmann::ordered_json(int)>& reference) {
  const JointDef usual;
  Ordered json = Ordered::object();
  if (!joint.name.empty()) json["name"] = joint.name;
  json["type"] = keyword(joint.type);
  json["body_a"] = reference(joint.bodyA);
  json["body_b"] = reference(joint.bodyB);
  if (joint.frameBodyA != kWorld) json["frame_body_a"] = reference(joint.frameBodyA);
  if (joint.frameBodyB != kWorld) json["frame_body_b"] = reference(joint.frameBodyB);
  const JointKind& kind = kindOf(joint.type);
  const bool framed = kind.has("frame_a") || !sameBits(joint.frameA, usual.frameA) ||
                      !sameBits(joint.frameB, usual.frameB);
  forEachField(kPlacementFields, joint, [&](const FieldInfo& field, const auto& value) {
    if (kind.has(field.key) || field.is("anchor_a") || field.is("anchor_b") ||
        (framed && !field.is("orientation_a_to_b")))
      json[field.key] = fieldJson(field, value);
  });
  for (const JointField& field : valueFields(kind))
    field.visit(joint, usual, [&](const auto& value, const auto& other) {
      if (!sameBits(value, other) || (field.rules.always && kind.has(field.key)))
        json[field.key] = fieldJson(field, value);
    });
  Ordered axes = Ordered::array();
  bool said = false;
  for (int i = 0; i < kind.axes; ++i) {
    axes.push_back(axisJson(joint.axes[static_cast<std::size_t>(i)]));
    said |= !axes.back().empty();
  }
  if (said) json["axes"] = std::move(axes);
  if (joint.collide != usual.collide) json["collide"] = joint.collide;
  if (joint.userData != 0) json["user_data"] = joint.userData;
  return json;
}

}  // namespace rubble::io
