#include "tables/shape_edit.h"

#include <algorithm>

namespace rubble::RUBBLE_CORE {

ShapeData shapeData(const CookedData& shape) {
  return {Vec3(shape.half), static_cast<Real>(shape.radius), shape.kind, shape.data};
}

ShapePlace endOfShapes(const HostTables& tables) {
  return {tables.shapeVectors, tables.shapeIndices, tables.shapeParts};
}

void addShape(HostTables& tables, const CookedShape& shape, const std::vector<int>& partSurfaces,
              const ShapePlace& place) {
  SolverData& s = tables.view();
  const auto [vectors, indices, parts] = place;
  const auto endOf = [](int first, const auto& list) { return first + static_cast<int>(list.size()); };
  tables.shapeVectors = std::max(tables.shapeVectors, endOf(vectors, shape.vectors));
  tables.shapeIndices = std::max(tables.shapeIndices, endOf(indices, shape.indices));
  tables.shapeParts = std::max(tables.shapeParts, endOf(parts, shape.parts));
  tables.reserve(Per::ShapeVector, tables.shapeVectors);
  tables.reserve(Per::ShapeIndex, tables.shapeIndices);
  tables.reserve(Per::ShapePart, tables.shapeParts);
  int vector = vectors, index = indices, part = parts;
  for (const auto& v : shape.vectors)
    s.shapeVector[vector++] = {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2]),
                               static_cast<Real>(v[3])};
  for (const int value : shape.indices) s.shapeIndex[index++] = value;
  for (const int at : shape.vectorPlaces) s.shapeIndex[indices + at] += vectors;
  for (const int at : shape.indexPlaces) s.shapeIndex[indices + at] += indices;
  for (const int at : shape.partPlaces) s.shapeIndex[indices + at] += parts;
  for (std::size_t i = 0; i < shape.parts.size(); ++i) {
    const CookedPart& from = shape.parts[i];
    ShapePart& out = s.shapePart[part++];
    out.shape = shapeData(from.shape);
    if (out.shape.data >= 0) out.shape.data += indices;
    out.position = Vec3(from.position);
    out.rotation = normalize(Quat(from.rotation));
    out.radius = static_cast<Real>(from.radius);
    out.surface = partSurfaces[i];
  }
}

void findOneWay(SolverData& s) {
  s.oneWay = std::any_of(&s.surface[0], &s.surface[0] + s.surfaces, [](const SurfaceData& m) {
    return m.oneWay != Vec3{0, 0, 0};
  });
}

void setSurfaces(HostTables& tables, const SetSurfaces& edit) {
  tables.reserve(Per::Surface, static_cast<int>(edit.surfaces.size()));
  SolverData& s = tables.view();
  s.surfaces = static_cast<int>(edit.surfaces.size());
  for (std::size_t i = 0; i < edit.surfaces.size(); ++i) {
    const Material& m = edit.surfaces[i];
    SurfaceData& to = s.surface[i];
    to = {static_cast<Real>(m.staticFriction),
          static_cast<Real>(m.dynamicFriction),
          static_cast<Real>(m.restitution),
          0,
          0,
          static_cast<int>(m.restitutionCombine),
          static_cast<Real>(m.rollingFriction),
          static_cast<Real>(m.torsionalFriction),
          Vec3(m.surfaceVelocity),
          Vec3(m.oneWay)};
    to.frictionCombine = static_cast<std::uint32_t>(m.frictionCombine) & 0xffu;
    to.kind = static_cast<std::uint32_t>(materialKind(edit.surfaces, m.name)) & 0xffffffu;
  }
  findOneWay(s);
  tables.reserve(Per::MaterialRule, static_cast<int>(edit.rules.size()));
  s.materialRules = static_cast<int>(edit.rules.size());
  bool roll = false, bounce = false;
  for (std::size_t k = 0; k < edit.rules.size(); ++k) {
    const EngineMaterialRule& r = edit.rules[k];
    const auto coefficient = [&](std::size_t i) { return static_cast<Real>(r.coefficients[i]); };
    s.materialRule[k] = {r.world,        r.low,          r.high,         r.given,       coefficient(0),
                         coefficient(1), coefficient(2), coefficient(3), coefficient(4)};
    roll |= r.coefficients[3] > 0 || r.coefficients[4] > 0, bounce |= r.coefficients[2] > 0;
  }
  tables.setRules(roll, bounce);
}

}  // namespace rubble::RUBBLE_CORE
