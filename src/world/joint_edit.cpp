/// Joints and exclusions of a world.
#include <algorithm>

#include "world/world_impl.h"

namespace rubble {

namespace {

bool contains(std::span<const JointId> ids, JointId id) {
  return std::ranges::binary_search(ids, id.index, {}, &JointId::index);
}

}  // namespace

JointId World::Impl::addJoint(const JointDef& def, BodyId a, BodyId b, BodyId frameBodyA, BodyId frameBodyB) {
  for (const BodyId id : {a, b, frameBodyA, frameBodyB}) requireAliveIfAny(id);
  if (a == b) throw Error("joint", "two different bodies", "the same one twice");
  checkFrameBody(def.type, a.index, frameBodyA.index, "joint.frameBodyA");
  checkFrameBody(def.type, b.index, frameBodyB.index, "joint.frameBodyB");
  if (!def.name.empty() && registry.jointNames.contains(def.name))
    throw Error("joint.name", "a name that no other joint has", "\"" + def.name + "\"");
  JointRecord record{def, a, b, frameBodyA, frameBodyB, {}, 0};
  record.engine = engineJoint(inEngineFrames(def, a, b), jointBodies(record));
  record.engine.a = a.index, record.engine.b = b.index;
  record.engine.frameBodyA = frameBodyA.index, record.engine.frameBodyB = frameBodyB.index;
  const auto type = static_cast<std::size_t>(record.engine.type);
  std::vector<int>& free = registry.freeJointSlots[type];
  const bool reuses = !free.empty();
  record.engineSlot = reuses ? free.back() : registry.jointSlots[type];
  std::vector<Edit> edits;
  addWakes(edits, record);
  edits.push_back(SetJoint{record.engineSlot, record.engine});
  if (!def.collide) addExclusion(edits, a, b, true);
  const JointId id = registry.joints.next();
  registry.joints.prepare();
  registry.bodies.prepare(0);
  for (const BodyId body : {a, b, frameBodyA, frameBodyB})
    if (body.index >= 0) reserveMore(registry.bodies.edit(body).joints);
  if (!def.name.empty()) registry.jointNames.emplace(def.name, id);
  Undo unname([&] {
    if (!def.name.empty()) registry.jointNames.erase(def.name);
  });
  engine->apply(edits);

  unname.keep();
  if (reuses)
    free.pop_back();
  else
    ++registry.jointSlots[type];
  registry.joints.add(std::move(record));
  jointRowsChanged = true;
  listJoint(id, registry.joints[id], true);
  return id;
}

void World::Impl::removeJoint(JointId id) {
  requireAlive(id);
  const JointRecord& joint = registry.joints[id];
  std::vector<Edit> edits;
  addWakes(edits, joint);
  EngineJoint none;
  none.type = joint.engine.type;
  edits.push_back(SetJoint{joint.engineSlot, none});
  const std::span<const JointId> own(&id, 1);
  if (!joint.def.collide)
    addExclusion(edits, joint.a, joint.b,
                 joint.a.index >= 0 && joint.b.index >= 0 && jointExcludes(joint.a, joint.b, own));
  prepareToDrop(own);
  engine->apply(edits);
  dropJoint(id);
}

void World::Impl::prepareToDrop(std::span<const JointId> ids) {
  for (const JointId id : ids)
    reserveMore(registry.freeJointSlots[static_cast<std::size_t>(registry.joints[id].engine.type)],
                static_cast<int>(ids.size()));
  registry.joints.prepare(static_cast<int>(ids.size()));
  registry.bodies.prepare(0);
}

void World::Impl::dropJoint(JointId id) {
  const JointRecord& joint = registry.joints[id];
  registry.freeJointSlots[static_cast<std::size_t>(joint.engine.type)].push_back(joint.engineSlot);
  if (!joint.def.name.empty()) registry.jointNames.erase(joint.def.name);
  listJoint(id, joint, false);
  registry.joints.remove(id);
  jointRowsChanged = true;
}

void World::Impl::listJoint(JointId id, const JointRecord& joint, bool listed) {
  for (const BodyId body : {joint.a, joint.b, joint.frameBodyA, joint.frameBodyB}) {
    if (body.index < 0) continue;
    std::vector<JointId>& joints = registry.bodies.edit(body).joints;
    const auto found = std::find(joints.begin(), joints.end(), id);
    if (listed && found == joints.end()) joints.push_back(id);
    if (!listed && found != joints.end()) joints.erase(found);
  }
}

void World::Impl::exclude(BodyId a, BodyId b, bool excluded) {
  requireAlive(a), requireAlive(b);
  if (a == b) throw Error("exclusion", "two different bodies", "the same one twice");
  const std::pair<int, int> pair = std::minmax(a.index, b.index);
  const bool added = excluded && registry.exclusions.insert(pair).second;
  Undo remove([&] {
    if (added) registry.exclusions.erase(pair);
  });
  engine->apply(SetExcluded{a.index, b.index, excluded || jointExcludes(a, b)});
  remove.keep();
  if (!excluded) registry.exclusions.erase(pair);
}

bool World::Impl::jointExcludes(BodyId a, BodyId b, std::span<const JointId> without) const {
  return std::ranges::any_of(registry.bodies[a].joints, [&](JointId id) {
    const JointRecord& joint = registry.joints[id];
    const bool links = (joint.a == a && joint.b == b) || (joint.a == b && joint.b == a);
    return links && !joint.def.collide && !joint.broken && !contains(without, id);
  });
}

void World::Impl::addExclusion(std::vector<Edit>& edits, BodyId a, BodyId b, bool byJoint) const {
  if (a.index < 0 || b.index < 0) return;
  edits.push_back(
      SetExcluded{a.index, b.index, byJoint || registry.exclusions.contains(std::minmax(a.index, b.index))});
}

JointDef World::Impl::inEngineFrames(JointDef def, BodyId a, BodyId b) const {
  const auto frameOf = [&](BodyId body) {
    return body.index >= 0 ? registry.bodies[body].frame : ShapeFrame{};
  };
  const ShapeFrame frameA = frameOf(a), frameB = frameOf(b);
  if (frameA.same() && frameB.same()) return def;
  def.anchorA = frameA.pointToEngine(def.anchorA), def.anchorB = frameB.pointToEngine(def.anchorB);
  def.frameA = conjugate(frameA.axes) * def.frameA, def.frameB = conjugate(frameB.axes) * def.frameB;
  def.orientationAtoB = conjugate(frameB.axes) * def.orientationAtoB * frameA.axes;
  return def;
}

void World::Impl::addWakes(std::vector<Edit>& edits, const JointRecord& joint) {
  for (const BodyId id : {joint.a, joint.b, joint.frameBodyA, joint.frameBodyB}) addWake(edits, id);
}

JointBodies World::Impl::jointBodies(const JointRecord& joint) const {
  const auto of = [&](BodyId id) {
    if (id.index < 0) return JointBodyState{};
    const BodyState state = bodyState(id);
    const ShapeFrame& frame = registry.bodies[id].frame;
    return JointBodyState{state.position, state.orientation, registry.bodies[id].mass, frame.center,
                          frame.axes};
  };
  return {of(joint.a), of(joint.b), of(joint.frameBodyA), of(joint.frameBodyB)};
}

EngineJoint World::Impl::changedJoint(const JointRecord& record, const JointDef& def) const {
  EngineJoint joint = engineJoint(inEngineFrames(def, record.a, record.b), jointBodies(record),
                                  &record.engine);
  joint.a = record.engine.a, joint.b = record.engine.b;
  joint.frameBodyA = record.engine.frameBodyA, joint.frameBodyB = record.engine.frameBodyB;
  return joint;
}

EngineJoint World::Impl::redefined(JointId id, const JointDef& def) const {
  requireAlive(id);
  const JointRecord& record = registry.joints[id];
  if (def.type != record.def.type)
    throw Error("joint.type", "that of the joint, " + std::string(keyword(record.def.type)),
                keyword(def.type));
  if (def.name != record.def.name)
    throw Error("joint.name", "that of the joint, \"" + record.def.name + "\"", "\"" + def.name + "\"");
  validate(def, "joint");
  EngineJoint joint = changedJoint(record, def);
  if (joint.turned != record.engine.turned)
    throw Error("joint", "the same rotations locked as when it was made: they decide how turns are counted",
                "others");
  if (joint.type != record.engine.type)
    throw Error("joint", "friction or none, as when it was made: it decides what kind of joint it is",
                "the other");
  return joint;
}

void World::Impl::redefine(JointId id, const JointDef& def) { apply(id, def, redefined(id, def)); }

void World::Impl::apply(JointId id, JointDef def, EngineJoint joint) {
  const JointRecord& record = registry.joints[id];
  std::vector<Edit> edits;
  addWakes(edits, record);
  edits.push_back(SetJoint{record.engineSlot, joint, true});
  if (def.collide != record.def.collide && record.a.index >= 0 && record.b.index >= 0)
    addExclusion(edits, record.a, record.b,
                 (!def.collide && !record.broken) || jointExcludes(record.a, record.b, {&id, 1}));
  registry.joints.prepare(0);
  engine->apply(edits);
  JointRecord& changed = registry.joints.edit(id);
  changed.def = std::move(def);
  changed.engine = std::move(joint);
  pass(inputs::SetDefinition{id, changed.def});
}

void World::Impl::findUnlistedBreaks() {
  if (!registry.hasUnlistedBreaks) return;
  const std::vector<std::pair<int, int>> all = engine->read().brokenJoints();
  std::vector<JointId> found;
  for (const JointId id : registry.joints.ids()) {
    const JointRecord& joint = registry.joints[id];
    if (!joint.broken && std::binary_search(all.begin(), all.end(),
                                            std::pair{static_cast<int>(joint.engine.type), joint.engineSlot}))
      found.push_back(id);
  }
  std::vector<Edit> edits;
  for (const JointId id : found) {
    const JointRecord& joint = registry.joints[id];
    if (joint.def.collide || joint.a.index < 0 || joint.b.index < 0) continue;
    addExclusion(edits, joint.a, joint.b, jointExcludes(joint.a, joint.b, found));
  }
  registry.joints.prepare(0);
  reserveMore(broken, static_cast<int>(found.size()));
  engine->apply(edits);
  for (const JointId id : found) registry.joints.edit(id).broken = true;
  broken.insert(broken.end(), found.begin(), found.end());
  registry.hasUnlistedBreaks = false;
}

}  // namespace rubble
