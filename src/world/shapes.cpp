#include <algorithm>
#include <cmath>

#include "cook/cook.h"
#include "world/table_additions.h"

namespace rubble {

namespace {

/// Has a material no name, default combine rules, no rolling or torsional friction, no surface velocity, and
/// does it hold from all sides?
bool isPlain(const Material& m) {
  return m.frictionCombine == Combine::Usual && m.restitutionCombine == Combine::Usual &&
         m.rollingFriction == 0 && m.torsionalFriction == 0 && m.surfaceVelocity == Vec3{} &&
         m.oneWay == Vec3{} && m.name.empty();
}

/// The material with its vectors in the engine frame of a shape. `oneWay` has length 1, or 0.
Material inEngineFrame(Material m, const Quat& axes) {
  // scaled first, as squares of tiny components vanish
  if (const double most = std::max({std::fabs(m.oneWay.x), std::fabs(m.oneWay.y), std::fabs(m.oneWay.z)});
      most > 0)
    m.oneWay = normalize(Vec3{m.oneWay.x / most, m.oneWay.y / most, m.oneWay.z / most});
  if (axes == Quat{}) return m;
  m.surfaceVelocity = rotateInverse(axes, m.surfaceVelocity), m.oneWay = rotateInverse(axes, m.oneWay);
  return m;
}

}  // namespace

bool sameShape(const Shape& a, const Shape& b) {
  if (a.type != b.type || a.halfExtents != b.halfExtents || a.radius != b.radius ||
      a.halfLength != b.halfLength || a.rounding != b.rounding)
    return false;
  if (a.geometry == b.geometry) return true;
  if (!a.geometry || !b.geometry) return false;
  const ShapeGeometry &g = *a.geometry, &h = *b.geometry;
  const auto samePart = [](const ShapePartDef& p, const ShapePartDef& q) {
    return sameShape(p.shape, q.shape) && p.position == q.position && p.orientation == q.orientation &&
           p.density == q.density && p.material == q.material;
  };
  const auto sameMass = [](const MassProperties& m, const MassProperties& n) {
    return m.mass == n.mass && m.inertia == n.inertia && m.center == n.center && m.axes == n.axes;
  };
  return g.points == h.points && g.triangles == h.triangles && g.twoSided == h.twoSided &&
         g.counts == h.counts && g.origin == h.origin && g.spacing == h.spacing && g.samples == h.samples &&
         g.mass.has_value() == h.mass.has_value() && (!g.mass || sameMass(*g.mass, *h.mass)) &&
         std::ranges::equal(g.parts, h.parts, samePart);
}

int TableAdditions::addSurface(const Material& material) {
  surfaces_.push_back(material);
  return static_cast<int>(registry_.surfaces.size() + surfaces_.size()) - 1;
}

int TableAdditions::surfaceOf(const Material& authored, const Quat& axes) {
  if (isPlain(authored)) return -1;
  const Material material = inEngineFrame(authored, axes);
  int first = 0;
  for (const std::vector<Material>* list : {&registry_.surfaces, &std::as_const(surfaces_)}) {
    const auto found = std::ranges::find(*list, material);
    if (found != list->end()) return first + static_cast<int>(found - list->begin());
    first += static_cast<int>(list->size());
  }
  return addSurface(material);
}

PlacedShape TableAdditions::place(const Shape& shape, const Path& path) {
  if (!shape.geometry) {
    // bodies in sequence often have one shape
    if (!plain_ || !sameShape(shape, *plain_)) plainCooked_ = cook(shape, path), plain_ = shape;
    return {plainCooked_, 0};
  }
  for (const CookedShapes* const list : {&registry_.shapes, &std::as_const(shapes_)})
    if (const CookedEntry* entry = list->find(shape)) return {*entry->cooked, entry->indexBase};
  const CookedEntry* const other = cooked_ ? cooked_->find(shape) : nullptr;
  CookedEntry entry{shape, other ? other->cooked : std::make_shared<const CookedShape>(cook(shape, path)), 0};
  if (cooked_ && !other) cooked_->add(entry);
  std::vector<int>& surfaces = partSurfaces_.emplace_back();
  for (const CookedPart& part : entry.cooked->parts) {
    int surface = part.material ? surfaceOf(*part.material, entry.cooked->unit.axes) : -1;
    // a material that overrides that of the body is always in the table
    if (part.material && surface < 0) surface = addSurface(*part.material);
    surfaces.push_back(surface);
  }
  entry.indexBase = registry_.shapeIndices + indices_;
  indices_ += static_cast<int>(entry.cooked->indices.size());
  shapes_.add(entry);
  return {*entry.cooked, entry.indexBase};
}

std::vector<Edit> TableAdditions::edits() const {
  std::vector<Edit> out;
  for (std::size_t k = 0; k < partSurfaces_.size(); ++k)
    out.push_back(AddShape{shapes_.entries()[k].cooked, partSurfaces_[k]});
  if (!surfaces_.empty()) out.push_back(surfacesEdit(surfaces(), registry_.materialPairs));
  return out;
}

std::vector<Material> TableAdditions::surfaces() const {
  std::vector<Material> all = registry_.surfaces;
  all.insert(all.end(), surfaces_.begin(), surfaces_.end());
  return all;
}

void sortRules(std::vector<EngineMaterialRule>& rules) {
  std::ranges::sort(rules, {}, [](const EngineMaterialRule& r) {
    return std::array{r.world, r.low, r.high};
  });
}

SetSurfaces surfacesEdit(std::vector<Material> surfaces, std::span<const MaterialPair> pairs) {
  SetSurfaces edit{std::move(surfaces)};
  for (const MaterialPair& pair : pairs) {
    const int a = materialKind(edit.surfaces, pair.a), b = materialKind(edit.surfaces, pair.b);
    if (a == 0 || b == 0) continue;
    EngineMaterialRule& rule = edit.rules.emplace_back();
    rule.low = std::min(a, b), rule.high = std::max(a, b);
    const std::optional<double> given[] = {pair.staticFriction, pair.dynamicFriction, pair.restitution,
                                           pair.rollingFriction, pair.torsionalFriction};
    for (std::size_t i = 0; i < std::size(given); ++i)
      if (given[i]) rule.given |= 1 << i, rule.coefficients[i] = *given[i];
  }
  sortRules(edit.rules);
  return edit;
}

void TableAdditions::prepare(Registry& registry) const {
  reserveMore(registry.surfaces, static_cast<int>(surfaces_.size()));
  registry.shapes.prepare(shapes_);
}

void TableAdditions::commit(Registry& registry) noexcept {
  registry.surfaces.insert(registry.surfaces.end(), surfaces_.begin(), surfaces_.end());
  registry.shapes.take(std::move(shapes_));
  registry.shapeIndices += indices_;
}

}  // namespace rubble
