#include "io/sensor_json.h"

#include "io/field_json.h"
#include "io/shape_json.h"

namespace rubble::io {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string>& keywords() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names;
    for (int type = 0; type <= static_cast<int>(SensorType::Time); ++type)
      names.emplace_back(keyword(static_cast<SensorType>(type)));
    return names;
  }();
  return all;
}

bool readsJoint(SensorType type) {
  return type == SensorType::Force || type == SensorType::Torque || type == SensorType::JointPosition ||
         type == SensorType::JointSpeed || type == SensorType::DriveForce;
}

}  // namespace

SensorDef readSensor(const Node& node, const std::function<int(const Node&)>& body,
                     const std::function<int(const Node&)>& joint) {
  SensorDef out;
  ObjectReader object(node, "a sensor");
  if (!object.isObject()) return out;
  object.read("name", out.name);
  if (const auto found = object.need("type", "\"acceleration\" or another of the sensor types"))
    out.type = static_cast<SensorType>(found->choice(keywords()).value_or(0));
  if (const auto found = object.get("body")) out.body = body(*found);
  object.read("position", out.position);
  if (const auto found = object.get("orientation")) out.orientation = readOrientation(*found);
  if (const auto found = object.get("reference")) out.reference = body(*found);
  object.read("reference_position", out.referencePosition);
  if (const auto found = object.get("reference_orientation"))
    out.referenceOrientation = readOrientation(*found);
  if (const auto found = object.get("joint")) out.joint = joint(*found);
  if (readsJoint(out.type) && out.joint < 0) object.need("joint", "the name or index of a joint");
  if (const auto found = object.get("axis")) out.axis = found->whole(0, "the number of an axis").value_or(0);
  object.read("scale", out.scale);
  object.read("offset", out.offset);
  if (const auto found = object.get("volume")) out.volume = readShape(*found, {}, readMaterial);
  object.read("cutoff", out.cutoff, kNotNegative);
  object.finish();
  return out;
}

Json sensorJson(const SensorDef& sensor, const std::function<Json(int)>& body,
                const std::function<Json(int)>& joint) {
  Json json = Json::object();
  if (!sensor.name.empty()) json["name"] = sensor.name;
  json["type"] = keyword(sensor.type);
  const SensorDef usual;
  if (sensor.body != kWorld) json["body"] = body(sensor.body);
  if (sensor.position != Vec3{}) json["position"] = vectorJson(sensor.position);
  if (sensor.orientation != Quat{}) json["orientation"] = quaternionJson(sensor.orientation);
  if (sensor.reference != kWorld) json["reference"] = body(sensor.reference);
  if (sensor.referencePosition != Vec3{}) json["reference_position"] = vectorJson(sensor.referencePosition);
  if (sensor.referenceOrientation != Quat{})
    json["reference_orientation"] = quaternionJson(sensor.referenceOrientation);
  if (sensor.joint >= 0) json["joint"] = joint(sensor.joint);
  if (sensor.axis != 0) json["axis"] = sensor.axis;
  if (!sameBits(sensor.scale, 1)) json["scale"] = sensor.scale;
  if (!sameBits(sensor.offset, 0)) json["offset"] = sensor.offset;
  if (sensor.type == SensorType::Touch) json["volume"] = shapeJson(sensor.volume);
  if (sensor.cutoff > 0) json["cutoff"] = sensor.cutoff;
  return json;
}

}  // namespace rubble::io
