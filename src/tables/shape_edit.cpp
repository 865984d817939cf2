#include "tables/shape_edit.h"

#include <algorithm>

namespace rubble::RUBBLE_CORE {

ShapeData shapeData(const CookedData& shape) {
  return {Vec3(shape.half), static_cast<Real>(shape.radius), shape.kind, shape.data};
}

void addShape(HostTables& tables, const CookedShape& shape, const std::vector<int>& partSurfaces) {
  SolverData& s = tables.view();
  const int vectors = tables.shapeVectors, indices = tables.shapeIndices, parts = tables.shapeParts;
  tables.reserve(Per::ShapeVector, vectors + static_cast<int>(shape.vectors.size()));
  tables.reserve(Per::ShapeIndex, indices + static_cast<int>(shape.indices.size()));
  tables.reserve(Per::ShapePart, parts + static_cast<int>(shape.parts.size()));
  for (const auto& v : shape.vectors)
    s.shapeVector[tables.shapeVectors++] = {static_cast<Real>(v[0]), static_cast<Real>(v[1]),
                                            static_cast<Real>(v[2]), static_cast<Real>(v[3])};
  for (const int index : shape.indices) s.shapeIndex[tables.shapeIndices++] = index;
  for (const int place : shape.vectorPlaces) s.shapeIndex[indices + place] += vectors;
  for (const int place : shape.indexPlaces) s.shapeIndex[indices + place] += indices;
  for (const int place : shape.partPlaces) s.shapeIndex[indices + place] += parts;
  for (std::size_t i = 0; i < shape.parts.size(); ++i) {
    const CookedPart& part = shape.parts[i];
    ShapePart& out = s.shapePart[tables.shapeParts++];
    out.shape = shapeData(part.shape);
    if (out.shape.data >= 0) out.shape.data += indices;
    out.position = Vec3(part.position);
    out.rotation = normalize(Quat(part.rotation));
    out.radius = static_cast<Real>(part.radius);
    out.surface = partSurfaces[i];
  }
}

void setSurfaces(HostTables& tables, const std::vector<Material>& surfaces) {
  tables.reserve(Per::Surface, static_cast<int>(surfaces.size()));
  SolverData& s = tables.view();
  s.surfaces = static_cast<int>(surfaces.size());
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Material& m = surfaces[i];
    s.surface[i] = {static_cast<Real>(m.staticFriction),    static_cast<Real>(m.dynamicFriction),
                    static_cast<Real>(m.restitution),       static_cast<int>(m.frictionCombine),
                    static_cast<int>(m.restitutionCombine), static_cast<Real>(m.rollingFriction),
                    static_cast<Real>(m.torsionalFriction), Vec3(m.surfaceVelocity)};
  }
}

}  // namespace rubble::RUBBLE_CORE
