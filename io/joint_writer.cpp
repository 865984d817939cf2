#include <bit>
#include <cmath>
#include <cstdint>

#include "io/joint_reader.h"

namespace rubble::io {
namespace {

using Json = nlohmann::ordered_json;

Json vectorJson(const Vec3& a) { return {a.x, a.y, a.z}; }
Json quaternionJson(const Quat& q) { return {q.s, q.v.x, q.v.y, q.v.z}; }
/// The same bits, so that -0 is not taken for 0.
bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same(const Quat& a, const Quat& b) {
  return same(a.s, b.s) && same(a.v.x, b.v.x) && same(a.v.y, b.v.y) && same(a.v.z, b.v.z);
}

/// Fields that differ from those of a fresh object; infinity by its word.
template <class Fields, class Object>
void writeFields(Json& json, const Fields& fields, const Object& object) {
  const Object usual;
  for (const auto& field : fields) {
    const double value = object.*field.member;
    if (same(value, usual.*field.member)) continue;
    json[field.key] = std::isinf(value) && field.word ? Json(field.word) : Json(value);
  }
}

}  // namespace

nlohmann::ordered_json jointJson(const JointDef& joint,
                                 const std::function<nlohmann::ordered_json(int)>& reference) {
  using Json = nlohmann::ordered_json;
  const JointDef usual;
  Json json = Json::object();
  if (!joint.name.empty()) json["name"] = joint.name;
  json["type"] = keyword(joint.type);
  json["body_a"] = reference(joint.bodyA);
  json["body_b"] = reference(joint.bodyB);
  if (joint.carrierA != kWorld) json["carrier_a"] = reference(joint.carrierA);
  if (joint.carrierB != kWorld) json["carrier_b"] = reference(joint.carrierB);
  json["anchor_a"] = vectorJson(joint.anchorA);
  json["anchor_b"] = vectorJson(joint.anchorB);
  const bool framed = usesFrames(joint.type) || !same(joint.frameA, usual.frameA) ||
                      !same(joint.frameB, usual.frameB);
  if (framed) json["frame_a"] = quaternionJson(joint.frameA), json["frame_b"] = quaternionJson(joint.frameB);
  const bool kept = joint.type == JointType::Fixed || joint.type == JointType::Slider ||
                    joint.type == JointType::AngularSpring;
  if (kept) json["orientation_a_to_b"] = quaternionJson(joint.orientationAtoB);
  if (!same(joint.driveOrientation, usual.driveOrientation))
    json["drive_orientation"] = quaternionJson(joint.driveOrientation);
  writeFields(json, jointFields(), joint);
  if (joint.type == JointType::Pulley)
    json["pulley_a"] = vectorJson(joint.pulleyA), json["pulley_b"] = vectorJson(joint.pulleyB);
  Json axes = Json::array();
  bool said = false;
  for (std::size_t i = 0; i < axesInFile(joint.type); ++i) {
    Json axis = Json::object();
    writeFields(axis, axisFields(), joint.axes[i]);
    said |= !axis.empty();
    axes.push_back(std::move(axis));
  }
  if (said) json["axes"] = std::move(axes);
  if (joint.collide != usual.collide) json["collide"] = joint.collide;
  return json;
}

}  // namespace rubble::io
