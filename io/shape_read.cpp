#include <array>
#include <cmath>
#include <numbers>

#include "cook/body_fields.h"
#include "cook/shape_traits.h"
#include "io/field_json.h"
#include "io/shape_json.h"

namespace rubble::io {
namespace {

constexpr Want kLength{0, false, std::numeric_limits<double>::infinity(), "a length above 0 [m]"};
constexpr Want kRatio{0, true, 1, "a number from 0 to 1"};
/// A quaternion is taken as it is if its length is 1 to this much, and made unit if it is nearly so.
constexpr double kUnit = 1e-12;
constexpr double kNearlyUnit = 1e-3;

const std::vector<std::string>& shapeKeywords() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const ShapeTraits& traits : shapeTraits()) all.emplace_back(traits.name);
    return all;
  }();
  return names;
}

}  // namespace

const std::vector<std::string>& combineNames() {
  static const std::vector<std::string> names{"usual",    "average", "minimum",
                                              "multiply", "maximum", "geometric_mean"};
  return names;
}

namespace {

std::string oneOf(const std::vector<std::string>& names) {
  std::string out = "one of ";
  for (const std::string& name : names) out += (out.size() > 7 ? ", \"" : "\"") + name + "\"";
  return out;
}

std::vector<Vec3> readPoints(ObjectReader& object, const char* key) {
  std::vector<Vec3> out;
  if (const auto list = object.need(key, "a list of points [m]"))
    for (const Node& node : list->elements("a list of points [m]"))
      out.push_back(node.vector().value_or(Vec3{}));
  return out;
}

std::vector<double> readNumbers(ObjectReader& object, const char* key, const char* what) {
  std::vector<double> out;
  if (const auto list = object.need(key, what))
    for (const Node& node : list->elements(what)) out.push_back(node.number().value_or(0));
  return out;
}

MassProperties readMassProperties(const Node& node) {
  MassProperties out;
  ObjectReader object(node, "mass properties");
  if (const auto mass = object.need("mass", "a mass [kg]")) out.mass = mass->number(kPositive).value_or(1);
  if (const auto inertia = object.need("inertia", "three principal moments [kg m2]"))
    out.inertia = inertia->vector(kPositive, "a list of 3 numbers above 0").value_or(Vec3{1, 1, 1});
  object.read("center", out.center);
  if (const auto axes = object.get("axes")) out.axes = readOrientation(*axes);
  object.finish();
  return out;
}

template <std::size_t count>
std::array<int, count> readCounts(const Node& node, int least, const char* what) {
  std::array<int, count> out;
  out.fill(least);
  const std::vector<Node> list = node.elements(what);
  if (list.size() != count) {
    if (node.value().isList()) node.fault(what);
    return out;
  }
  for (std::size_t i = 0; i < count; ++i) out[i] = list[i].whole(least, what).value_or(least);
  return out;
}

}  // namespace

Shape readShape(const Node& node, const std::map<std::string, Shape>& named,
                const std::function<Material(const Node&)>& material) {
  if (node.value().isText()) {
    const std::string name(node.value().text());
    if (const auto found = named.find(name); found != named.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& entry : named) names.push_back(entry.first);
    node.faultText("expected a name in \"shapes\", got " + describe(node.value()) + hint(name, names));
    return {};
  }
  ObjectReader object(node, "a shape, such as {\"type\": \"box\", \"size\": [1, 1, 1]}");
  static const std::string kTypes = oneOf(shapeKeywords());
  const auto type = object.need("type", kTypes);
  if (!type) return {};
  const auto choice = type->choice(shapeKeywords());
  if (!choice) return {};
  const std::string& name = shapeKeywords()[*choice];
  const auto lengthOf = [&](const char* key, const char* what) {
    const auto found = object.need(key, what);
    return found ? found->number(kLength).value_or(1) : 1;
  };
  const ShapeTraits& traits = shapeTraits()[*choice];
  Shape out{traits.type, {}, 0, 0};
  if (name == "hull") {
    out = Shape::hull(readPoints(object, "points"));
  } else if (name == "compound") {
    std::vector<ShapePartDef> parts;
    if (const auto list = object.need("parts", "a list of parts"))
      for (const Node& entry : list->elements("a list of parts")) {
        ObjectReader part(entry, "a part");
        ShapePartDef def;
        if (const auto shape = part.need("shape", "a shape")) def.shape = readShape(*shape, named, material);
        part.read("position", def.position);
        if (const auto found = part.get("orientation")) def.orientation = readOrientation(*found);
        if (const auto found = part.get("material")) def.material = material(*found);
        part.read("density", def.density, kPositive);
        part.finish();
        parts.push_back(std::move(def));
      }
    std::optional<MassProperties> mass;
    if (const auto found = object.get("mass_properties")) mass = readMassProperties(*found);
    out = Shape::compound(std::move(parts), mass);
  } else if (name == "mesh") {
    std::vector<Vec3> points = readPoints(object, "vertices");
    std::vector<std::array<int, 3>> triangles;
    constexpr const char* kText = "three places in \"vertices\"";
    if (const auto list = object.need("triangles", "a list of triangles"))
      for (const Node& entry : list->elements("a list of triangles"))
        triangles.push_back(readCounts<3>(entry, 0, kText));
    bool twoSided = false;
    object.read("two_sided", twoSided);
    out = Shape::mesh(std::move(points), std::move(triangles), twoSided);
  } else if (name == "height_field") {
    std::array<int, 2> counts{2, 2};
    if (const auto found = object.need("counts", "samples along x and y"))
      counts = readCounts<2>(*found, 2, "two counts of at least 2");
    Vec3 spacing{1, 1, 0};
    if (const auto found = object.need("spacing", "two lengths [m]")) {
      const std::vector<Node> list = found->elements("two lengths [m]");
      if (list.size() == 2)
        spacing = {list[0].number(kLength).value_or(1), list[1].number(kLength).value_or(1), 0};
      else if (found->value().isList())
        found->fault("two lengths [m]");
    }
    out = Shape::heightField(counts[0], counts[1], spacing,
                             readNumbers(object, "heights", "a list of heights [m]"));
  } else if (name == "distance_field") {
    std::array<int, 3> counts{2, 2, 2};
    if (const auto found = object.need("counts", "samples along x, y and z"))
      counts = readCounts<3>(*found, 2, "three counts of at least 2");
    Vec3 origin;
    object.read("origin", origin);
    const double spacing = lengthOf("spacing", "the distance of samples [m]");
    out = Shape::distanceField(counts, origin, spacing,
                               readNumbers(object, "distances", "a list of distances [m]"));
  }
  for (const ShapeField& field : traits.fields) {
    if (field.rules.always && !object.get(field.key))
      object.need(field.key, field.doc + std::string(" [") + field.unit + "]");
    field.visit(out, [&](auto& value) { readField(object, field, value); });
  }
  object.read("user_data", out.userData);
  object.finish();
  return out;
}

Material readMaterial(const Node& node) {
  Material out;
  ObjectReader object(node, "a material, or the name of one");
  const auto friction = object.get("friction");
  if (friction) {
    out.staticFriction = out.dynamicFriction = friction->number(kNotNegative).value_or(out.staticFriction);
    if (object.get("static_friction") || object.get("dynamic_friction"))
      friction->faultText(
          "expected either \"friction\" or \"static_friction\" and \"dynamic_friction\", got both");
  }
  const bool staticGiven = object.get("static_friction").has_value();
  object.read("static_friction", out.staticFriction, kNotNegative);
  if (!friction && staticGiven && !object.get("dynamic_friction")) out.dynamicFriction = out.staticFriction;
  object.read("dynamic_friction", out.dynamicFriction, kNotNegative);
  object.read("restitution", out.restitution, kRatio);
  if (out.dynamicFriction > out.staticFriction)
    node.faultText("expected dynamic_friction of at most static_friction, got " +
                   describe(out.dynamicFriction) + " above " + describe(out.staticFriction));
  const auto rule = [&](const char* key, Combine& to) {
    if (const auto found = object.get(key))
      to = static_cast<Combine>(found->choice(combineNames()).value_or(0));
  };
  rule("friction_combine", out.frictionCombine);
  rule("restitution_combine", out.restitutionCombine);
  forEachField(kSurfaceFields, out,
               [&](const FieldInfo& field, auto& value) { readField(object, field, value); });
  object.read("name", out.name);
  object.finish();
  return out;
}

MaterialPair readMaterialPair(const Node& node) {
  MaterialPair out;
  ObjectReader object(node, "a rule for two materials");
  for (const auto& [key, to] : {std::pair("a", &out.a), std::pair("b", &out.b)})
    if (const auto name = object.need(key, "the name of a material")) *to = name->text().value_or("");
  const auto read = [&](const char* key, std::optional<double>& to, const Want& range) {
    if (const auto found = object.get(key)) to = found->number(range);
  };
  read("friction", out.staticFriction, kNotNegative);
  out.dynamicFriction = out.staticFriction;
  read("restitution", out.restitution, kRatio);
  forEachField(kMaterialPairFields, out, [&](const FieldInfo& field, auto& value) {
    if (!field.is("restitution")) readField(object, field, value);
  });
  object.finish();
  return out;
}

Quat readOrientation(const Node& node) {
  if (node.value().isObject()) {
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
  constexpr const char*
      kText = "a unit quaternion [w, x, y, z], or {\"axis\": [x, y, z], \"degrees\": angle}";
  std::array<double, 4> q{};
  if (!node.value().isList() || node.value().size() != 4) {
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
    node.faultText(std::string("expected ") + kText + ", got a length of " + describe(size));
    return {};
  }
  return std::fabs(size - 1) <= kUnit ? out : normalize(out);
}

}  // namespace rubble::io
