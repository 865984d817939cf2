#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cook/checks.h"
#include "world/world_impl.h"

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

BodyId World::Impl::addBody(const BodyDef& def, const ReadyBody& ready) {
  const std::shared_ptr<const CookedShape>& cooked = ready.cooked;
  const int indexBase = placeShape(def.shape, cooked), surface = surfaceOf(def.material);
  const BodyId id = registry.bodies.add(
      {def, ready.mass, {cooked->unit.center, cooked->unit.axes}, cooked->radius});
  if (!def.name.empty()) registry.bodyNames[def.name] = id;
  if (id.generation > 0) engine->apply(ForgetContacts{{id.index}});
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
  engine->apply(SetBody{id.index, body});
  ++epoch;
  if (def.shape.type == ShapeType::Plane) setPlanes();
  return id;
}

void World::Impl::setPlanes() {
  std::vector<int> planes;
  for (const BodyId id : registry.bodies.ids())
    if (registry.bodies[id].def.shape.type == ShapeType::Plane) planes.push_back(id.index);
  engine->apply(SetPlanes{std::move(planes)});
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
  bool planes = false;
  for (const BodyId id : ids) {
    const std::vector<JointId> joints = registry.bodies[id].joints;
    for (const JointId joint : joints) removeJoint(joint);
    removeAttachmentsOf(id);
    const BodyDef& def = registry.bodies[id].def;
    if (!def.name.empty()) registry.bodyNames.erase(def.name);
    planes |= def.shape.type == ShapeType::Plane;
    for (auto pair = registry.exclusions.begin(); pair != registry.exclusions.end();) {
      const bool goes = pair->first == id.index || pair->second == id.index;
      if (goes) engine->apply(SetExcluded{pair->first, pair->second, false});
      pair = goes ? registry.exclusions.erase(pair) : std::next(pair);
    }
    registry.bodies.remove(id);
    engine->apply(SetBody{id.index, {}});
  }
  engine->apply(ForgetContacts{std::move(slots)});
  if (planes) setPlanes();
  ++epoch;
}

JointId World::Impl::addJoint(const JointDef& def, BodyId a, BodyId b, BodyId frameBodyA, BodyId frameBodyB) {
  const auto check = [&](BodyId id) {
    if (id.index >= 0) requireAlive(id);
  };
  check(a), check(b), check(frameBodyA), check(frameBodyB);
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
  int& slot = record.engineSlot;
  if (registry.freeJointSlots[type].empty()) {
    slot = registry.jointSlots[type]++;
  } else {
    slot = registry.freeJointSlots[type].back();
    registry.freeJointSlots[type].pop_back();
  }
  wakeBodiesOf(record);
  engine->apply(SetJoint{slot, record.engine});
  const JointId id = registry.joints.add(record);
  if (!def.name.empty()) registry.jointNames[def.name] = id;
  listJoint(id, record, true);
  if (!def.collide) updateExclusion(a, b);
  return id;
}

void World::Impl::removeJoint(JointId id) {
  requireAlive(id);
  const JointRecord joint = registry.joints[id];
  EngineJoint none;
  none.type = joint.engine.type;
  wakeBodiesOf(joint);
  engine->apply(SetJoint{joint.engineSlot, none});
  registry.freeJointSlots[static_cast<std::size_t>(none.type)].push_back(joint.engineSlot);
  if (!joint.def.name.empty()) registry.jointNames.erase(joint.def.name);
  listJoint(id, joint, false);
  registry.joints.remove(id);
  if (!joint.def.collide) updateExclusion(joint.a, joint.b);
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
  if (excluded)
    registry.exclusions.insert(pair);
  else
    registry.exclusions.erase(pair);
  updateExclusion(a, b);
}

bool World::Impl::excludes(BodyId a, BodyId b) const {
  if (registry.exclusions.contains(std::minmax(a.index, b.index))) return true;
  return std::ranges::any_of(registry.bodies[a].joints, [&](JointId id) {
    const JointRecord& joint = registry.joints[id];
    const bool links = (joint.a == a && joint.b == b) || (joint.a == b && joint.b == a);
    return links && !joint.def.collide && !joint.broken;
  });
}

void World::Impl::updateExclusion(BodyId a, BodyId b) {
  if (a.index >= 0 && b.index >= 0) engine->apply(SetExcluded{a.index, b.index, excludes(a, b)});
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
  for (const BodyId id : {joint.a, joint.b, joint.frameBodyA, joint.frameBodyB}) wake(id);
}

JointBodies World::Impl::jointBodies(const JointRecord& joint) const {
  const auto of = [&](BodyId id) {
    if (id.index < 0) return JointBodyState{};
    const BodyState state = bodyState(id);
    return JointBodyState{state.position, state.orientation, registry.bodies[id].mass};
  };
  return {of(joint.a), of(joint.b), of(joint.frameBodyA), of(joint.frameBodyB)};
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
  joint.frameBodyA = record.engine.frameBodyA, joint.frameBodyB = record.engine.frameBodyB;
  wakeBodiesOf(record);
  engine->apply(SetJoint{record.engineSlot, joint, true});
  JointRecord& changed = registry.joints.edit(id);
  const bool collided = changed.def.collide;
  changed.def = def;
  changed.engine = joint;
  if (def.collide != collided) updateExclusion(changed.a, changed.b);
}

void World::Impl::findBroken(std::vector<JointId>& broken) {
  const std::vector<std::pair<int, int>> all = engine->read().brokenJoints();
  for (const JointId id : registry.joints.ids()) {
    const JointRecord& joint = registry.joints[id];
    if (joint.broken || !std::binary_search(all.begin(), all.end(),
                                            std::pair{static_cast<int>(joint.engine.type), joint.engineSlot}))
      continue;
    registry.joints.edit(id).broken = true;
    if (!joint.def.collide) updateExclusion(joint.a, joint.b);
    broken.push_back(id);
  }
}

void World::Impl::configure(bool wakesAll) {
  EngineSettings settings;
  settings.params = params;
  settings.gravity = registry.gravity;
  settings.wakeAll = wakesAll;
  engine->configure(settings);
}

}  // namespace rubble
