#include "io/body_reader.h"

#include "io/shape_json.h"

namespace rubble::io {
namespace {

constexpr Want kPositive{0, false, std::numeric_limits<double>::infinity(), "a number above 0"};

void checkName(const Node& node, const BodyDef& body) {
  if (body.name.empty()) return;
  const Node where = node.child("name");
  if (body.name == "world") where.faultText("expected a name other than \"world\", which joints use for the fixed world, got it");
  if (body.name.back() == '*')
    where.faultText("expected a name without a final '*', which stands for a prefix, got " + describe(body.name));
}

}  // namespace

void BodyReader::readMaterials(const Node& node) {
  ObjectReader object(node, "an object with a material for each name");
  if (!object.isObject()) return;
  for (const auto& item : node.value().items()) materials_[item.key()] = material(node.child(item.key()));
}

void BodyReader::readShapes(const Node& node) {
  ObjectReader object(node, "an object with a shape for each name");
  if (!object.isObject()) return;
  for (const auto& item : node.value().items()) shapes_[item.key()] = shape(node.child(item.key()));
}

Shape BodyReader::shape(const Node& node) const {
  return readShape(node, shapes_, [this](const Node& part) { return material(part); });
}

Material BodyReader::material(const Node& node) const {
  if (node.value().is_string()) {
    const std::string name = node.value().get<std::string>();
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
    out.motion = static_cast<Motion>(found->choice({"static", "kinematic", "dynamic"}).value_or(2));
  const auto shapeNode = object.need("shape", "such as {\"type\": \"box\", \"size\": [1, 1, 1]}");
  if (shapeNode) out.shape = shape(*shapeNode);
  // A plane has no volume to move: it need not be said that it is static.
  if (out.shape.type == ShapeType::Plane) {
    if (!object.get("motion")) out.motion = Motion::Static;
    if (out.motion != Motion::Static) object.node().faultText("expected motion \"static\" for a plane, got another");
  }
  if (const auto found = object.get("material")) out.material = material(*found);
  const auto density = object.get("density"), mass = object.get("mass");
  if (density && mass) mass->faultText("expected either \"density\" or \"mass\", got both");
  if (density) out.density = density->number({0, false, kPositive.max, "a density above 0 [kg/m3]"}).value_or(out.density);
  if (mass) out.mass = mass->number({0, false, kPositive.max, "a mass above 0 [kg]"});
  object.read("position", out.position);
  if (const auto found = object.get("orientation")) out.orientation = readOrientation(*found);
  object.read("velocity", out.velocity);
  object.read("angular_velocity", out.angularVelocity);
  object.read("gravity_scale", out.gravityScale);
  object.finish();
  checkName(node, out);
  return out;
}

}  // namespace rubble::io
