#include "io/scene_reader.h"

#include <algorithm>

#include "io/appearance_json.h"
#include "io/joint_reader.h"
#include "io/shape_json.h"

namespace rubble::io {

std::vector<std::string> SceneReader::bodyNames() const {
  std::vector<std::string> names;
  for (const auto& entry : bodies_) names.push_back(entry.first);
  return names;
}

int SceneReader::bodyIndex(const Node& node, const Scene& scene) {
  if (node.value().isInteger()) {
    const auto index = node.whole(0, "the index of a body, from 0");
    if (index && *index < static_cast<int>(scene.bodies.size())) return *index;
    if (index) node.fault("the index of one of " + std::to_string(scene.bodies.size()) + " bodies");
    return kWorld;
  }
  const auto name = node.text();
  if (!name || *name == "world") return kWorld;
  const auto found = bodies_.find(*name);
  if (found != bodies_.end() && found->second >= 0) return found->second;
  node.faultText("expected the name or index of a body, or \"world\", got " + describe(node.value()) +
                 hint(*name, bodyNames()));
  return kWorld;
}

int SceneReader::jointIndex(const Node& node, const Scene& scene) {
  if (node.value().isInteger()) {
    const auto index = node.whole(0, "the index of a joint, from 0");
    if (index && *index < static_cast<int>(scene.joints.size())) return *index;
    if (index) node.fault("the index of one of " + std::to_string(scene.joints.size()) + " joints");
    return -1;
  }
  const std::string name = node.text().value_or("");
  const auto found = std::ranges::find(scene.joints, name, &JointDef::name);
  if (!name.empty() && found != scene.joints.end()) return static_cast<int>(found - scene.joints.begin());
  node.faultText("expected the name or index of a joint, got " + describe(node.value()) +
                 hint(name, {joints_.begin(), joints_.end()}));
  return -1;
}

/// Index of a joint that the file has named earlier, or -1.
int SceneReader::jointOfType(const Node& node, const Scene& scene, JointType type) {
  const std::string name = node.text().value_or("");
  const auto found = std::find_if(scene.joints.begin(), scene.joints.end(),
                                  [&](const JointDef& joint) { return joint.name == name; });
  if (!name.empty() && found != scene.joints.end() && found->type == type)
    return static_cast<int>(found - scene.joints.begin());
  node.faultText(std::string("expected the name of a ") + keyword(type) + " further up, got " +
                 describe(node.value()) + hint(name, {joints_.begin(), joints_.end()}));
  return -1;
}

/// A gear of two hinges, or a rack of a hinge and a slider: bodies, frame bodies and axes come from them.
void SceneReader::coupling(ObjectReader& object, JointDef& out, const Scene& scene) {
  const bool rack = out.type == JointType::Rack;
  if (!rack && out.type != JointType::Gear) {
    object.node().faultText(
        "expected \"joint_a\" and \"joint_b\" only for a gear or a rack, got them for another joint");
    return;
  }
  const auto a = object.need("joint_a", "the name of a hinge"),
             b = object.need("joint_b", "the name of a hinge, or of a slider for a rack");
  if (!a || !b) return;
  const int first = jointOfType(*a, scene, JointType::Hinge),
            second = jointOfType(*b, scene, rack ? JointType::Slider : JointType::Hinge);
  if (first < 0 || second < 0) return;
  const std::string name = out.name;
  out = rack ? rackBetween(scene, first, second, 1) : gearBetween(scene, first, second, 1);
  out.name = name;
  readJointValues(object, out);
}

JointDef SceneReader::joint(const Node& node, const Scene& scene) {
  JointDef out;
  ObjectReader object(node, "a joint");
  if (!object.isObject()) return out;
  object.read("name", out.name);
  if (const auto found = object.need("type", "\"ball\", \"hinge\" or another of the joint types"))
    out.type = static_cast<JointType>(found->choice(jointKeywords()).value_or(0));
  const auto ja = object.get("joint_a"), jb = object.get("joint_b");
  if (ja || jb) {
    coupling(object, out, scene);
  } else {
    const auto a = object.need("body_a", "the name or index of a body, or \"world\"");
    const auto b = object.need("body_b", "the name or index of a body, or \"world\"");
    const std::size_t before = faults_.size();
    if (a) out.bodyA = bodyIndex(*a, scene);
    if (b) out.bodyB = bodyIndex(*b, scene);
    if (const auto frameBody = object.get("frame_body_a")) out.frameBodyA = bodyIndex(*frameBody, scene);
    if (const auto frameBody = object.get("frame_body_b")) out.frameBodyB = bodyIndex(*frameBody, scene);
    if (a && b && faults_.size() == before && out.bodyA == out.bodyB)
      node.faultText("expected two different bodies, got one twice");
    readJoint(object, out, scene);
  }
  object.finish();
  if (!out.name.empty() && !joints_.insert(out.name).second)
    node.child("name").faultText("expected a name of its own, got " + describe(out.name) + " again");
  return out;
}

void SceneReader::checkRemoval(const Node& node, const std::string& pattern, const Scene&) {
  const bool prefix = !pattern.empty() && pattern.back() == '*';
  const std::string stem = prefix ? pattern.substr(0, pattern.size() - 1) : pattern;
  const bool known = prefix ? std::any_of(bodies_.begin(), bodies_.end(),
                                          [&](const auto& entry) { return entry.first.starts_with(stem); })
                            : bodies_.contains(pattern);
  if (!known)
    node.faultText("expected the name of a body, or the beginning of one and '*', got " +
                   describe(node.value()) + hint(stem, bodyNames()));
}

Event SceneReader::event(const Node& node, const Scene& scene) {
  Event out;
  ObjectReader object(node, "an event");
  if (!object.isObject()) return out;
  if (const auto found = object.need("step", "the step that it comes before"))
    out.step = found->whole(0, "a whole number of at least 0").value_or(0);
  if (const auto found = object.get("add")) {
    for (const Node& element : found->elements("a list of bodies")) {
      out.add.push_back(bodyReader_.body(element));
      if (!out.add.back().name.empty()) bodies_.emplace(out.add.back().name, -1);
    }
  }
  if (const auto found = object.get("remove")) {
    for (const Node& element : found->elements("a list of names")) {
      const auto pattern = element.text();
      if (!pattern) continue;
      checkRemoval(element, *pattern, scene);
      out.remove.push_back(*pattern);
    }
  }
  if (const auto found = object.get("remove_joints")) {
    for (const Node& element : found->elements("a list of names")) {
      const auto name = element.text();
      if (!name) continue;
      if (!joints_.contains(*name))
        element.faultText("expected the name of a joint, got " + describe(element.value()) +
                          hint(*name, {joints_.begin(), joints_.end()}));
      out.removeJoints.push_back(*name);
    }
  }
  if (const auto found = object.get("set_velocity")) {
    for (const Node& element : found->elements("a list")) {
      Event::Push push;
      ObjectReader reader(element, "an object with a body and its new velocity");
      if (const auto name = reader.need("body", "the name of a body")) {
        push.body = name->text().value_or("");
        if (!push.body.empty() && !bodies_.contains(push.body))
          name->faultText("expected the name of a body, got " + describe(name->value()) +
                          hint(push.body, bodyNames()));
      }
      reader.read("velocity", push.velocity);
      reader.read("angular_velocity", push.angularVelocity);
      reader.finish();
      out.setVelocity.push_back(push);
    }
  }
  if (const auto found = object.get("set_joint")) {
    for (const Node& element : found->elements("a list")) out.setJoint.push_back(turn(element));
  }
  object.finish();
  return out;
}

Event::Turn SceneReader::turn(const Node& node) {
  Event::Turn out;
  ObjectReader object(node, "an object with a joint and its new targets");
  if (const auto name = object.need("joint", "the name of a joint")) {
    out.joint = name->text().value_or("");
    if (!out.joint.empty() && !joints_.contains(out.joint))
      name->faultText("expected the name of a joint, got " + describe(name->value()) +
                      hint(out.joint, {joints_.begin(), joints_.end()}));
  }
  if (const auto found = object.get("axis"))
    out.axis = found->whole(0, "the number of an axis, from 0").value_or(0);
  if (const auto found = object.get("target_position")) out.targetPosition = found->number();
  if (const auto found = object.get("target_speed")) out.targetSpeed = found->number();
  if (const auto found = object.get("motor_force")) out.motorForce = found->number();
  if (const auto found = object.get("length")) out.length = found->number();
  if (const auto found = object.get("drag_to")) out.dragTo = found->vector();
  object.finish();
  return out;
}

FileClaim SceneReader::claim(const Node& node) {
  FileClaim out;
  ObjectReader object(node, "a claim, such as {\"metric\": \"max_speed_m_s\", \"max\": 0.01}");
  if (!object.isObject()) return out;
  if (const auto found = object.need("metric", "the name of what is measured"))
    out.metric = found->text().value_or("");
  object.read("min", out.min);
  object.read("max", out.max);
  object.read("why", out.why);
  if (!object.get("min") && !object.get("max"))
    node.faultText("expected \"min\", \"max\" or both, got neither");
  if (out.min > out.max)
    node.faultText("expected min of at most max, got " + describe(out.min) + " above " + describe(out.max));
  object.finish();
  return out;
}

FileCamera SceneReader::camera(const Node& node) {
  FileCamera out;
  ObjectReader object(node, "a camera");
  if (const auto found = object.need("eye", "a point [m]")) out.eye = found->vector().value_or(out.eye);
  if (const auto found = object.need("target", "a point [m]"))
    out.target = found->vector().value_or(out.target);
  if (out.eye == out.target) node.faultText("expected an eye away from the target, got one point");
  object.finish();
  return out;
}

void SceneReader::addBody(Scene& scene, const Node& element) {
  scene.bodies.push_back(bodyReader_.body(element));
  const BodyDef& added = scene.bodies.back();
  const int index = static_cast<int>(scene.bodies.size()) - 1;
  if (!added.name.empty() && !bodies_.emplace(added.name, index).second)
    element.child("name").faultText("expected a name of its own, got " + describe(added.name) + " again");
}

void SceneReader::addLook(SceneFile& out, const Node& element) {
  std::vector<Look>& looks = out.appearance.looks;
  Look look = readLook(
      element, [&](const Node& body) { return bodyIndex(body, out.scene); },
      [&](const Node& shape) { return bodyReader_.shape(shape); }, out.scene.bodies);
  if (std::ranges::count(looks, look.body, &Look::body) > 0)
    element.child("body").faultText("expected a body without another look, got one with two");
  looks.push_back(std::move(look));
}

void SceneReader::addCamera(SceneFile& out, const Node& element) {
  std::vector<NamedCamera>& cameras = out.appearance.cameras;
  NamedCamera camera = readNamedCamera(element);
  if (std::ranges::count(cameras, camera.name, &NamedCamera::name) > 0)
    element.child("name").faultText("expected a name of its own, got " + describe(camera.name) + " again");
  cameras.push_back(std::move(camera));
}

void SceneReader::addLight(SceneFile& out, const Node& element) {
  std::vector<PointLight>& lights = out.appearance.lights;
  PointLight light = readPointLight(element);
  if (lights.size() < kMostPointLights) return lights.push_back(light);
  element.faultText("expected at most " + std::to_string(kMostPointLights) + " lights, got more");
}

void SceneReader::addExclusion(Scene& scene, const Node& element) {
  const std::vector<Node> two = element.elements("two bodies");
  if (two.size() != 2) return element.fault("two bodies");
  const int a = bodyIndex(two[0], scene), b = bodyIndex(two[1], scene);
  if (a == b || a == kWorld || b == kWorld)
    element.faultText("expected two different bodies of the scene");
  else
    scene.exclusions.emplace_back(a, b);
}

}  // namespace rubble::io
