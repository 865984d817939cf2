#include "cook/body_fields.h"
#include "cook/shape_traits.h"
#include "io/field_json.h"
#include "io/shape_json.h"

namespace rubble::io {

namespace {

using Ordered = nlohmann::ordered_json;

Ordered pointsJson(const std::vector<Vec3>& points) {
  Ordered list = Ordered::array();
  for (const Vec3& p : points) list.push_back(vectorJson(p));
  return list;
}

}  // namespace

nlohmann::ordered_json materialJson(const Material& material) {
  Ordered json = Ordered::object();
  if (sameBits(material.staticFriction, material.dynamicFriction)) {
    json["friction"] = material.staticFriction;
  } else {
    forEachField(kFrictionFields, material,
                 [&](const FieldInfo& field, double value) { json[field.key] = value; });
  }
  writeFields(kRestitutionField, material, json);
  if (material.frictionCombine != Combine::Usual)
    json["friction_combine"] = combineNames()[static_cast<std::size_t>(material.frictionCombine)];
  if (material.restitutionCombine != Combine::Usual)
    json["restitution_combine"] = combineNames()[static_cast<std::size_t>(material.restitutionCombine)];
  writeFields(kSurfaceFields, material, json);
  if (!material.name.empty()) json["name"] = material.name;
  return json;
}

nlohmann::ordered_json materialPairJson(const MaterialPair& pair) {
  Ordered json{{"a", pair.a}, {"b", pair.b}};
  writeFields(kMaterialPairFields, pair, json);
  return json;
}

nlohmann::ordered_json shapeJson(const Shape& shape) {
  const ShapeGeometry none, &g = shape.geometry ? *shape.geometry : none;
  Ordered json = Ordered::object();
  const ShapeTraits& traits = traitsOf(shape.type);
  json["type"] = traits.name;
  switch (shape.type) {
    case ShapeType::Hull:
      json["points"] = pointsJson(g.points);
      break;
    case ShapeType::Compound:
      for (const ShapePartDef& part : g.parts) {
        Ordered entry = Ordered::object();
        entry["shape"] = shapeJson(part.shape);
        entry["position"] = vectorJson(part.position);
        entry["orientation"] = {part.orientation.s, part.orientation.v.x, part.orientation.v.y,
                                part.orientation.v.z};
        if (part.material) entry["material"] = materialJson(*part.material);
        if (!sameBits(part.density, 1)) entry["density"] = part.density;
        json["parts"].push_back(std::move(entry));
      }
      if (g.mass) {
        const Quat& q = g.mass->axes;
        json["mass_properties"] = {{"mass", g.mass->mass},
                                   {"inertia", vectorJson(g.mass->inertia)},
                                   {"center", vectorJson(g.mass->center)},
                                   {"axes", {q.s, q.v.x, q.v.y, q.v.z}}};
      }
      break;
    case ShapeType::Mesh:
      json["vertices"] = pointsJson(g.points);
      json["triangles"] = g.triangles;
      if (g.twoSided) json["two_sided"] = true;
      break;
    case ShapeType::HeightField:
      json["counts"] = {g.counts[0], g.counts[1]};
      json["spacing"] = {g.spacing.x, g.spacing.y};
      json["heights"] = g.samples;
      break;
    case ShapeType::DistanceField:
      json["counts"] = g.counts;
      json["origin"] = vectorJson(g.origin);
      json["spacing"] = g.spacing.x;
      json["distances"] = g.samples;
      break;
    default:
      break;
  }
  for (const ShapeField& field : traits.fields)
    field.visit(shape, [&]<class T>(const T& value) {
      if (field.rules.always || !sameBits(value, T{})) json[field.key] = fieldJson(field, value);
    });
  if (shape.userData != 0) json["user_data"] = shape.userData;
  return json;
}

}  // namespace rubble::io
