#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cook/checks.h"
#include "world/table_additions.h"

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

template <class Id> std::string describe(Id id) {
  return "id " + std::to_string(id.index) + " of generation " + std::to_string(id.generation) +
         ", which is not alive";
}

/// A body for the engine. `indexBase`, `surface`: its entries in the tables of shapes and materials.
EngineBody engineBody(const BodyDef& def, const ReadyBody& ready, int indexBase, int surface) {
  const CookedShape& cooked = *ready.cooked;
  EngineBody body;
  body.kind = kindOf(def.motion);
  body.shape = cooked.shape;
  if (body.shape.data >= 0) body.shape.data += indexBase;
  body.radius = cooked.radius;
  body.material = def.material;
  body.surface = surface;
  body.mass = ready.mass;
  body.gravityScale = def.gravityScale;
  body.linearDamping = def.linearDamping, body.angularDamping = def.angularDamping;
  for (std::size_t k = 0; k < 3; ++k)
    body.locks |= (def.lockTranslation[k] ? 1 : 0) << k | (def.lockRotation[k] ? 8 : 0) << k;
  body.filter = def.filter;
  body.sensor = def.sensor;
  body.state = ShapeFrame{cooked.unit.center, cooked.unit.axes}.toEngine(
      {def.position, normalize(def.orientation), def.velocity, def.angularVelocity});
  return body;
}

bool hasPlane(const BodyDef& def) { return def.shape.type == ShapeType::Plane; }

}  // namespace

void World::Impl::requireAlive(BodyId id) const {
  if (!registry.bodies.alive(id)) throw Error("body", "an id that is alive", describe(id));
}
void World::Impl::requireAlive(JointId id) const {
  if (!registry.joints.alive(id)) throw Error("joint", "an id that is alive", describe(id));
}

ReadyBody World::Impl::ready(const BodyDef& def, const Path& path, std::vector<CookedEntry>& fresh) const {
  if (!def.name.empty() && registry.bodyNames.contains(def.name))
    throw Error(path + ".name", kOwnName, "\"" + def.name + "\"");
  const std::shared_ptr<const CookedShape> cooked = cookShape(def.shape, path + ".shape", fresh);
  return {cooked, massOfDefinition(def, cooked->unit, path)};
}

std::vector<BodyId> World::Impl::addBodies(std::span<const BodyDef> bodies,
                                           std::span<const ReadyBody> ready) {
  TableAdditions tables(registry);
  std::vector<std::pair<int, int>> entries;  // base of the shape, surface
  entries.reserve(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const int base = tables.placeShape(bodies[k].shape, ready[k].cooked);
    entries.emplace_back(base, tables.surfaceOf(bodies[k].material, ready[k].cooked->unit.axes));
  }
  std::vector<Edit> edits = tables.edits();
  std::vector<BodyId> ids;
  std::vector<BodyRecord> records;
  std::vector<int> planes = registry.planes;
  edits.reserve(edits.size() + bodies.size()), ids.reserve(bodies.size()), records.reserve(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodyId id = registry.bodies.next(static_cast<int>(k));
    const CookedShape& cooked = *ready[k].cooked;
    if (id.generation > 0) edits.push_back(ForgetContacts{{id.index}});
    edits.push_back(SetBody{id.index, engineBody(bodies[k], ready[k], entries[k].first, entries[k].second)});
    if (bodies[k].shape.type == ShapeType::Plane) planes.push_back(id.index);
    ids.push_back(id);
    records.push_back({bodies[k], ready[k].mass, {cooked.unit.center, cooked.unit.axes}, cooked.radius});
  }
  if (planes.size() > registry.planes.size()) {
    std::sort(planes.begin(), planes.end());
    edits.push_back(SetPlanes{planes});
  }
  tables.prepare(registry);
  registry.bodies.prepare(static_cast<int>(bodies.size()));
  std::size_t named = 0;
  Undo unname([&] {
    for (std::size_t k = 0; k < named; ++k) registry.bodyNames.erase(bodies[k].name);
  });
  for (; named < bodies.size(); ++named)
    if (!bodies[named].name.empty()) registry.bodyNames.emplace(bodies[named].name, ids[named]);
  engine->apply(edits);

  unname.keep();
  tables.commit(registry);
  for (BodyRecord& record : records) registry.bodies.add(std::move(record));
  registry.planes = std::move(planes);
  epoch += static_cast<std::int64_t>(bodies.size());
  return ids;
}

void World::Impl::redefine(BodyId id, BodyDef def) {
  requireAlive(id);
  const BodyRecord before = registry.bodies[id];
  if (def.name != before.def.name)
    throw Error("body.name", "that of the body, \"" + before.def.name + "\"", "\"" + def.name + "\"");
  validate(def, "body");
  const bool reshaped = !sameShape(def.shape, before.def.shape);
  if (!reshaped) def.shape = before.def.shape;  // not an equal copy
  std::vector<CookedEntry> fresh;
  const std::shared_ptr<const CookedShape> cooked = cookShape(def.shape, "body.shape", fresh);
  const ReadyBody ready{cooked, massOfDefinition(def, cooked->unit, "body")};
  BodyRecord after{def, ready.mass, {cooked->unit.center, cooked->unit.axes}, cooked->radius, before.joints};
  const bool wasPlane = hasPlane(before.def),
             framed = after.frame.center != before.frame.center || after.frame.axes != before.frame.axes,
             stops = def.motion == Motion::Static && before.def.motion != Motion::Static;

  TableAdditions tables(registry);
  const int base = tables.placeShape(def.shape, cooked),
            surface = tables.surfaceOf(def.material, cooked->unit.axes);
  std::vector<Edit> edits = tables.edits();
  addWake(edits, id);
  edits.push_back(SetBody{id.index, engineBody(def, ready, base, surface), true});
  if (framed || stops) {
    BodyState state = bodyState(id);
    const Vec3 center = state.position;
    state = after.frame.toEngine(before.frame.toAuthor(state));
    state.velocity += cross(state.angularVelocity, state.position - center);
    if (stops) state.velocity = state.angularVelocity = {};
    edits.push_back(SetBodyState{id.index, state});
  }
  if (reshaped || (params.sleeping && def.motion != Motion::Dynamic))
    edits.push_back(ForgetContacts{{id.index}});
  std::vector<int> planes = registry.planes;
  if (wasPlane != hasPlane(def)) {
    if (wasPlane)
      std::erase(planes, id.index);
    else
      planes.insert(std::ranges::lower_bound(planes, id.index), id.index);
    edits.push_back(SetPlanes{planes});
  }
  tables.prepare(registry);
  registry.bodies.prepare(0), registry.joints.prepare(0);
  // joints see the new frame and mass of the body
  BodyRecord& record = registry.bodies.edit(id);
  std::swap(record, after);
  Undo undo([&] { std::swap(record, after); });
  std::vector<std::pair<JointId, EngineJoint>> joints;
  for (const JointId joint : record.joints) {
    joints.emplace_back(joint, changedJoint(registry.joints[joint], registry.joints[joint].def));
    edits.push_back(SetJoint{registry.joints[joint].engineSlot, joints.back().second, true});
  }
  engine->apply(edits);

  undo.keep();
  tables.commit(registry);
  registry.planes = std::move(planes);
  for (auto& [joint, changed] : joints) registry.joints.edit(joint).engine = std::move(changed);
  for (const AttachmentId a : registry.attachments.ids()) softChanged |= registry.attachments[a].body == id;
  pass(inputs::SetBodyDefinition{id, def});
}

void World::Impl::removeBodies(std::span<const BodyId> ids) {
  std::vector<int> slots;
  for (const BodyId id : ids) {
    requireAlive(id);
    slots.push_back(id.index);
  }
  if (slots.empty()) return;
  std::sort(slots.begin(), slots.end());
  if (std::adjacent_find(slots.begin(), slots.end()) != slots.end())
    throw Error("bodies", "each body once", "one of them twice");
  const auto goes = [&](int slot) { return std::ranges::binary_search(slots, slot); };

  std::vector<JointId> joints;
  for (const BodyId id : ids) {
    const std::vector<JointId>& own = registry.bodies[id].joints;
    joints.insert(joints.end(), own.begin(), own.end());
  }
  std::ranges::sort(joints, {}, &JointId::index);
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  std::vector<AttachmentId> attachments = registry.attachments.ids();
  std::erase_if(attachments, [&](AttachmentId id) { return !goes(registry.attachments[id].body.index); });

  std::vector<Edit> edits;
  for (const JointId id : joints) {
    const JointRecord& joint = registry.joints[id];
    addWakes(edits, joint);
    EngineJoint none;
    none.type = joint.engine.type;
    edits.push_back(SetJoint{joint.engineSlot, none});
    if (joint.def.collide) continue;
    const bool both = !goes(joint.a.index) && !goes(joint.b.index);
    addExclusion(edits, joint.a, joint.b, both && jointExcludes(joint.a, joint.b, joints));
  }
  for (const auto& [a, b] : registry.exclusions)
    if (goes(a) || goes(b)) edits.push_back(SetExcluded{a, b, false});
  for (const int slot : slots) edits.push_back(SetBody{slot, {}});
  std::vector<int> planes = registry.planes;
  if (std::erase_if(planes, goes) > 0) edits.push_back(SetPlanes{planes});
  edits.push_back(ForgetContacts{slots});
  prepareToDrop(joints);
  registry.bodies.prepare(static_cast<int>(ids.size()));
  registry.attachments.prepare(static_cast<int>(attachments.size()));
  engine->apply(edits);

  for (const JointId id : joints) dropJoint(id);
  for (const AttachmentId id : attachments) registry.attachments.remove(id);
  softChanged |= !attachments.empty();
  std::erase_if(registry.exclusions, [&](const auto& pair) { return goes(pair.first) || goes(pair.second); });
  for (const BodyId id : ids) {
    if (const std::string& name = registry.bodies[id].def.name; !name.empty()) registry.bodyNames.erase(name);
    registry.bodies.remove(id);
  }
  registry.planes = std::move(planes);
  ++epoch;
}

void World::Impl::configure(bool wakesAll) {
  EngineSettings settings;
  settings.params = params;
  settings.gravity = registry.gravity;
  settings.wakeAll = wakesAll;
  engine->configure(settings);
}

}  // namespace rubble
