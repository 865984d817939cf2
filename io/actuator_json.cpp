#include "io/actuator_json.h"

#include <rubble/error.h>

#include "io/field_json.h"

namespace rubble::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr FieldRules kHardRule{FieldRange::Any, "hard"}, kFreeRule{FieldRange::Any, "free"};
constexpr std::tuple kFields{
    field("gear", "1", "length of the actuator per unit of the coordinate", &ActuatorDef::gear),
    field("offset", "m, rad", "its length where the coordinate is 0", &ActuatorDef::offset),
    field("position", "m", "wrench: point of the body", &ActuatorDef::position),
    field("force", "N", "wrench: of a unit, in the frame of the body", &ActuatorDef::force),
    field("torque", "N m", "wrench: the same", &ActuatorDef::torque),
    field("gain", "N, N m", "per input: constant, by length and by speed", &ActuatorDef::gain),
    field("bias", "N, N m", "without input: the same", &ActuatorDef::bias),
    field("min_force", "N, N m", "bound of what it does", &ActuatorDef::minForce, kHardRule),
    field("max_force", "N, N m", "the same", &ActuatorDef::maxForce, kHardRule),
    field("time_constant", "s", "of a filter", &ActuatorDef::timeConstant),
    field("early", "1", "the activation of the end of a step acts in it", &ActuatorDef::early),
    field("min_control", "1", "controls are clamped to it", &ActuatorDef::minControl, kFreeRule),
    field("max_control", "1", "the same", &ActuatorDef::maxControl, kFreeRule),
    field("min_activation", "1", "activations are clamped to it", &ActuatorDef::minActivation, kFreeRule),
    field("max_activation", "1", "the same", &ActuatorDef::maxActivation, kFreeRule),
    field("control", "1", "at the beginning", &ActuatorDef::control),
    field("activation", "1", "at the beginning", &ActuatorDef::activation),
    field("included", "N, N m, m, rad", "effect that the axis has already", &ActuatorDef::included)};
constexpr std::tuple kMuscleFields{
    field("peak_force", "N", "largest active force without motion", &Muscle::peakForce),
    field("optimal_length", "m, rad", "of the fiber", &Muscle::optimalLength),
    field("tendon_length", "m, rad", "length beside that of the fiber", &Muscle::tendonLength),
    field("shortest", "1", "fiber without active force, over the optimal length", &Muscle::shortest),
    field("longest", "1", "the same on the other side", &Muscle::longest),
    field("fastest", "1/s", "shortening without active force, optimal lengths per second", &Muscle::fastest),
    field("passive", "1", "passive force at the longest length, over the peak force", &Muscle::passive),
    field("lengthening", "1", "largest active force of lengthening, likewise", &Muscle::lengthening),
    field("rise", "s", "time constant of activation", &Muscle::rise),
    field("fall", "s", "of deactivation", &Muscle::fall),
    field("smoothing", "1", "range of u - a in which one becomes the other", &Muscle::smoothing)};

/// Keywords of an enumeration up to its last value.
template <class E> std::vector<std::string> keywordsTo(E last) {
  std::vector<std::string> names;
  for (int i = 0; i <= static_cast<int>(last); ++i) names.emplace_back(keyword(static_cast<E>(i)));
  return names;
}

template <class Fields, class Def> void writeFields(const Fields& fields, const Def& def, Json& json) {
  forEachField(fields, def, [&, usual = Def{}](const auto& field, const auto& value) {
    if (!sameBits(value, usual.*field.member)) json[field.key] = fieldJson(field, value);
  });
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
  forEachField(kFields, out, read(object));
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
  writeFields(kFields, actuator, json);
  Json muscle = Json::object();
  writeFields(kMuscleFields, actuator.muscle, muscle);
  if (!muscle.empty()) json["muscle"] = muscle;
  return json;
}

}  // namespace rubble::io
