#include "io/definition_json.h"

#include "io/body_reader.h"
#include "io/field_json.h"
#include "io/joint_reader.h"
#include "io/shape_json.h"
#include "io/soft_json.h"

namespace rubble::io {
namespace {

constexpr FieldRules kPositiveRule{FieldRange::Positive}, kNotNegativeRule{FieldRange::NotNegative},
    kMayBreakRule{FieldRange::Positive, "never"};

constexpr std::tuple kRodNumbers{
    field("radius", "m", "of its circular section", &RodDef::radius, kPositiveRule),
    field("youngs_modulus", "Pa", "E", &RodDef::youngsModulus, kPositiveRule),
    field("poisson_ratio", "1", "nu, -1 to 0.5", &RodDef::poissonRatio),
    field("density", "kg/m3", "of the rod", &RodDef::density, kPositiveRule),
    field("viscosity", "Pa s", "of the strain rate", &RodDef::viscosity, kNotNegativeRule),
    field("break_force", "N", "per joint", &RodDef::breakForce, kMayBreakRule),
    field("break_torque", "N m", "per joint", &RodDef::breakTorque, kMayBreakRule)};

Material inlineMaterial(const Node& node) { return readMaterial(node); }

void readEnd(ObjectReader& object, const char* key, std::optional<int>& out) {
  const auto node = object.get(key);
  if (!node) return;
  const bool isWorld = node->value().isText("world");
  out = isWorld ? kWorld : node->whole(0, "the index of a body, or \"world\"").value_or(kWorld);
}

void readTypeAndName(ObjectReader& object, JointDef& out) {
  object.read("name", out.name);
  if (const auto found = object.need("type", "\"ball\", \"hinge\" or another of the joint types"))
    out.type = static_cast<JointType>(found->choice(jointKeywords()).value_or(0));
}

/// The parameter of a key, or null.
const ParamField* parameterOf(std::string_view key) {
  for (const ParamField& field : paramFields())
    if (parameterKey(field.name) == key) return &field;
  return nullptr;
}

void readParameters(ObjectReader& object, Params& params) {
  for (const JsonValue* const member : object.node().value().members()) {
    const ParamField* const field = parameterOf(member->key());
    if (!field) continue;
    const auto node = object.get(member->key());
    const auto value = node->value().isBoolean() ? std::optional<double>(node->boolean().value_or(false))
                                                 : node->number();
    if (value) setParam(params, field->name, *value);
  }
}

}  // namespace

Error errorOf(const Fault& fault) {
  const std::string expected = "expected ", found = ", got ";
  const std::size_t got = fault.message.rfind(found);
  if (fault.line > 0)
    return Error("line " + std::to_string(fault.line) + ", column " + std::to_string(fault.column), "JSON",
                 fault.message);
  if (fault.message.starts_with(expected) && got != std::string::npos)
    return Error(fault.path, fault.message.substr(expected.size(), got - expected.size()),
                 fault.message.substr(got + found.size()));
  return fault.path.empty() ? Error(fault.message) : Error(fault.path, "a key of this object", fault.message);
}

void readDefinition(const std::string& text, const std::string& path,
                    const std::function<void(const Node&)>& read) {
  std::vector<Fault> faults;
  const std::optional<JsonDocument> json = parseJson(text, faults);
  if (json && faults.empty()) read(Node(json->root(), path, faults));
  if (!faults.empty()) throw errorOf(faults.front());
}

std::vector<BodyDef> parseBodies(const std::string& text, const std::string& path) {
  std::vector<BodyDef> out;
  readDefinition(text, path, [&](const Node& node) {
    const BodyReader reader;
    for (const Node& element : node.elements("a list of bodies")) out.push_back(reader.body(element));
  });
  return out;
}

BodyDef parseBody(const std::string& text, const std::string& path) {
  BodyDef out;
  readDefinition(text, path, [&](const Node& node) { out = BodyReader().body(node); });
  return out;
}

void parseBodyValues(const std::string& text, BodyDef& body, const std::string& path) {
  using Ordered = nlohmann::ordered_json;
  const Ordered values = Ordered::parse(text, nullptr, false);
  if (!values.is_object()) throw Error(path, "an object with values of a body", text);
  BodyDef bare = body;
  bare.shape = Shape{};  // geometry may be large
  Ordered all = Ordered::parse(toJson(bare));
  if (values.contains("mass")) all.erase("density");
  if (values.contains("density")) all.erase("mass");
  all.merge_patch(values);
  BodyDef out = parseBody(all.dump(), path);
  if (!values.contains("shape")) out.shape = body.shape;
  body = std::move(out);
}

void parseDeformableValues(const std::string& text, Deformable& object, const std::string& path) {
  using Ordered = nlohmann::ordered_json;
  const Ordered values = Ordered::parse(text, nullptr, false);
  if (!values.is_object()) throw Error(path, "an object with values of a deformable object", text);
  Ordered all = Ordered::parse(toJson(object));
  all.merge_patch(values);
  object = parseDeformable(all.dump(), "", path);
}

MaterialPair parseMaterialPair(const std::string& text, const std::string& path) {
  MaterialPair out;
  readDefinition(text, path, [&](const Node& node) { out = readMaterialPair(node); });
  return out;
}

Shape parseShape(const std::string& text, const std::string& path) {
  Shape out;
  readDefinition(text, path, [&](const Node& node) { out = readShape(node, {}, inlineMaterial); });
  return out;
}

Deformable parseDeformable(const std::string& text, const std::string& folder, const std::string& path) {
  Deformable out;
  readDefinition(text, path, [&](const Node& node) { out = readDeformable(node, inlineMaterial, folder); });
  return out;
}

JointDef parseJoint(const std::string& text, const Scene& around, const std::array<int, 4>& bodies,
                    const std::string& path) {
  JointDef out;
  readDefinition(text, path, [&](const Node& node) {
    ObjectReader object(node, "a joint");
    if (!object.isObject()) return;
    readTypeAndName(object, out);
    out.bodyA = bodies[0], out.bodyB = bodies[1];
    out.frameBodyA = bodies[2], out.frameBodyB = bodies[3];
    readJoint(object, out, around);
    object.finish();
  });
  return out;
}

JointDef parseCoupling(const std::string& text, const Scene& around, const std::string& path) {
  JointDef out;
  readDefinition(text, path, [&](const Node& node) {
    ObjectReader object(node, "a gear or a rack");
    if (!object.isObject()) return;
    readTypeAndName(object, out);
    const std::string name = out.name;
    if (out.type != JointType::Gear && out.type != JointType::Rack)
      return node.child("type").fault("\"gear\" or \"rack\"");
    out = out.type == JointType::Rack ? rackBetween(around, 0, 1, 1) : gearBetween(around, 0, 1, 1);
    out.name = name;
    readJointValues(object, out);
    object.finish();
  });
  return out;
}

void parseJointValues(const std::string& text, JointDef& joint, const std::string& path) {
  readDefinition(text, path, [&](const Node& node) {
    ObjectReader object(node, "an object with values of a joint");
    if (!object.isObject()) return;
    object.read("name", joint.name);
    forEachField(kPlacementFields, joint,
                 [&](const FieldInfo& field, auto& value) { readField(object, field, value); });
    readJointValues(object, joint);
    object.finish();
  });
}

AttachmentDef parseAttachment(const std::string& text, const std::string& path) {
  AttachmentDef out;
  readDefinition(text, path, [&](const Node& node) { out = readAttachment(node); });
  return out;
}

RodDef parseRod(const std::string& text, const std::string& path) {
  RodDef out;
  readDefinition(text, path, [&](const Node& node) {
    ObjectReader object(node, "a rod");
    if (!object.isObject()) return;
    object.read("name", out.name);
    if (const auto found = object.need("points", "a list of two points or more [m]"))
      for (const Node& element : found->elements("a list of points"))
        out.points.push_back(element.vector().value_or(Vec3{}));
    forEachField(kRodNumbers, out,
                 [&](const FieldInfo& field, double& value) { readField(object, field, value); });
    readEnd(object, "start", out.start);
    readEnd(object, "end", out.end);
    if (const auto found = object.get("material")) out.material = inlineMaterial(*found);
    object.finish();
  });
  return out;
}

WorldOptions parseOptions(const std::string& text, const std::string& path) {
  WorldOptions out;
  readDefinition(text, path, [&](const Node& node) {
    ObjectReader object(node, "an object with options of a world");
    if (!object.isObject()) return;
    object.read("backend", out.backend);
    if (const auto found = object.get("threads"))
      out.threads = found->whole(0, "a number of threads, 0 for one per core").value_or(0);
    if (const auto found = object.get("preset"))
      out.params = Params::of(static_cast<Preset>(found->choice({"engine", "paper", "demo3d"}).value_or(0)));
    object.read("timings", out.timings);
    object.read("events", out.events);
    object.read("instruction_set", out.instructionSet);
    readParameters(object, out.params);
    object.finish();
  });
  return out;
}

void parseParams(const std::string& text, Params& params, const std::string& path) {
  readDefinition(text, path, [&](const Node& node) {
    ObjectReader object(node, "an object with parameters");
    if (!object.isObject()) return;
    readParameters(object, params);
    object.finish();
  });
}

std::string parameterKey(const std::string& name) {
  std::string key;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z')
      key += {'_', static_cast<char>(c - 'A' + 'a')};
    else
      key += c;
  }
  return key;
}

std::string toJson(const BodyDef& body) {
  using Ordered = nlohmann::ordered_json;
  SceneFile file;
  file.scene.bodies.push_back(body);
  const Ordered scene = Ordered::parse(toJson(file));
  Ordered json = scene.at("bodies").at(0);
  if (json.contains("material")) json["material"] = materialJson(body.material);
  return json.dump();
}

std::string toJson(const JointDef& joint) {
  const auto reference = [](int body) {
    return body == kWorld ? nlohmann::ordered_json("world") : nlohmann::ordered_json(body);
  };
  return jointJson(joint, reference).dump();
}

std::string toJson(const Deformable& deformable) {
  return deformableJson(deformable, materialJson(common(deformable).material)).dump();
}

std::string toJson(const Material& material) { return materialJson(material).dump(); }

std::string toJson(std::span<const MaterialPair> pairs) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const MaterialPair& pair : pairs) json.push_back(materialPairJson(pair));
  return json.dump();
}

std::string toJson(const Params& params) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const ParamField& field : paramFields()) {
    const std::string_view unit = field.unit;
    const double value = field.get(params);
    if (unit == "bool")
      json[parameterKey(field.name)] = value != 0;
    else
      json[parameterKey(field.name)] = value;
  }
  return json.dump();
}

}  // namespace rubble::io
