#pragma once
/// What the writer and the reader of input logs share.
#include <array>
#include <string>
#include <variant>

#include <nlohmann/json.hpp>

#include <rubble/inputs.h>

#include "io/definition_json.h"

namespace rubble::io {

inline constexpr const char* kInputFormat = "rubble inputs 1";

/// Names of the calls, in the order of inputs::Call.
inline constexpr std::array kInputNames{
    "step",           "add_bodies",          "remove_bodies",     "set_collide",
    "set_states",     "set_target",          "apply_forces",      "apply_impulses",
    "wake",           "sort_bodies",         "scatter",           "add_joint",
    "remove_joint",   "set_definition",      "add_deformable",    "remove_deformable",
    "add_attachment", "remove_attachment",   "set_vertices",      "apply_vertex_force",
    "set_params",     "set_gravity",         "take_snapshot",     "restore",
    "scatter_joints", "set_body_definition", "set_material_pair", "set_deformable_definition"};
static_assert(kInputNames.size() == std::variant_size_v<inputs::Call>);

inline nlohmann::ordered_json inputJson(const Vec3& v) { return {v.x, v.y, v.z}; }
inline nlohmann::ordered_json inputJson(const Quat& q) { return {q.s, q.v.x, q.v.y, q.v.z}; }
template <class Id>
requires requires(Id id) { id.generation; }
nlohmann::ordered_json inputJson(Id id) { return {id.index, id.generation}; }

/// A joint without its bodies.
inline nlohmann::ordered_json bareJoint(const JointDef& joint) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(toJson(joint));
  for (const char* key : {"body_a", "body_b", "frame_body_a", "frame_body_b"}) json.erase(key);
  return json;
}
/// An attachment without its objects and its body.
nlohmann::ordered_json bareAttachment(const AttachmentDef& attachment);

}  // namespace rubble::io
