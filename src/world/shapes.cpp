#include <algorithm>

#include "cook/cook.h"
#include "world/world_impl.h"

namespace rubble {

namespace {

/// Returns whether a material has default combine rules, no rolling or torsional friction and no surface
/// velocity.
bool isPlain(const Material& m) {
  return m.frictionCombine == Combine::Usual && m.restitutionCombine == Combine::Usual &&
         m.rollingFriction == 0 && m.torsionalFriction == 0 && m.surfaceVelocity == Vec3{};
}

}  // namespace

bool sameMaterial(const Material& a, const Material& b) {
  return a.staticFriction == b.staticFriction && a.dynamicFriction == b.dynamicFriction &&
         a.restitution == b.restitution && a.frictionCombine == b.frictionCombine &&
         a.restitutionCombine == b.restitutionCombine && a.rollingFriction == b.rollingFriction &&
         a.torsionalFriction == b.torsionalFriction && a.surfaceVelocity == b.surfaceVelocity;
}

int World::Impl::surfaceOf(const Material& material) {
  if (isPlain(material)) return -1;
  std::vector<Material>& all = registry.surfaces;
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const Material& m) { return sameMaterial(m, material); });
  if (found != all.end()) return static_cast<int>(found - all.begin());
  all.push_back(material);
  engine->apply(SetSurfaces{all});
  return static_cast<int>(all.size()) - 1;
}

const CookedEntry* findCooked(std::span<const CookedEntry> entries, const Shape& shape) {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const CookedEntry& e) {
    return e.key.geometry == shape.geometry && e.key.type == shape.type && e.key.rounding == shape.rounding;
  });
  return found == entries.end() ? nullptr : &*found;
}

std::shared_ptr<const CookedShape> World::Impl::cookShape(const Shape& shape, const Path& path,
                                                          std::vector<CookedEntry>& fresh) const {
  if (!shape.geometry) return std::make_shared<const CookedShape>(cook(shape, path));
  for (const std::span<const CookedEntry> entries :
       {std::span(registry.shapes), std::span<const CookedEntry>(fresh)})
    if (const CookedEntry* entry = findCooked(entries, shape)) return entry->cooked;
  if (cooked)
    if (const CookedEntry* entry = findCooked(*cooked, shape)) return entry->cooked;
  fresh.push_back({shape, std::make_shared<const CookedShape>(cook(shape, path)), 0});
  if (cooked) cooked->push_back(fresh.back());
  return fresh.back().cooked;
}

int World::Impl::placeShape(const Shape& shape, const std::shared_ptr<const CookedShape>& cooked) {
  if (!shape.geometry) return 0;
  if (const CookedEntry* entry = findCooked(registry.shapes, shape)) return entry->indexBase;
  std::vector<int> partSurfaces;
  for (const CookedPart& part : cooked->parts) {
    int surface = -1;
    if (part.material) {
      surface = surfaceOf(*part.material);
      // a material that overrides that of the body is always in the table
      if (surface < 0) {
        registry.surfaces.push_back(*part.material);
        engine->apply(SetSurfaces{registry.surfaces});
        surface = static_cast<int>(registry.surfaces.size()) - 1;
      }
    }
    partSurfaces.push_back(surface);
  }
  engine->apply(AddShape{cooked, partSurfaces});
  registry.shapes.push_back({shape, cooked, registry.shapeIndices});
  registry.shapeIndices += static_cast<int>(cooked->indices.size());
  return registry.shapes.back().indexBase;
}

}  // namespace rubble
