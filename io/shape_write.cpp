#include <bit>
#include <cstdint>

#include "io/shape_json.h"

namespace rubble::io {

namespace {

using Ordered = nlohmann::ordered_json;

constexpr std::array<const char*, 6> kRules{"usual",    "average", "minimum",
                                            "multiply", "maximum", "geometric_mean"};

/// The same bits, so that -0 is not taken for 0.
bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

Ordered vectorJson(const Vec3& v) { return {v.x, v.y, v.z}; }

Ordered pointsJson(const std::vector<Vec3>& points) {
  Ordered list = Ordered::array();
  for (const Vec3& p : points) list.push_back(vectorJson(p));
  return list;
}

}  // namespace

std::vector<double> materialKey(const Material& m) {
  return {m.staticFriction,
          m.dynamicFriction,
          m.restitution,
          double(m.frictionCombine),
          double(m.restitutionCombine),
          m.rollingFriction,
          m.torsionalFriction,
          m.surfaceVelocity.x,
          m.surfaceVelocity.y,
          m.surfaceVelocity.z};
}

nlohmann::ordered_json materialJson(const Material& material) {
  Ordered json = Ordered::object();
  if (same(material.staticFriction, material.dynamicFriction)) {
    json["friction"] = material.staticFriction;
  } else {
    json["static_friction"] = material.staticFriction;
    json["dynamic_friction"] = material.dynamicFriction;
  }
  if (!same(material.restitution, 0)) json["restitution"] = material.restitution;
  if (material.frictionCombine != Combine::Usual)
    json["friction_combine"] = kRules[static_cast<std::size_t>(material.frictionCombine)];
  if (material.restitutionCombine != Combine::Usual)
    json["restitution_combine"] = kRules[static_cast<std::size_t>(material.restitutionCombine)];
  if (!same(material.rollingFriction, 0)) json["rolling_friction"] = material.rollingFriction;
  if (!same(material.torsionalFriction, 0)) json["torsional_friction"] = material.torsionalFriction;
  if (material.surfaceVelocity != Vec3{}) json["surface_velocity"] = vectorJson(material.surfaceVelocity);
  return json;
}

nlohmann::ordered_json shapeJson(const Shape& shape) {
  const ShapeGeometry none, &g = shape.geometry ? *shape.geometry : none;
  Ordered json = Ordered::object();
  const auto rounded = [&] {
    if (!same(shape.rounding, 0)) json["rounding"] = shape.rounding;
  };
  switch (shape.type) {
    case ShapeType::Box:
      json = {{"type", "box"}, {"size", vectorJson(shape.halfExtents * 2)}};
      rounded();
      break;
    case ShapeType::Sphere:
      json = {{"type", "sphere"}, {"radius", shape.radius}};
      break;
    case ShapeType::Capsule:
      json = {{"type", "capsule"}, {"radius", shape.radius}, {"length", 2 * shape.halfLength}};
      break;
    case ShapeType::Plane:
      json = Ordered::object({{"type", "plane"}});
      break;
    case ShapeType::Cylinder:
      json = {{"type", "cylinder"}, {"radius", shape.radius}, {"length", 2 * shape.halfLength}};
      rounded();
      break;
    case ShapeType::Cone:
      json = {{"type", "cone"}, {"radius", shape.radius}, {"length", 2 * shape.halfLength}};
      break;
    case ShapeType::Hull:
      json = {{"type", "hull"}, {"points", pointsJson(g.points)}};
      rounded();
      break;
    case ShapeType::Compound:
      json["type"] = "compound";
      for (const ShapePartDef& part : g.parts) {
        Ordered entry = Ordered::object();
        entry["shape"] = shapeJson(part.shape);
        entry["position"] = vectorJson(part.position);
        entry["orientation"] = {part.orientation.s, part.orientation.v.x, part.orientation.v.y,
                                part.orientation.v.z};
        if (part.material) entry["material"] = materialJson(*part.material);
        if (!same(part.density, 1)) entry["density"] = part.density;
        json["parts"].push_back(std::move(entry));
      }
      break;
    case ShapeType::Mesh:
      json = {{"type", "mesh"}, {"vertices", pointsJson(g.points)}, {"triangles", g.triangles}};
      if (g.twoSided) json["two_sided"] = true;
      break;
    case ShapeType::HeightField:
      json = {{"type", "height_field"},
              {"counts", {g.counts[0], g.counts[1]}},
              {"spacing", {g.spacing.x, g.spacing.y}},
              {"heights", g.samples}};
      break;
    case ShapeType::DistanceField:
      json = {{"type", "distance_field"},
              {"counts", g.counts},
              {"origin", vectorJson(g.origin)},
              {"spacing", g.spacing.x},
              {"distances", g.samples}};
      break;
  }
  return json;
}

}  // namespace rubble::io
