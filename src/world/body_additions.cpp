#include "world/body_additions.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "cook/checks.h"

namespace rubble {

namespace {

int kindOf(Motion motion) { return motion == Motion::Static ? 1 : motion == Motion::Kinematic ? 2 : 3; }

/// Converts moments about the body axes to moments about the principal axes of the shape, which the engine
/// uses. Throws Error unless the given tensor is diagonal there.
Vec3 inertiaAlong(const Vec3& moments, const Quat& axes, const Path& path) {
  Vec3 out;
  const std::array<Vec3, 3> local{rotate(axes, Vec3{1, 0, 0}), rotate(axes, Vec3{0, 1, 0}),
                                  rotate(axes, Vec3{0, 0, 1})};
  for (std::size_t i = 0; i < 3; ++i) {
    out[static_cast<int>(i)] = dot(local[i], mul(moments, local[i]));
    constexpr double kRoundOff = 1e-9;
    const double off = dot(local[i], mul(moments, local[(i + 1) % 3]));
    if (std::fabs(off) > kRoundOff * (moments.x + moments.y + moments.z))
      throw Error(
          path + ".inertia",
          "moments about axes that are principal ones of the shape (give its density or mass instead)",
          "a shape whose principal axes are others");
  }
  return out;
}

/// Throws Error unless single precision holds a mass or moment and its inverse.
void requireWeight(double weight, const Path& path, const char* what) {
  constexpr double kMost = 1e36, kLeast = 1 / kMost;
  if (!(weight >= kLeast && weight <= kMost))
    throw Error(path, what + (" from " + checks::text(kLeast)) + " to " + checks::text(kMost),
                checks::text(weight));
}

/// Mass properties of a body from those of its shape at density 1.
MassProperties massOfDefinition(const BodyDef& def, const MassProperties& unit, const Path& path) {
  if (def.motion != Motion::Dynamic) return {};
  const double density = def.mass ? *def.mass / unit.mass : def.density;
  const MassProperties mass{
      unit.mass * density, def.inertia ? inertiaAlong(*def.inertia, unit.axes, path) : unit.inertia * density,
      unit.center, unit.axes};
  requireWeight(mass.mass, path + ".mass", "a shape and a density that give a mass [kg]");
  for (int axis = 0; axis < 3; ++axis)
    requireWeight(mass.inertia[axis], path + ".inertia",
                  "a shape and a density that give moments of inertia [kg m2]");
  return mass;
}

}  // namespace

BodyRecord recordOf(const BodyDef& def, const PlacedShape& shape, const Path& path) {
  const CookedShape& cooked = *shape.cooked;
  return {def,
          massOfDefinition(def, cooked.unit, path),
          {cooked.unit.center, cooked.unit.axes},
          cooked.radius,
          shape.id};
}

EngineBody engineBody(const BodyRecord& record, const CookedData& shape, int surface) {
  const BodyDef& def = record.def;
  EngineBody body;
  body.kind = kindOf(def.motion);
  body.shape = shape;
  body.radius = record.radius;
  body.staticFriction = def.material.staticFriction, body.dynamicFriction = def.material.dynamicFriction;
  body.restitution = def.material.restitution;
  body.surface = surface;
  body.mass = record.mass.mass, body.inertia = record.mass.inertia;
  body.gravityScale = def.gravityScale;
  body.linearDamping = def.linearDamping, body.angularDamping = def.angularDamping;
  for (std::size_t k = 0; k < 3; ++k)
    body.locks |= (def.lockTranslation[k] ? 1 : 0) << k | (def.lockRotation[k] ? 8 : 0) << k;
  body.filter = def.filter;
  body.sensor = def.sensor;
  body.state = record.frame.toEngine(
      {def.position, normalize(def.orientation), def.velocity, def.angularVelocity});
  return body;
}

BodyAdditions::BodyAdditions(Registry& registry, CookedShapes& cooked, std::size_t count)
    : registry_(registry), tables_(registry, cooked), planes_(registry.planes) {
  ids_.reserve(count), inTables_.reserve(count);
  registry_.bodies.prepare(static_cast<int>(count));
}

BodyAdditions::~BodyAdditions() {
  if (committed_) return;
  for (auto id = ids_.rbegin(); id != ids_.rend(); ++id) {
    if (const std::string& name = registry_.bodies[*id].def.name; !name.empty())
      registry_.bodyNames.erase(name);
    registry_.bodies.takeBack(*id);
  }
}

void BodyAdditions::add(const BodyDef& def, const Path& path) {
  if (!def.name.empty() && registry_.bodyNames.contains(def.name))
    throw Error(path + ".name", kOwnName, "\"" + def.name + "\"");
  const PlacedShape shape = tables_.place(def.shape, path + ".shape");
  BodyRecord record = recordOf(def, shape, path);
  inTables_.push_back({shape.data(), tables_.surfaceOf(def.material, record.frame.axes)});
  const BodyId id = registry_.bodies.next();
  if (def.shape.type == ShapeType::Plane) planes_.push_back(id.index);
  if (id.generation > 0) reused_.push_back(id.index);
  if (!def.name.empty()) registry_.bodyNames.emplace(def.name, id);
  ids_.push_back(registry_.bodies.add(std::move(record)));
}

std::vector<BodyId> BodyAdditions::commit(Engine& engine) {
  std::vector<Edit> edits = tables_.edits();
  std::ranges::sort(reused_), std::ranges::sort(planes_);
  if (!reused_.empty()) edits.push_back(ForgetContacts{reused_});
  edits.push_back(AddBodies{
      registry_.bodies.size(), static_cast<int>(ids_.size()), [this](int k) {
        const auto at = static_cast<std::size_t>(k);
        const InTables& placed = inTables_[at];
        return SetBody{ids_[at].index, engineBody(registry_.bodies[ids_[at]], placed.shape, placed.surface)};
      }});
  if (planes_.size() > registry_.planes.size()) edits.push_back(SetPlanes{planes_});
  tables_.prepare(registry_);
  engine.apply(edits);

  committed_ = true;
  tables_.commit(registry_);
  for (const BodyId id : ids_) registry_.shapes.use(registry_.bodies[id].shape, &ShapeRecord::bodies);
  registry_.planes = std::move(planes_);
  return std::move(ids_);
}

}  // namespace rubble
