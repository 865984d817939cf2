#include <algorithm>

#include "cook/cook.h"
#include "world/world_impl.h"

namespace rubble {

namespace {

/// One with the usual rules and nothing but two frictions and a restitution.
bool isPlain(const Material& m) {
  return m.frictionCombine == Combine::Usual && m.restitutionCombine == Combine::Usual && m.rollingFriction == 0 && m.torsionalFriction == 0 &&
         m.surfaceVelocity == Vec3{};
}

bool same(const Material& a, const Material& b) {
  return a.staticFriction == b.staticFriction && a.dynamicFriction == b.dynamicFriction && a.restitution == b.restitution &&
         a.frictionCombine == b.frictionCombine && a.restitutionCombine == b.restitutionCombine && a.rollingFriction == b.rollingFriction &&
         a.torsionalFriction == b.torsionalFriction && a.surfaceVelocity == b.surfaceVelocity;
}

}  // namespace

int World::Impl::surfaceOf(const Material& material) {
  if (isPlain(material)) return -1;
  std::vector<Material>& all = registry.surfaces;
  const auto found = std::find_if(all.begin(), all.end(), [&](const Material& m) { return same(m, material); });
  if (found != all.end()) return static_cast<int>(found - all.begin());
  all.push_back(material);
  engine->setSurfaces(all);
  return static_cast<int>(all.size()) - 1;
}

std::shared_ptr<const CookedShape> World::Impl::cookShape(const Shape& shape, const std::string& path, int& indexBase) {
  indexBase = 0;
  if (!shape.geometry) return std::make_shared<const CookedShape>(cook(shape, path));
  for (const CookedEntry& entry : registry.shapes) {
    if (entry.key.geometry != shape.geometry || entry.key.type != shape.type || entry.key.rounding != shape.rounding) continue;
    indexBase = entry.indexBase;
    return entry.cooked;
  }
  auto cooked = std::make_shared<const CookedShape>(cook(shape, path));
  std::vector<int> partSurfaces;
  for (const CookedPart& part : cooked->parts) {
    int surface = -1;
    if (part.material) {
      surface = surfaceOf(*part.material);
      // one that stands in for that of the body has to be in the table, plain or not
      if (surface < 0) {
        registry.surfaces.push_back(*part.material);
        engine->setSurfaces(registry.surfaces);
        surface = static_cast<int>(registry.surfaces.size()) - 1;
      }
    }
    partSurfaces.push_back(surface);
  }
  engine->addShape(*cooked, partSurfaces);
  indexBase = registry.shapeIndices;
  registry.shapeIndices += static_cast<int>(cooked->indices.size());
  registry.shapes.push_back({shape, cooked, indexBase});
  return cooked;
}

}  // namespace rubble
