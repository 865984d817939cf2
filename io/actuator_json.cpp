#include "io/actuator_json.h"

#include <rubble/error.h>

#include "io/field_json.h"
#include "world/actuator_fields.h"

namespace rubble::io {
namespace {

using Json = nlohmann::ordered_json;

/// Keywords of an enumeration up to its last value.
template <class E> std::vector<std::string> keywordsTo(E last) {
  std::vector<std::string> names;
  for (int i = 0; i <= static_cast<int>(last); ++i) names.emplace_back(keyword(static_cast<E>(i)));
  return names;
}

}  // namespace

ActuatorDef readActuator(const Node& node, const std::function<int(const Node&)>& body,
                         const std::function<int(const Node&)>& joint) {
  static const std::vector<std::string> types = keywordsTo(ActuatorType::Adhesion),
                                        dynamics = keywordsTo(ActuatorDynamics::Muscle);
  ActuatorDef out;
  ObjectReader object(node, "an actuator");
  if (!object.isObject()) return out;
  object.read("name", out.name);
  if (const auto found = object.need("type", "\"force\" or another of the actuator types"))
    out.type = static_cast<ActuatorType>(found->choice(types).value_or(0));
  const bool ofBody = out.type == ActuatorType::Wrench || out.type == ActuatorType::Adhesion;
  if (const auto found = object.get("body")) out.body = body(*found);
  if (const auto found = object.get("joint")) out.joint = joint(*found);
  if (ofBody && out.body < 0) object.need("body", "the name or index of a body");
  if (!ofBody && out.joint < 0) object.need("joint", "the name or index of a joint");
  if (const auto found = object.get("axis")) out.axis = found->whole(0, "the number of an axis").value_or(0);
  if (const auto found = object.get("dynamics"))
    out.dynamics = static_cast<ActuatorDynamics>(found->choice(dynamics).value_or(0));
  const auto read = [](ObjectReader& from) {
    return [&](const FieldInfo& field, auto& value) { readField(from, field, value); };
  };
  forEachField(kActuatorFields, out, read(object));
  if (const auto found = object.get("muscle")) {
    ObjectReader muscle(*found, "a muscle");
    if (muscle.isObject()) forEachField(kMuscleFields, out.muscle, read(muscle)), muscle.finish();
  }
  object.finish();
  try {
    validate(out, "actuator");
  } catch (const Error& error) {
    node.faultText(error.what());
  }
  return out;
}

Json actuatorJson(const ActuatorDef& actuator, const std::function<Json(int)>& body) {
  Json json = Json::object();
  if (!actuator.name.empty()) json["name"] = actuator.name;
  json["type"] = keyword(actuator.type);
  if (actuator.body != kWorld) json["body"] = body(actuator.body);
  if (actuator.joint >= 0) json["joint"] = actuator.joint;
  if (actuator.axis != 0) json["axis"] = actuator.axis;
  if (actuator.dynamics != ActuatorDynamics::None) json["dynamics"] = keyword(actuator.dynamics);
  writeFields(kActuatorFields, actuator, json);
  Json muscle = Json::object();
  writeFields(kMuscleFields, actuator.muscle, muscle);
  if (!muscle.empty()) json["muscle"] = muscle;
  return json;
}

}  // namespace rubble::io
