#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "io/actuator_json.h"
#include "io/appearance_json.h"
#include "io/scene_reader.h"
#include "io/sensor_json.h"
#include "io/shape_json.h"
#include "io/soft_json.h"

namespace rubble::io {

const std::vector<std::string>& SceneReader::keys() {
  static const std::vector<std::string> all{
      "name",       "description", "gravity", "steps",  "iterations", "substeps", "dt",
      "smash_step", "materials",   "shapes",  "camera", "sun",        "sky"};
  return all;
}

/// Lists of a scene and what is expected of each, in the order in which they are read.
static constexpr std::pair<const char*, const char*> kLists[] = {
    {"material_pairs", "a list of rules for two materials"},
    {"bodies", "a list of bodies"},
    {"joints", "a list of joints"},
    {"deformables", "a list of deformable objects"},
    {"attachments", "a list of attachments"},
    {"exclusions", "a list of pairs of bodies"},
    {"events", "a list of events"},
    {"sensors", "a list of sensors"},
    {"actuators", "a list of actuators"},
    {"looks", "a list of looks"},
    {"cameras", "a list of cameras"},
    {"lights", "a list of lights"},
    {"verdict", "a list of claims"},
};

const std::vector<std::string>& SceneReader::lists() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names;
    for (const auto& entry : kLists) names.emplace_back(entry.first);
    return names;
  }();
  return all;
}

void SceneReader::set(SceneFile& out, const std::string& key, const Node& value) {
  const auto count = [&](int& target, int min, const char* text) {
    target = value.whole(min, text).value_or(target);
  };
  Scene& scene = out.scene;
  if (key == "name")
    scene.name = value.text().value_or(scene.name);
  else if (key == "description")
    scene.description = value.text().value_or(scene.description);
  else if (key == "gravity")
    scene.gravity = value.vector().value_or(scene.gravity);
  else if (key == "steps")
    count(out.steps, 1, "a whole number above 0");
  else if (key == "iterations")
    count(out.iterations, 1, "a whole number above 0");
  else if (key == "substeps")
    count(out.substeps, 1, "a whole number above 0");
  else if (key == "smash_step")
    count(out.smashStep, 0, "a whole number of at least 0");
  else if (key == "dt")
    out.dt = value.number({0, false, std::numeric_limits<double>::infinity(), "a time above 0 [s]"})
                 .value_or(out.dt);
  else if (key == "materials")
    bodyReader_.readMaterials(value);
  else if (key == "shapes")
    bodyReader_.readShapes(value);
  else if (key == "camera")
    out.camera = camera(value);
  else if (key == "sun")
    readSun(value, out.appearance.daylight);
  else if (key == "sky")
    out.appearance.daylight.skyStrength = value.number(kNotNegative).value_or(1);
  else
    value.faultText("expected a key of a scene, got " + describe(key) + hint(key, keys()));
}

void SceneReader::add(SceneFile& out, const std::string& list, const Node& element) {
  Scene& scene = out.scene;
  if (list == "material_pairs")
    scene.materialPairs.push_back(readMaterialPair(element));
  else if (list == "bodies")
    addBody(scene, element);
  else if (list == "joints")
    scene.joints.push_back(joint(element, scene));
  else if (list == "deformables")
    scene.deformables.push_back(readDeformable(
        element, [this](const Node& material) { return bodyReader_.material(material); }, folder_));
  else if (list == "attachments")
    scene.attachments.push_back(
        readAttachment(element, scene.deformables, [&](const Node& body) { return bodyIndex(body, scene); }));
  else if (list == "exclusions")
    addExclusion(scene, element);
  else if (list == "events")
    scene.events.push_back(event(element, scene));
  else if (list == "sensors")
    out.sensors.push_back(readSensor(
        element, [&](const Node& body) { return bodyIndex(body, scene); },
        [&](const Node& joint) { return jointIndex(joint, scene); }));
  else if (list == "actuators")
    out.actuators.push_back(readActuator(
        element, [&](const Node& body) { return bodyIndex(body, scene); },
        [&](const Node& joint) { return jointIndex(joint, scene); }));
  else if (list == "looks")
    addLook(out, element);
  else if (list == "cameras")
    addCamera(out, element);
  else if (list == "lights")
    addLight(out, element);
  else if (list == "verdict")
    out.claims.push_back(claim(element));
  else
    element.faultText("expected a list of a scene, got " + describe(list) + hint(list, lists()));
}

void SceneReader::adopt(const SceneFile& file) {
  for (std::size_t i = 0; i < file.scene.bodies.size(); ++i)
    if (const std::string& name = file.scene.bodies[i].name; !name.empty())
      bodies_.emplace(name, static_cast<int>(i));
  for (const JointDef& joint : file.scene.joints)
    if (!joint.name.empty()) joints_.insert(joint.name);
  for (const Event& event : file.scene.events)
    for (const BodyDef& body : event.add)
      if (!body.name.empty()) bodies_.emplace(body.name, -1);
}

void SceneReader::dropLast(SceneFile& out, const std::string& list) {
  Scene& scene = out.scene;
  if (list == "bodies" && !scene.bodies.empty()) {
    const auto found = bodies_.find(scene.bodies.back().name);
    scene.bodies.pop_back();
    if (found != bodies_.end() && found->second == static_cast<int>(scene.bodies.size()))
      bodies_.erase(found);
  } else if (list == "joints" && !scene.joints.empty()) {
    const std::string name = scene.joints.back().name;
    scene.joints.pop_back();
    const auto isNamed = [&](const JointDef& joint) { return joint.name == name; };
    if (std::none_of(scene.joints.begin(), scene.joints.end(), isNamed)) joints_.erase(name);
  } else if (list == "deformables" && !scene.deformables.empty()) {
    scene.deformables.pop_back();
  } else if (list == "attachments" && !scene.attachments.empty()) {
    scene.attachments.pop_back();
  } else if (list == "events" && !scene.events.empty()) {
    scene.events.pop_back();
  } else if (list == "sensors" && !out.sensors.empty()) {
    out.sensors.pop_back();
  } else if (list == "actuators" && !out.actuators.empty()) {
    out.actuators.pop_back();
  } else if (list == "looks" && !out.appearance.looks.empty()) {
    out.appearance.looks.pop_back();
  } else if (list == "cameras" && !out.appearance.cameras.empty()) {
    out.appearance.cameras.pop_back();
  } else if (list == "lights" && !out.appearance.lights.empty()) {
    out.appearance.lights.pop_back();
  } else if (list == "verdict" && !out.claims.empty()) {
    out.claims.pop_back();
  }
}

SceneFile SceneReader::read(const JsonValue& json) {
  SceneFile out;
  ObjectReader object(Node(json, "", faults_), "a scene");
  if (!object.isObject()) return out;
  for (const std::string& key : keys())
    if (const auto found = object.get(key)) set(out, key, *found);
  object.need("bodies", "a list of bodies");
  for (const auto& [list, what] : kLists)
    if (const auto found = object.get(list))
      for (const Node& element : found->elements(what)) add(out, list, element);
  object.finish();
  return out;
}

SceneFile parseScene(const std::string& text, std::vector<Fault>& faults, const std::string& folder) {
  const std::size_t before = faults.size();
  const std::optional<JsonDocument> json = parseJson(text, faults);
  if (!json) return {};
  SceneFile file = SceneReader(faults, folder).read(json->root());
  if (faults.size() == before) {
    // Conditions that the engine checks in addition to this reader.
    try {
      validate(file.scene);
    } catch (const Error& error) {
      faults.push_back({"", 0, 0, error.what()});
    }
  }
  return file;
}

std::string faultText(const std::string& file, const std::vector<Fault>& faults) {
  // A longer list would hide the first fault.
  constexpr std::size_t kShown = 50;
  std::string message = file + ": " + std::to_string(faults.size()) +
                        (faults.size() == 1 ? " fault" : " faults");
  for (std::size_t i = 0; i < std::min(faults.size(), kShown); ++i) message += "\n  " + faults[i].text();
  if (faults.size() > kShown) message += "\n  and " + std::to_string(faults.size() - kShown) + " more";
  return message;
}

std::string folderOf(const std::string& file) { return std::filesystem::path(file).parent_path().string(); }

SceneFile readScene(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (!in) throw Error(file, "a file that can be read", "none");
  if (in.peek() == std::ifstream::traits_type::eof())
    throw Error(file, "a scene", std::filesystem::is_directory(file) ? "a folder" : "an empty file");
  text << in.rdbuf();
  std::vector<Fault> faults;
  SceneFile scene = parseScene(text.str(), faults, folderOf(file));
  if (!faults.empty()) throw Error(faultText(file, faults));
  return scene;
}

}  // namespace rubble::io
