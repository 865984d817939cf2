#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "cook/body_fields.h"
#include "io/actuator_json.h"
#include "io/appearance_json.h"
#include "io/body_reader.h"
#include "io/field_json.h"
#include "io/joint_reader.h"
#include "io/json_text.h"
#include "io/output_file.h"
#include "io/scene_json.h"
#include "io/sensor_json.h"
#include "io/shape_json.h"
#include "io/soft_json.h"

namespace rubble::io {
namespace {

using Json = nlohmann::ordered_json;

Json layersJson(std::uint32_t bits) {
  Json json = Json::array();
  for (int layer = 0; layer < 32; ++layer)
    if (bits >> layer & 1) json.push_back(layer);
  return json;
}

Json axesJson(const std::array<bool, 3>& axes) {
  Json json = Json::array();
  for (std::size_t k = 0; k < 3; ++k)
    if (axes[k]) json.push_back(std::string(1, "xyz"[k]));
  return json;
}

/// What BodyReader's readExtras reads.
void writeExtras(const BodyDef& body, Json& json) {
  const BodyDef usual;
  writeFields(kBodyFields, body, json);
  if (body.lockTranslation != usual.lockTranslation)
    json["lock_translation"] = axesJson(body.lockTranslation);
  if (body.lockRotation != usual.lockRotation) json["lock_rotation"] = axesJson(body.lockRotation);
  if (body.filter.layers != usual.filter.layers) json["layers"] = layersJson(body.filter.layers);
  if (body.filter.mask != usual.filter.mask) json["mask"] = layersJson(body.filter.mask);
  if (body.filter.group != usual.filter.group) json["group"] = body.filter.group;
  if (body.sensor) json["sensor"] = true;
  if (body.userData != 0) json["user_data"] = body.userData;
}

class SceneWriter {
 public:
  explicit SceneWriter(const SceneFile& file) : file_(file) {}
  Json write();

 private:
  void nameMaterial(const Material& material);
  /// How the file names a material; null for the usual one.
  Json materialName(const Material& material) const;
  void nameShape(const Shape& shape);
  /// The name of a shape that several bodies have, otherwise the shape.
  Json shapeOf(const Shape& shape) const;
  void countName(const BodyDef& body) { ++nameUses_[body.name]; }
  Json body(const BodyDef& body) const;
  Json bodyReference(int index) const;
  Json joint(const JointDef& joint) const;
  Json event(const Event& event) const;
  Json claim(const FileClaim& claim) const;

  const SceneFile& file_;
  std::vector<std::pair<std::string, Material>> materials_;  ///< by their keys in the file
  /// Geometry, rounding and user data: all of a shape that has geometry.
  using ShapeKey = std::tuple<const ShapeGeometry*, double, std::uint64_t>;
  static ShapeKey keyOf(const Shape& shape) { return {shape.geometry.get(), shape.rounding, shape.userData}; }
  std::map<ShapeKey, std::string> shapeNames_;         ///< of several bodies
  std::vector<std::pair<std::string, Shape>> shapes_;  ///< the same in the order of their second use
  std::map<std::string, int> nameUses_;
  std::map<ShapeKey, int> shapeUses_;
};

void SceneWriter::nameMaterial(const Material& material) {
  if (material == Material{} || !materialName(material).is_null()) return;
  const auto isTaken = [&](const std::string& name) {
    return std::ranges::any_of(materials_, [&](const auto& named) { return named.first == name; });
  };
  std::string name = material.name;
  for (std::size_t k = materials_.size() + 1; name.empty() || isTaken(name); ++k)
    name = "material" + std::to_string(k);
  materials_.emplace_back(name, material);
}

Json SceneWriter::materialName(const Material& material) const {
  const auto found = std::ranges::find(materials_, material, &std::pair<std::string, Material>::second);
  return found == materials_.end() ? Json() : Json(found->first);
}

void SceneWriter::nameShape(const Shape& shape) {
  const ShapeKey key = keyOf(shape);
  if (!shape.geometry || ++shapeUses_[key] != 2) return;
  shapes_.emplace_back("shape" + std::to_string(shapes_.size() + 1), shape);
  shapeNames_[key] = shapes_.back().first;
}

Json SceneWriter::shapeOf(const Shape& shape) const {
  const auto named = shapeNames_.find(keyOf(shape));
  return named != shapeNames_.end() ? Json(named->second) : shapeJson(shape);
}

Json SceneWriter::body(const BodyDef& body) const {
  Json json = Json::object();
  if (!body.name.empty()) json["name"] = body.name;
  if (body.motion != Motion::Dynamic && body.shape.type != ShapeType::Plane)
    json["motion"] = motionNames()[static_cast<std::size_t>(body.motion)];
  json["shape"] = shapeOf(body.shape);
  if (const Json material = materialName(body.material); !material.is_null()) json["material"] = material;
  writeFields(kMassFields, body, json);
  if (body.mass) json.erase("density");
  writeFields(kBodyStateFields, body, json);
  writeExtras(body, json);
  return json;
}

Json SceneWriter::bodyReference(int index) const {
  if (index == kWorld) return "world";
  const std::string& name = file_.scene.bodies[static_cast<std::size_t>(index)].name;
  const bool tells = !name.empty() && nameUses_.at(name) == 1;
  return tells ? Json(name) : Json(index);
}

Json SceneWriter::joint(const JointDef& joint) const {
  return jointJson(joint, [&](int body) { return bodyReference(body); });
}

Json SceneWriter::event(const Event& event) const {
  Json json = Json::object();
  json["step"] = event.step;
  for (const BodyDef& added : event.add) json["add"].push_back(body(added));
  if (!event.remove.empty()) json["remove"] = event.remove;
  if (!event.removeJoints.empty()) json["remove_joints"] = event.removeJoints;
  for (const Event::Push& push : event.setVelocity) {
    Json entry = Json::object();
    entry["body"] = push.body;
    entry["velocity"] = vectorJson(push.velocity);
    if (!sameBits(push.angularVelocity, Vec3{})) entry["angular_velocity"] = vectorJson(push.angularVelocity);
    json["set_velocity"].push_back(std::move(entry));
  }
  for (const Event::Turn& turn : event.setJoint) {
    Json entry = Json::object();
    entry["joint"] = turn.joint;
    if (turn.axis != 0) entry["axis"] = turn.axis;
    if (turn.targetPosition) entry["target_position"] = *turn.targetPosition;
    if (turn.targetSpeed) entry["target_speed"] = *turn.targetSpeed;
    if (turn.motorForce) entry["motor_force"] = *turn.motorForce;
    if (turn.length) entry["length"] = *turn.length;
    if (turn.dragTo) entry["drag_to"] = vectorJson(*turn.dragTo);
    json["set_joint"].push_back(std::move(entry));
  }
  return json;
}

Json SceneWriter::claim(const FileClaim& claim) const {
  Json json = Json::object();
  json["metric"] = claim.metric;
  if (std::isfinite(claim.min)) json["min"] = claim.min;
  if (std::isfinite(claim.max)) json["max"] = claim.max;
  if (!claim.why.empty()) json["why"] = claim.why;
  return json;
}

Json SceneWriter::write() {
  const Scene& scene = file_.scene;
  for (const BodyDef& body : scene.bodies)
    nameMaterial(body.material), nameShape(body.shape), countName(body);
  for (const Deformable& object : scene.deformables) nameMaterial(common(object).material);
  for (const Event& event : scene.events)
    for (const BodyDef& body : event.add) nameMaterial(body.material), nameShape(body.shape);
  for (const Look& look : file_.appearance.looks)
    for (const LookPart& part : look.parts) nameShape(part.shape);

  Json json = Json::object();
  json["name"] = scene.name;
  if (!scene.description.empty()) json["description"] = scene.description;
  json["gravity"] = vectorJson(scene.gravity);
  json["steps"] = file_.steps;
  json["iterations"] = file_.iterations;
  if (file_.substeps != 1) json["substeps"] = file_.substeps;
  if (file_.smashStep >= 0) json["smash_step"] = file_.smashStep;
  if (!sameBits(file_.dt, SceneFile{}.dt)) json["dt"] = file_.dt;
  if (file_.camera)
    json["camera"] = {{"eye", vectorJson(file_.camera->eye)}, {"target", vectorJson(file_.camera->target)}};
  const Daylight& daylight = file_.appearance.daylight;
  if (Json sun = sunJson(daylight); !sun.empty()) json["sun"] = std::move(sun);
  if (!sameBits(daylight.skyStrength, Daylight{}.skyStrength)) json["sky"] = daylight.skyStrength;
  for (const auto& [key, own] : materials_) {
    Json& material = json["materials"][key] = materialJson(own);
    material["name"] = own.name;
    if (key == own.name) material.erase("name");
  }
  for (const MaterialPair& pair : scene.materialPairs)
    json["material_pairs"].push_back(materialPairJson(pair));
  for (const auto& [name, shape] : shapes_) json["shapes"][name] = shapeJson(shape);
  json["bodies"] = Json::array();
  for (Json& list = json["bodies"]; const BodyDef& added : scene.bodies) list.push_back(body(added));
  for (const JointDef& added : scene.joints) json["joints"].push_back(joint(added));
  for (const Deformable& object : scene.deformables)
    json["deformables"].push_back(deformableJson(object, materialName(common(object).material)));
  for (const AttachmentDef& added : scene.attachments)
    json["attachments"].push_back(attachmentJson(added, bodyReference(added.body)));
  for (const auto& [a, b] : scene.exclusions)
    json["exclusions"].push_back(Json{bodyReference(a), bodyReference(b)});
  for (const Event& added : scene.events) json["events"].push_back(event(added));
  for (const SensorDef& added : file_.sensors)
    json["sensors"].push_back(sensorJson(
        added, [&](int body) { return bodyReference(body); }, [](int joint) { return Json(joint); }));
  for (const ActuatorDef& added : file_.actuators)
    json["actuators"].push_back(actuatorJson(added, [&](int body) { return bodyReference(body); }));
  for (const Look& added : file_.appearance.looks)
    json["looks"].push_back(
        lookJson(added, bodyReference(added.body), [this](const Shape& each) { return shapeOf(each); }));
  for (const NamedCamera& added : file_.appearance.cameras) json["cameras"].push_back(namedCameraJson(added));
  for (const PointLight& added : file_.appearance.lights) json["lights"].push_back(pointLightJson(added));
  for (const FileClaim& added : file_.claims) json["verdict"].push_back(claim(added));
  return json;
}

}  // namespace

std::string toJson(const SceneFile& scene) { return prettyJson(SceneWriter(scene).write()); }

void writeText(const std::string& file, const std::string& text) {
  OutputFile out(file);
  out.stream() << text;
  out.finish();
}

}  // namespace rubble::io
