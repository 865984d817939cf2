#include "io/body_reader.h"

#include <array>

#include "cook/body_fields.h"
#include "io/field_json.h"
#include "io/shape_json.h"

namespace rubble::io {

const std::vector<std::string>& motionNames() {
  static const std::vector<std::string> names{"static", "kinematic", "dynamic"};
  return names;
}

namespace {

/// A list of layers, 0 to 31, as a bit set.
std::uint32_t readLayers(const Node& node) {
  std::uint32_t bits = 0;
  for (const Node& element : node.elements("a list of layers, 0 to 31")) {
    const auto layer = element.whole(0, "a layer, 0 to 31");
    if (layer && *layer > 31) element.fault("a layer, 0 to 31");
    if (layer && *layer <= 31) bits |= std::uint32_t{1} << *layer;
  }
  return bits;
}

/// A list of "x", "y", "z".
std::array<bool, 3> readAxes(const Node& node) {
  static const std::vector<std::string> kAxes{"x", "y", "z"};
  std::array<bool, 3> axes{};
  for (const Node& element : node.elements("a list of \"x\", \"y\", \"z\""))
    if (const auto axis = element.choice(kAxes)) axes[*axis] = true;
  return axes;
}

/// What a body meets, and how it is held back besides contacts and joints.
void readExtras(ObjectReader& object, BodyDef& out) {
  forEachField(kBodyFields, out,
               [&](const FieldInfo& field, auto& value) { readField(object, field, value); });
  if (const auto found = object.get("lock_translation")) out.lockTranslation = readAxes(*found);
  if (const auto found = object.get("lock_rotation")) out.lockRotation = readAxes(*found);
  if (const auto found = object.get("layers")) out.filter.layers = readLayers(*found);
  if (const auto found = object.get("mask")) out.filter.mask = readLayers(*found);
  if (const auto found = object.get("group"))
    out.filter.group = found->whole(std::numeric_limits<int>::min(), "a whole number").value_or(0);
  object.read("sensor", out.sensor);
  object.read("user_data", out.userData);
}

void checkName(const Node& node, const BodyDef& body) {
  if (body.name.empty()) return;
  const Node where = node.child("name");
  if (body.name == "world")
    where.faultText("expected a name other than \"world\", which joints use for the fixed world, got it");
  if (body.name.back() == '*')
    where.faultText("expected a name without a final '*', which stands for a prefix, got " +
                    describe(body.name));
}

}  // namespace

void BodyReader::readMaterials(const Node& node) {
  ObjectReader object(node, "an object with a material for each name");
  if (!object.isObject()) return;
  for (const JsonValue* const each : node.value().members()) {
    const std::string name(each->key());
    Material& read = materials_[name] = material(node.member(*each));
    // "name": "" is a material without a name
    if (each->isObject() && !each->find("name")) read.name = name;
  }
}

void BodyReader::readShapes(const Node& node) {
  ObjectReader object(node, "an object with a shape for each name");
  if (!object.isObject()) return;
  for (const JsonValue* const each : node.value().members())
    shapes_[std::string(each->key())] = shape(node.member(*each));
}

Shape BodyReader::shape(const Node& node) const {
  return readShape(node, shapes_, [this](const Node& part) { return material(part); });
}

Material BodyReader::material(const Node& node) const {
  if (node.value().isText()) {
    const std::string name(node.value().text());
    if (const auto found = materials_.find(name); found != materials_.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& entry : materials_) names.push_back(entry.first);
    node.faultText("expected a name in \"materials\", got " + describe(node.value()) + hint(name, names));
    return {};
  }
  return readMaterial(node);
}

BodyDef BodyReader::body(const Node& node) const {
  BodyDef out;
  ObjectReader object(node, "a body");
  if (!object.isObject()) return out;
  object.read("name", out.name);
  if (const auto found = object.get("motion"))
    out.motion = static_cast<Motion>(found->choice(motionNames()).value_or(2));
  const auto shapeNode = object.need("shape", "such as {\"type\": \"box\", \"size\": [1, 1, 1]}");
  if (shapeNode) out.shape = shape(*shapeNode);
  // A plane has no volume to move: it need not be said that it is static.
  if (out.shape.type == ShapeType::Plane) {
    if (!object.get("motion")) out.motion = Motion::Static;
    if (out.motion != Motion::Static)
      object.node().faultText("expected motion \"static\" for a plane, got another");
  }
  if (const auto found = object.get("material")) out.material = material(*found);
  const auto density = object.get("density"), mass = object.get("mass");
  if (density && mass) mass->faultText("expected either \"density\" or \"mass\", got both");
  const auto read = [&](const FieldInfo& field, auto& value) { readField(object, field, value); };
  forEachField(kMassFields, out, read), forEachField(kBodyStateFields, out, read);
  readExtras(object, out);
  object.finish();
  checkName(node, out);
  return out;
}

}  // namespace rubble::io
