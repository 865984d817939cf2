#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cook/checks.h"
#include "world/body_additions.h"

namespace rubble {

namespace {

template <class Objects, class Id> void requireAliveIn(const Objects& objects, Id id, const char* kind) {
  if (objects.alive(id)) return;
  throw Error(kind, "an id that is alive",
              "id " + std::to_string(id.index) + " of generation " + std::to_string(id.generation) +
                  ", which is not alive");
}

bool hasPlane(const BodyDef& def) { return def.shape.type == ShapeType::Plane; }

}  // namespace

void World::Impl::requireAlive(BodyId id) const { requireAliveIn(registry.bodies, id, "body"); }
void World::Impl::requireAlive(JointId id) const { requireAliveIn(registry.joints, id, "joint"); }
void World::Impl::requireAlive(ShapeId id) const { requireAliveIn(registry.shapes, id, "shape"); }
void World::Impl::requireAlive(DeformableId id) const { requireAliveIn(registry.softs, id, "deformable"); }
void World::Impl::requireAlive(AttachmentId id) const {
  requireAliveIn(registry.attachments, id, "attachment");
}

void World::Impl::addDrop(std::vector<Edit>& edits, ShapeId id, int uses) const {
  if (const ShapeRecord& record = registry.shapes[id]; record.cooked && registry.shapes.ends(id, uses))
    edits.push_back(DropShape{record.place});
}

BodyChange World::Impl::redefined(BodyId id, BodyDef def) {
  requireAlive(id);
  registry.bodies.prepare(0);
  BodyRecord& before = registry.bodies.edit(id);
  if (def.name != before.def.name)
    throw Error("body.name", "that of the body, \"" + before.def.name + "\"", "\"" + def.name + "\"");
  validate(def, "body");
  const bool reshaped = !sameShape(def.shape, before.def.shape);
  if (!reshaped) def.shape.geometry = before.def.shape.geometry;  // not an equal copy
  TableAdditions tables(registry, *cooked);
  const PlacedShape shape = tables.place(def.shape, "body.shape");
  BodyRecord after = recordOf(def, shape, "body");
  after.joints = before.joints;
  const bool wasPlane = hasPlane(before.def),
             framed = after.frame.center != before.frame.center || after.frame.axes != before.frame.axes,
             stops = def.motion == Motion::Static && before.def.motion != Motion::Static;

  const int surface = tables.surfaceOf(def.material, after.frame.axes);
  std::vector<Edit> edits = tables.edits();
  addWake(edits, id);
  edits.push_back(SetBody{id.index, engineBody(after, shape.data(), surface), true});
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
  const bool swaps = before.shape != shape.id;
  if (swaps) addDrop(edits, before.shape, 1);
  std::vector<std::pair<JointId, EngineJoint>> joints;
  {
    // joints see the new frame and mass of the body
    std::swap(before, after);
    const Undo undo([&] { std::swap(before, after); });
    for (const JointId joint : before.joints) {
      joints.emplace_back(joint, changedJoint(registry.joints[joint], registry.joints[joint].def));
      edits.push_back(SetJoint{registry.joints[joint].engineSlot, joints.back().second, true});
    }
  }
  return {id,   std::move(tables), std::move(after), std::move(edits), std::move(planes), std::move(joints),
          swaps};
}

void World::Impl::apply(BodyChange&& change) {
  change.tables.prepare(registry, 1);
  registry.bodies.prepare(0), registry.joints.prepare(0);
  engine->apply(change.edits);

  BodyRecord& record = registry.bodies.edit(change.id);
  const ShapeId before = record.shape;
  record = std::move(change.after);
  change.tables.commit(registry);
  if (change.swaps) {
    registry.shapes.use(record.shape, &ShapeRecord::bodies);
    registry.shapes.drop(before, &ShapeRecord::bodies);
  }
  registry.planes = std::move(change.planes);
  for (auto& [joint, changed] : change.joints) registry.joints.edit(joint).engine = std::move(changed);
  for (const AttachmentId a : registry.attachments.ids())
    softChanged |= registry.attachments[a].body == change.id;
  pass(inputs::SetBodyDefinition{change.id, record.def});
}

void World::Impl::redefine(BodyId id, BodyDef def) { apply(redefined(id, std::move(def))); }

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
  std::vector<ShapeId> shapes;
  for (const BodyId id : ids) shapes.push_back(registry.bodies[id].shape);
  std::ranges::sort(shapes, {}, &ShapeId::index);
  for (auto of = shapes.begin(); of != shapes.end();) {
    const auto next = std::find_if(of, shapes.end(), [&](ShapeId id) { return id != *of; });
    addDrop(edits, *of, static_cast<int>(next - of));
    of = next;
  }
  std::vector<int> planes = registry.planes;
  if (std::erase_if(planes, goes) > 0) edits.push_back(SetPlanes{planes});
  edits.push_back(ForgetContacts{slots});
  prepareToDrop(joints);
  registry.bodies.prepare(static_cast<int>(ids.size()));
  registry.attachments.prepare(static_cast<int>(attachments.size()));
  registry.shapes.prepare(0, static_cast<int>(ids.size()));
  engine->apply(edits);

  for (const JointId id : joints) dropJoint(id);
  for (const AttachmentId id : attachments) registry.attachments.remove(id);
  softChanged |= !attachments.empty();
  std::erase_if(registry.exclusions, [&](const auto& pair) { return goes(pair.first) || goes(pair.second); });
  for (const BodyId id : ids) {
    if (const std::string& name = registry.bodies[id].def.name; !name.empty()) registry.bodyNames.erase(name);
    registry.shapes.drop(registry.bodies[id].shape, &ShapeRecord::bodies);
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
