#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>

#include "io/json_text.h"
#include "io/scene_json.h"

namespace rubble::io {
namespace {

using Json = nlohmann::ordered_json;

Json vectorJson(const Vec3& v) { return {v.x, v.y, v.z}; }
Json quaternionJson(const Quat& q) { return {q.s, q.v.x, q.v.y, q.v.z}; }
Json limitJson(double value, const char* word) { return std::isinf(value) ? Json(word) : Json(value); }

/// The same bits, so that -0 is not taken for 0.
bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same(const Vec3& a, const Vec3& b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }
bool same(const Quat& a, const Quat& b) { return same(a.s, b.s) && same(a.v, b.v); }

Json materialJson(const Material& material) {
  Json json = Json::object();
  if (same(material.staticFriction, material.dynamicFriction)) {
    json["friction"] = material.staticFriction;
  } else {
    json["static_friction"] = material.staticFriction;
    json["dynamic_friction"] = material.dynamicFriction;
  }
  if (!same(material.restitution, 0)) json["restitution"] = material.restitution;
  return json;
}

Json shapeJson(const Shape& shape) {
  switch (shape.type) {
    case ShapeType::Box:
      return {{"type", "box"}, {"size", vectorJson(shape.halfExtents * 2)}};
    case ShapeType::Sphere:
      return {{"type", "sphere"}, {"radius", shape.radius}};
    case ShapeType::Capsule:
      return {{"type", "capsule"}, {"radius", shape.radius}, {"length", 2 * shape.halfLength}};
    case ShapeType::Plane:
      break;
  }
  return Json::object({{"type", "plane"}});
}

class SceneWriter {
 public:
  explicit SceneWriter(const SceneFile& file) : file_(file) {}
  Json write();

 private:
  void nameMaterial(const BodyDef& body);
  void countName(const BodyDef& body) { ++nameUses_[body.name]; }
  Json body(const BodyDef& body) const;
  Json bodyReference(int index) const;
  Json joint(const JointDef& joint) const;
  Json event(const Event& event) const;
  Json claim(const FileClaim& claim) const;

  const SceneFile& file_;
  std::map<std::array<double, 3>, std::string> materials_;
  std::map<std::string, int> nameUses_;
};

std::array<double, 3> keyOf(const Material& m) { return {m.staticFriction, m.dynamicFriction, m.restitution}; }

void SceneWriter::nameMaterial(const BodyDef& body) {
  const auto key = keyOf(body.material);
  if (key != keyOf(Material{})) materials_.emplace(key, "material" + std::to_string(materials_.size() + 1));
}

Json SceneWriter::body(const BodyDef& body) const {
  constexpr std::array<const char*, 3> kMotions{"static", "kinematic", "dynamic"};
  const BodyDef usual;
  Json json = Json::object();
  if (!body.name.empty()) json["name"] = body.name;
  if (body.motion != Motion::Dynamic && body.shape.type != ShapeType::Plane)
    json["motion"] = kMotions[static_cast<std::size_t>(body.motion)];
  json["shape"] = shapeJson(body.shape);
  if (const auto found = materials_.find(keyOf(body.material)); found != materials_.end()) json["material"] = found->second;
  if (body.mass) {
    json["mass"] = *body.mass;
  } else if (!same(body.density, usual.density)) {
    json["density"] = body.density;
  }
  if (!same(body.position, usual.position)) json["position"] = vectorJson(body.position);
  if (!same(body.orientation, usual.orientation)) json["orientation"] = quaternionJson(body.orientation);
  if (!same(body.velocity, usual.velocity)) json["velocity"] = vectorJson(body.velocity);
  if (!same(body.angularVelocity, usual.angularVelocity)) json["angular_velocity"] = vectorJson(body.angularVelocity);
  if (!same(body.gravityScale, usual.gravityScale)) json["gravity_scale"] = body.gravityScale;
  return json;
}

Json SceneWriter::bodyReference(int index) const {
  if (index == kWorld) return "world";
  const std::string& name = file_.scene.bodies[static_cast<std::size_t>(index)].name;
  const bool tells = !name.empty() && nameUses_.at(name) == 1;
  return tells ? Json(name) : Json(index);
}

Json SceneWriter::joint(const JointDef& joint) const {
  const JointDef usual;
  Json json = Json::object();
  if (!joint.name.empty()) json["name"] = joint.name;
  json["type"] = joint.type == JointType::Ball ? "ball" : "fixed";
  json["body_a"] = bodyReference(joint.bodyA);
  json["body_b"] = bodyReference(joint.bodyB);
  json["anchor_a"] = vectorJson(joint.anchorA);
  json["anchor_b"] = vectorJson(joint.anchorB);
  if (joint.type == JointType::Fixed) json["orientation_a_to_b"] = quaternionJson(joint.orientationAtoB);
  if (!same(joint.stiffness, kHard)) json["stiffness"] = limitJson(joint.stiffness, "hard");
  if (!same(joint.angularStiffness, kHard)) json["angular_stiffness"] = limitJson(joint.angularStiffness, "hard");
  if (!same(joint.breakForce, kUnbreakable)) json["break_force"] = limitJson(joint.breakForce, "never");
  if (!same(joint.breakTorque, kUnbreakable)) json["break_torque"] = limitJson(joint.breakTorque, "never");
  if (joint.collide != usual.collide) json["collide"] = joint.collide;
  return json;
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
    if (!same(push.angularVelocity, {})) entry["angular_velocity"] = vectorJson(push.angularVelocity);
    json["set_velocity"].push_back(std::move(entry));
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
  if (!scene.deformables.empty())
    throw Error("deformables", "none: scene files hold bodies and joints only", std::to_string(scene.deformables.size()));
  for (const BodyDef& body : scene.bodies) nameMaterial(body), countName(body);
  for (const Event& event : scene.events)
    for (const BodyDef& body : event.add) nameMaterial(body);

  Json json = Json::object();
  json["name"] = scene.name;
  if (!scene.description.empty()) json["description"] = scene.description;
  json["gravity"] = vectorJson(scene.gravity);
  json["steps"] = file_.steps;
  json["iterations"] = file_.iterations;
  if (file_.substeps != 1) json["substeps"] = file_.substeps;
  if (file_.smashStep >= 0) json["smash_step"] = file_.smashStep;
  if (!same(file_.dt, SceneFile{}.dt)) json["dt"] = file_.dt;
  if (file_.camera) json["camera"] = {{"eye", vectorJson(file_.camera->eye)}, {"target", vectorJson(file_.camera->target)}};
  for (const auto& [key, name] : materials_) json["materials"][name] = materialJson({key[0], key[1], key[2]});
  json["bodies"] = Json::array();
  for (const BodyDef& added : scene.bodies) json["bodies"].push_back(body(added));
  for (const JointDef& added : scene.joints) json["joints"].push_back(joint(added));
  for (const Event& added : scene.events) json["events"].push_back(event(added));
  for (const FileClaim& added : file_.claims) json["verdict"].push_back(claim(added));
  return json;
}

}  // namespace

std::string toJson(const SceneFile& scene) { return prettyJson(SceneWriter(scene).write()); }

void writeText(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  if (!out) throw Error(file, "a file that can be written", std::strerror(errno));
  out << text;
  if (!out.flush()) throw Error(file, "to be written in full", std::strerror(errno));
}

}  // namespace rubble::io
