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

const ShapePartDef* partOf(const Shape& shape, int part) {
  const bool hasParts = shape.type == ShapeType::Compound;
  const int count = hasParts ? static_cast<int>(shape.geometry->parts.size()) : 1;
  if (part < 0 || part >= count)
    throw Error("part", "an index below " + std::to_string(count), std::to_string(part));
  return hasParts ? &shape.geometry->parts[static_cast<std::size_t>(part)] : nullptr;
}
std::uint64_t partUserData(const Shape& shape, int part) {
  const ShapePartDef* const found = partOf(shape, part);
  return found ? found->shape.userData : shape.userData;
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
  // bodies in sequence often have one shape
  if (last_ && WorldShapes::identical(shape, *last_)) return lastPlaced_;
  const std::optional<ShapeId> old = registry_.shapes.find(shape);
  const ShapeId fresh = old ? ShapeId{} : addShape(shape, path);
  const ShapeRecord& record = old ? registry_.shapes[*old] : shapes_[fresh];
  if (!record.cooked) plain_ = cook(shape, path);
  last_ = shape;
  return lastPlaced_ = {record.cooked ? record.cooked.get() : &plain_,
                        old ? *old : registry_.shapes.next(fresh.index), record.place.indices};
}

ShapeId TableAdditions::addShape(const Shape& shape, const Path& path) {
  if (const std::optional<ShapeId> found = shapes_.find(shape)) return *found;
  ShapeRecord record{shape};
  if (shape.geometry) {
    record.cooked = cooked_.get(shape, path);
    if (!space_) space_ = registry_.shapes.space();
    record.place = space_->take(*record.cooked);
    addShapes_.push_back({record.cooked, {}, record.place});
    for (const CookedPart& part : record.cooked->parts) {
      int surface = part.material ? surfaceOf(*part.material, record.cooked->unit.axes) : -1;
      // a material that overrides that of the body is always in the table
      if (part.material && surface < 0) surface = addSurface(*part.material);
      addShapes_.back().partSurfaces.push_back(surface);
    }
  }
  shapes_.prepare(1, 0);
  return shapes_.add(std::move(record));
}

std::vector<Edit> TableAdditions::edits() const {
  std::vector<Edit> out;
  // parts of shapes name materials
  if (!surfaces_.empty()) out.push_back(surfacesEdit(surfaces(), registry_.materialPairs));
  out.insert(out.end(), addShapes_.begin(), addShapes_.end());
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

void TableAdditions::prepare(Registry& registry, int dropped) {
  reserveMore(registry.surfaces, static_cast<int>(surfaces_.size()));
  registry.shapes.prepare(shapes_.count(), dropped);
  if (space_) space_->prepare(dropped);
}

void TableAdditions::commit(Registry& registry) noexcept {
  registry.surfaces.insert(registry.surfaces.end(), surfaces_.begin(), surfaces_.end());
  for (int k = 0; k < shapes_.count(); ++k) registry.shapes.add(shapes_[ShapeId{k, 0}]);
  if (space_) registry.shapes.setSpace(std::move(*space_));
}

ShapeId World::addShape(const Shape& shape) {
  return withMemory("addShape", [&] {
    validate(shape, "shape");
    TableAdditions tables(impl_->registry, *impl_->cooked);
    const ShapeId id = tables.place(shape, "shape").id;
    const std::vector<Edit> edits = tables.edits();
    tables.prepare(impl_->registry);
    impl_->engine->apply(edits);
    tables.commit(impl_->registry);
    impl_->registry.shapes.use(id, &ShapeRecord::held);
    return id;
  });
}
void World::removeShape(ShapeId id) {
  withMemory("removeShape", [&] {
    impl_->requireAlive(id);
    WorldShapes& shapes = impl_->registry.shapes;
    if (shapes[id].held == 0) throw Error("shape", "one that addShape() has added", "one of bodies alone");
    std::vector<Edit> edits;
    impl_->addDrop(edits, id, 1);
    shapes.prepare(0, 1);
    impl_->engine->apply(edits);
    shapes.drop(id, &ShapeRecord::held);
  });
}
bool World::alive(ShapeId id) const { return impl_->registry.shapes.alive(id); }
std::vector<ShapeId> World::shapes() const {
  return withMemory("shapes", [&] { return impl_->registry.shapes.ids(); });
}
ShapeId World::shapeOf(BodyId id) const {
  impl_->requireAlive(id);
  return impl_->registry.bodies[id].shape;
}
const Shape& World::definition(ShapeId id) const {
  impl_->requireAlive(id);
  return impl_->registry.shapes[id].shape;
}
int World::useCount(ShapeId id) const {
  impl_->requireAlive(id);
  return impl_->registry.shapes[id].bodies + impl_->registry.shapes[id].held;
}

}  // namespace rubble
