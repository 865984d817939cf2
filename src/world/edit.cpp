#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "world/world_impl.h"

namespace rubble {

namespace {

int kindOf(Motion motion) { return motion == Motion::Static ? 1 : motion == Motion::Kinematic ? 2 : 3; }

/// Converts moments about the body axes to moments about the principal axes of the shape, which the engine
/// uses. Throws Error unless the given tensor is diagonal there.
Vec3 inertiaAlong(const Vec3& moments, const Quat& axes, const std::string& path) {
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

/// Mass properties of a body from those of its shape at density 1.
MassProperties massOfDefinition(const BodyDef& def, const MassProperties& unit, const std::string& path) {
  if (def.motion != Motion::Dynamic) return {};
  const double density = def.mass ? *def.mass / unit.mass : def.density;
  return {unit.mass * density,
          def.inertia ? inertiaAlong(*def.inertia, unit.axes, path) : unit.inertia * density, unit.centre,
          unit.axes};
}

template <class Id> std::string describe(Id id) {
  return "id " + std::to_string(id.index) + " of generation " + std::to_string(id.generation) +
         ", which is not alive";
}

}  // namespace

void World::Impl::requireAlive(BodyId id) const {
  if (!registry.bodies.alive(id)) throw Error("body", "an id that is alive", describe(id));
}
void World::Impl::requireAlive(JointId id) const {
  if (!registry.joints.alive(id)) throw Error("joint", "an id that is alive", describe(id));
}

ReadyBody World::Impl::ready(const BodyDef& def, const std::string& path,
                             std::vector<CookedEntry>& fresh) const {
  if (!def.name.empty() && registry.bodyNames.contains(def.name))
    throw Error(path + ".name", kOwnName, "\"" + def.name + "\"");
  const std::shared_ptr<const CookedShape> cooked = cookShape(def.shape, path + ".shape", fresh);
  return {cooked, massOfDefinition(def, cooked->unit, path)};
}

BodyId World::Impl::addBody(const BodyDef& def, const ReadyBody& ready) {
  const std::shared_ptr<const CookedShape>& cooked = ready.cooked;
  const int indexBase = placeShape(def.shape, cooked), surface = surfaceOf(def.material);
  const BodyId id = registry.bodies.add(
      {def, ready.mass, {cooked->unit.centre, cooked->unit.axes}, cooked->radius});
  if (!def.name.empty()) registry.bodyNames[def.name] = id;
  engine->setBodyCount(registry.bodies.size());
  if (id.generation > 0) engine->forgetContacts(id.index);
  EngineBody body;
  body.kind = kindOf(def.motion);
  body.shape = cooked->shape;
  if (body.shape.data >= 0) body.shape.data += indexBase;
  body.radius = cooked->radius;
  body.material = def.material;
  body.surface = surface;
  body.mass = registry.bodies[id].mass;
  body.gravityScale = def.gravityScale;
  body.linearDamping = def.linearDamping, body.angularDamping = def.angularDamping;
  for (std::size_t k = 0; k < 3; ++k)
    body.locks |= (def.lockTranslation[k] ? 1 : 0) << k | (def.lockRotation[k] ? 8 : 0) << k;
  body.filter = def.filter;
  body.sensor = def.sensor;
  body.state = registry.bodies[id].frame.toEngine(
      {def.position, normalize(def.orientation), def.velocity, def.angularVelocity});
  engine->setBody(id.index, body);
  settingsChanged = true;
  ++epoch;
  planesChanged |= def.shape.type == ShapeType::Plane;
  return id;
}

void World::Impl::removeBody(BodyId id) { removeBodies({&id, 1}); }

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
  const auto goes = [&](BodyId id) { return std::binary_search(slots.begin(), slots.end(), id.index); };
  for (const JointId joint : registry.joints.ids())
    if (const JointRecord& r = registry.joints[joint];
        goes(r.a) || goes(r.b) || goes(r.carrierA) || goes(r.carrierB))
      removeJoint(joint);
  for (const BodyId id : ids) {
    removeAttachmentsOf(id);
    const BodyDef& def = registry.bodies[id].def;
    if (!def.name.empty()) registry.bodyNames.erase(def.name);
    planesChanged |= def.shape.type == ShapeType::Plane;
    exclusionsChanged |= std::erase_if(registry.exclusions, [&](const auto& pair) {
                           return pair.first == id.index || pair.second == id.index;
                         }) > 0;
    registry.bodies.remove(id);
    engine->setBody(id.index, {});
  }
  engine->forgetContactsOf(slots);
  settingsChanged = true;
  ++epoch;
}

JointId World::Impl::addJoint(const JointDef& def, BodyId a, BodyId b, BodyId carrierA, BodyId carrierB) {
  const auto check = [&](BodyId id) {
    if (id.index >= 0) requireAlive(id);
  };
  check(a), check(b), check(carrierA), check(carrierB);
  if (a == b) throw Error("joint", "two different bodies", "the same one twice");
  checkCarrier(def.type, a.index, carrierA.index, "joint.carrierA");
  checkCarrier(def.type, b.index, carrierB.index, "joint.carrierB");
  if (!def.name.empty() && registry.jointNames.contains(def.name))
    throw Error("joint.name", "a name that no other joint has", "\"" + def.name + "\"");
  JointRecord record{def, a, b, carrierA, carrierB, {}, 0};
  record.engine = engineJoint(inEngineFrames(def, a, b), jointBodies(record));
  record.engine.a = a.index, record.engine.b = b.index;
  record.engine.carrierA = carrierA.index, record.engine.carrierB = carrierB.index;
  const int type = static_cast<int>(record.engine.type);
  int& slot = record.engineSlot;
  if (registry.freeJointSlots[type].empty()) {
    slot = registry.jointSlots[type]++;
    engine->setJointCount(type, registry.jointSlots[type]);
  } else {
    slot = registry.freeJointSlots[type].back();
    registry.freeJointSlots[type].pop_back();
  }
  wakeBodiesOf(record);
  engine->setJoint(slot, record.engine);
  const JointId id = registry.joints.add(record);
  if (!def.name.empty()) registry.jointNames[def.name] = id;
  exclusionsChanged |= !def.collide;
  return id;
}

void World::Impl::removeJoint(JointId id) {
  requireAlive(id);
  const JointRecord& joint = registry.joints[id];
  EngineJoint none;
  none.type = joint.engine.type;
  wakeBodiesOf(joint);
  engine->setJoint(joint.engineSlot, none);
  registry.freeJointSlots[static_cast<int>(none.type)].push_back(joint.engineSlot);
  if (!joint.def.name.empty()) registry.jointNames.erase(joint.def.name);
  exclusionsChanged |= !joint.def.collide;
  registry.joints.remove(id);
}

void World::Impl::exclude(BodyId a, BodyId b, bool excluded) {
  requireAlive(a), requireAlive(b);
  if (a == b) throw Error("exclusion", "two different bodies", "the same one twice");
  const std::pair<int, int> pair = std::minmax(a.index, b.index);
  exclusionsChanged |= excluded ? registry.exclusions.insert(pair).second
                                : registry.exclusions.erase(pair) > 0;
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

void World::Impl::wakeBodiesOf(const JointRecord& joint) {
  for (const BodyId id : {joint.a, joint.b, joint.carrierA, joint.carrierB}) wake(id);
}

JointBodies World::Impl::jointBodies(const JointRecord& joint) const {
  const auto of = [&](BodyId id) {
    if (id.index < 0) return JointBodyState{};
    const BodyState state = engine->state(id.index);
    return JointBodyState{state.position, state.orientation, registry.bodies[id].mass};
  };
  return {of(joint.a), of(joint.b), of(joint.carrierA), of(joint.carrierB)};
}

void World::Impl::redefine(JointId id, const JointDef& def) {
  requireAlive(id);
  const JointRecord& record = registry.joints[id];
  if (def.type != record.def.type)
    throw Error("joint.type", "that of the joint, " + std::string(keyword(record.def.type)),
                keyword(def.type));
  if (def.name != record.def.name)
    throw Error("joint.name", "that of the joint, \"" + record.def.name + "\"", "\"" + def.name + "\"");
  validate(def, "joint");
  EngineJoint joint = engineJoint(inEngineFrames(def, record.a, record.b), jointBodies(record),
                                  &record.engine);
  if (joint.turned != record.engine.turned)
    throw Error("joint", "the same rotations locked as when it was made: they decide how turns are counted",
                "others");
  if (joint.type != record.engine.type)
    throw Error("joint", "friction or none, as when it was made: it decides what kind of joint it is",
                "the other");
  joint.a = record.engine.a, joint.b = record.engine.b;
  joint.carrierA = record.engine.carrierA, joint.carrierB = record.engine.carrierB;
  wakeBodiesOf(record);
  engine->editJoint(record.engineSlot, joint);
  exclusionsChanged |= def.collide != record.def.collide;
  JointRecord& changed = registry.joints.edit(id);
  changed.def = def;
  changed.engine = joint;
}

void World::Impl::findBroken(std::vector<JointId>& broken) {
  const std::vector<std::pair<int, int>> all = engine->brokenJoints();
  for (const JointId id : registry.joints.ids()) {
    const JointRecord& joint = registry.joints[id];
    if (joint.broken || !std::binary_search(all.begin(), all.end(),
                                            std::pair{static_cast<int>(joint.engine.type), joint.engineSlot}))
      continue;
    exclusionsChanged |= !joint.def.collide;
    registry.joints.edit(id).broken = true;
    broken.push_back(id);
  }
}

void World::Impl::flush() {
  flushSoft();
  if (planesChanged) {
    std::vector<int> planes;
    for (const BodyId id : registry.bodies.ids())
      if (registry.bodies[id].def.shape.type == ShapeType::Plane) planes.push_back(id.index);
    engine->setPlanes(planes);
    planesChanged = false;
  }
  if (exclusionsChanged) {
    std::vector<std::pair<int, int>> pairs(registry.exclusions.begin(), registry.exclusions.end());
    for (const JointId id : registry.joints.ids()) {
      const JointRecord& joint = registry.joints[id];
      if (!joint.def.collide && !joint.broken && joint.a.index >= 0 && joint.b.index >= 0)
        pairs.emplace_back(std::minmax(joint.a.index, joint.b.index));
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    engine->setExclusions(pairs);
    exclusionsChanged = false;
  }
  if (settingsChanged) {
    EngineSettings settings;
    settings.params = params;
    settings.gravity = registry.gravity;
    settings.wakeAll = std::exchange(disturbed, false);
    engine->configure(settings);
    settingsChanged = false;
  }
}

}  // namespace rubble
