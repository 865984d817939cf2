#include "io/body_reader.h"

#include <array>
#include <cmath>
#include <numbers>

namespace rubble::io {
namespace {

constexpr Want kLength{0, false, std::numeric_limits<double>::infinity(), "a length above 0 [m]"};
constexpr Want kNotNegative{0, true, std::numeric_limits<double>::infinity(), "a number of at least 0"};
constexpr Want kPositive{0, false, std::numeric_limits<double>::infinity(), "a number above 0"};
constexpr Want kRatio{0, true, 1, "a number from 0 to 1"};
/// A quaternion is taken as it is if its length is 1 to this much, and made unit if it is nearly so.
constexpr double kUnit = 1e-12;
constexpr double kNearlyUnit = 1e-3;

Shape readShape(const Node& node) {
  ObjectReader object(node, "a shape, such as {\"type\": \"box\", \"size\": [1, 1, 1]}");
  const auto type = object.need("type", "one of \"box\", \"sphere\", \"capsule\", \"plane\"");
  if (!type) return {};
  const auto choice = type->choice({"box", "sphere", "capsule", "plane"});
  if (!choice) return {};
  const auto lengthOf = [&](const char* key, const char* what) {
    const auto found = object.need(key, what);
    return found ? found->number(kLength).value_or(1) : 1;
  };
  Shape out;
  if (*choice == 0) {
    const auto size = object.need("size", "its three edge lengths [m]");
    out = Shape::box((size ? size->vector(kLength, "three edge lengths [m]").value_or(Vec3{1, 1, 1}) : Vec3{1, 1, 1}) * .5);
  } else if (*choice == 1) {
    out = Shape::sphere(lengthOf("radius", "its radius [m]"));
  } else if (*choice == 2) {
    const double radius = lengthOf("radius", "its radius [m]");
    out = Shape::capsule(radius, lengthOf("length", "the distance of the centres of its two ends [m]") / 2);
  } else {
    out = Shape::plane();
  }
  object.finish();
  return out;
}

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
  std::array<bool, 3> axes{};
  for (const Node& element : node.elements("a list of \"x\", \"y\", \"z\""))
    if (const auto axis = element.choice({"x", "y", "z"})) axes[*axis] = true;
  return axes;
}

/// What a body meets, and how it is held back besides contacts and joints.
void readExtras(ObjectReader& object, BodyDef& out) {
  if (const auto found = object.get("inertia"))
    out.inertia = found->vector({0, false, kPositive.max, "a moment of inertia above 0 [kg m2]"}, "three moments of inertia [kg m2]");
  object.read("linear_damping", out.linearDamping, kNotNegative);
  object.read("angular_damping", out.angularDamping, kNotNegative);
  if (const auto found = object.get("lock_translation")) out.lockTranslation = readAxes(*found);
  if (const auto found = object.get("lock_rotation")) out.lockRotation = readAxes(*found);
  if (const auto found = object.get("layers")) out.filter.layers = readLayers(*found);
  if (const auto found = object.get("mask")) out.filter.mask = readLayers(*found);
  if (const auto found = object.get("group")) out.filter.group = found->whole(std::numeric_limits<int>::min(), "a whole number").value_or(0);
  object.read("sensor", out.sensor);
}

void checkName(const Node& node, const BodyDef& body) {
  if (body.name.empty()) return;
  const Node where = node.child("name");
  if (body.name == "world") where.faultText("expected a name other than \"world\", which joints use for the fixed world, got it");
  if (body.name.back() == '*')
    where.faultText("expected a name without a final '*', which stands for a prefix, got " + describe(body.name));
}

}  // namespace

Quat readOrientation(const Node& node) {
  if (node.value().is_object()) {
    ObjectReader object(node);
    Vec3 axis{0, 0, 1};
    double degrees = 0;
    if (const auto found = object.need("axis", "a list of 3 numbers")) axis = found->vector().value_or(axis);
    if (const auto found = object.need("degrees", "an angle")) degrees = found->number().value_or(0);
    object.finish();
    if (!(lengthSquared(axis) > 0)) {
      node.child("axis").fault("an axis of some length");
      return {};
    }
    return fromAxisAngle(normalize(axis), degrees * std::numbers::pi / 180);
  }
  constexpr const char* kText = "a unit quaternion [w, x, y, z], or {\"axis\": [x, y, z], \"degrees\": angle}";
  std::array<double, 4> q{};
  if (!node.value().is_array() || node.value().size() != 4) {
    node.fault(kText);
    return {};
  }
  const std::vector<Node> parts = node.elements(kText);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto part = parts[i].number();
    if (!part) return {};
    q[i] = *part;
  }
  const Quat out{q[0], q[1], q[2], q[3]};
  const double size = std::sqrt(out.s * out.s + lengthSquared(out.v));
  if (!(std::fabs(size - 1) <= kNearlyUnit)) {
    node.faultText(std::string("expected ") + kText + ", got a length of " + Json(size).dump());
    return {};
  }
  return std::fabs(size - 1) <= kUnit ? out : normalize(out);
}

void BodyReader::readMaterials(const Node& node) {
  ObjectReader object(node, "an object with a material for each name");
  if (!object.isObject()) return;
  for (const auto& item : node.value().items()) materials_[item.key()] = material(node.child(item.key()));
}

Material BodyReader::material(const Node& node) const {
  Material out;
  if (node.value().is_string()) {
    const std::string name = node.value().get<std::string>();
    if (const auto found = materials_.find(name); found != materials_.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& entry : materials_) names.push_back(entry.first);
    node.faultText("expected a name in \"materials\", got " + describe(node.value()) + hint(name, names));
    return out;
  }
  ObjectReader object(node, "a material, or the name of one");
  const auto friction = object.get("friction");
  if (friction) {
    out.staticFriction = out.dynamicFriction = friction->number(kNotNegative).value_or(out.staticFriction);
    if (object.get("static_friction") || object.get("dynamic_friction"))
      friction->faultText("expected either \"friction\" or \"static_friction\" and \"dynamic_friction\", got both");
  }
  const bool staticGiven = object.get("static_friction").has_value();
  object.read("static_friction", out.staticFriction, kNotNegative);
  if (!friction && staticGiven && !object.get("dynamic_friction")) out.dynamicFriction = out.staticFriction;
  object.read("dynamic_friction", out.dynamicFriction, kNotNegative);
  object.read("restitution", out.restitution, kRatio);
  if (out.dynamicFriction > out.staticFriction)
    node.faultText("expected dynamic_friction of at most static_friction, got " + Json(out.dynamicFriction).dump() + " above " +
                   Json(out.staticFriction).dump());
  object.finish();
  return out;
}

BodyDef BodyReader::body(const Node& node) const {
  BodyDef out;
  ObjectReader object(node, "a body");
  if (!object.isObject()) return out;
  object.read("name", out.name);
  if (const auto found = object.get("motion"))
    out.motion = static_cast<Motion>(found->choice({"static", "kinematic", "dynamic"}).value_or(2));
  const auto shapeNode = object.need("shape", "such as {\"type\": \"box\", \"size\": [1, 1, 1]}");
  if (shapeNode) out.shape = readShape(*shapeNode);
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
  readExtras(object, out);
  object.finish();
  checkName(node, out);
  return out;
}

}  // namespace rubble::io
