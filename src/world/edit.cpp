#include <algorithm>

#include "world/world_impl.h"

namespace rubble {

namespace {

int kindOf(Motion motion) { return motion == Motion::Static ? 1 : motion == Motion::Kinematic ? 2 : 3; }

/// Radius of the sphere about the centre that holds the shape [m].
double boundingRadius(const Shape& shape) {
  switch (shape.type) {
    case ShapeType::Sphere: return shape.radius;
    case ShapeType::Capsule: return shape.radius + shape.halfLength;
    case ShapeType::Box: return length(shape.halfExtents);
    case ShapeType::Plane: break;
  }
  return 0;
}

MassProperties massOfDefinition(const BodyDef& def) {
  if (def.motion != Motion::Dynamic) return {};
  const MassProperties unit = massProperties(def.shape, 1);
  const double density = def.mass ? *def.mass / unit.mass : def.density;
  return massProperties(def.shape, density);
}

template <class Id>
std::string describe(Id id) {
  return "id " + std::to_string(id.index) + " of generation " + std::to_string(id.generation) + ", which is not alive";
}

}  // namespace

void World::Impl::requireAlive(BodyId id) const {
  if (!registry.bodies.alive(id)) throw Error("body", "an id that is alive", describe(id));
}
void World::Impl::requireAlive(JointId id) const {
  if (!registry.joints.alive(id)) throw Error("joint", "an id that is alive", describe(id));
}

BodyId World::Impl::addBody(const BodyDef& def, const std::string& path) {
  if (!def.name.empty() && registry.bodyNames.contains(def.name))
    throw Error(path + ".name", "a name that no other body has", "\"" + def.name + "\"");
  const BodyId id = registry.bodies.add({def, massOfDefinition(def)});
  if (!def.name.empty()) registry.bodyNames[def.name] = id;
  engine->setBodyCount(registry.bodies.size());
  if (id.generation > 0) engine->forgetContacts(id.index);
  EngineBody body;
  body.kind = kindOf(def.motion);
  body.shape = def.shape;
  body.material = def.material;
  body.mass = registry.bodies[id].mass;
  body.gravityScale = def.gravityScale;
  body.state = {def.position, normalize(def.orientation), def.velocity, def.angularVelocity};
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
  if (std::adjacent_find(slots.begin(), slots.end()) != slots.end()) throw Error("bodies", "each body once", "one of them twice");
  const auto goes = [&](BodyId id) { return std::binary_search(slots.begin(), slots.end(), id.index); };
  for (const JointId joint : registry.joints.ids())
    if (goes(registry.joints[joint].a) || goes(registry.joints[joint].b)) removeJoint(joint);
  for (const BodyId id : ids) {
    removeAttachmentsOf(id);
    const BodyDef& def = registry.bodies[id].def;
    if (!def.name.empty()) registry.bodyNames.erase(def.name);
    planesChanged |= def.shape.type == ShapeType::Plane;
    registry.bodies.remove(id);
    engine->setBody(id.index, {});
  }
  engine->forgetContactsOf(slots);
  settingsChanged = true;
  ++epoch;
}

JointId World::Impl::addJoint(const JointDef& def, BodyId a, BodyId b) {
  const auto check = [&](BodyId id) {
    if (id.index >= 0) requireAlive(id);
  };
  check(a), check(b);
  if (a == b) throw Error("joint", "two different bodies", "the same one twice");
  if (!def.name.empty() && registry.jointNames.contains(def.name)) throw Error("joint.name", "a name that no other joint has", "\"" + def.name + "\"");
  const int type = static_cast<int>(def.type);
  int slot;
  if (registry.freeJointSlots[type].empty()) {
    slot = registry.jointSlots[type]++;
    engine->setJointCount(type, registry.jointSlots[type]);
  } else {
    slot = registry.freeJointSlots[type].back();
    registry.freeJointSlots[type].pop_back();
  }
  EngineJoint joint;
  joint.type = type;
  joint.a = a.index, joint.b = b.index;
  joint.alive = true;
  joint.anchorA = def.anchorA, joint.anchorB = def.anchorB;
  joint.aToB = normalize(def.orientationAtoB);
  joint.compliance[0] = def.stiffness == kHard ? 0 : 1 / def.stiffness;
  joint.compliance[1] = def.angularStiffness == kHard ? 0 : 1 / def.angularStiffness;
  joint.bound[0] = def.breakForce, joint.bound[1] = def.breakTorque;
  engine->setJoint(slot, joint);
  const JointId id = registry.joints.add({def, a, b, slot});
  if (!def.name.empty()) registry.jointNames[def.name] = id;
  exclusionsChanged |= !def.collide;
  return id;
}

void World::Impl::removeJoint(JointId id) {
  requireAlive(id);
  const JointRecord& joint = registry.joints[id];
  const int type = static_cast<int>(joint.def.type);
  EngineJoint none;
  none.type = type;
  engine->setJoint(joint.engineSlot, none);
  registry.freeJointSlots[type].push_back(joint.engineSlot);
  if (!joint.def.name.empty()) registry.jointNames.erase(joint.def.name);
  exclusionsChanged |= !joint.def.collide;
  registry.joints.remove(id);
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
    std::vector<std::pair<int, int>> pairs;
    for (const JointId id : registry.joints.ids()) {
      const JointRecord& joint = registry.joints[id];
      if (!joint.def.collide && joint.a.index >= 0 && joint.b.index >= 0) pairs.emplace_back(std::minmax(joint.a.index, joint.b.index));
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
    std::vector<double> radii;
    for (const BodyId id : registry.bodies.ids()) {
      const BodyRecord& body = registry.bodies[id];
      if (body.def.motion != Motion::Dynamic) continue;
      const double radius = boundingRadius(body.def.shape);
      radii.push_back(radius);
      settings.maxMassLength = std::max(settings.maxMassLength, body.mass.mass * 2 * radius);
    }
    for (const SoftId id : registry.softs.ids()) {
      const SoftModel& model = *registry.softs[id].model;
      settings.maxMassLength = std::max(settings.maxMassLength, model.mass * model.size);
    }
    if (!radii.empty()) {
      const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
      std::nth_element(radii.begin(), middle, radii.end());
      settings.typicalRadius = *middle;
    }
    engine->configure(settings);
    settingsChanged = false;
  }
}

}  // namespace rubble
