/// Changes of living bodies.
#include <algorithm>

#include "cook/checks.h"
#include "world/world_impl.h"

namespace rubble {

void World::setDefinition(BodyId id, const BodyDef& body) {
  withMemory("setDefinition", [&] { impl_->redefine(id, body); });
}
void World::setMaterial(BodyId id, const Material& material) {
  impl_->editBody("setMaterial", id, [&](BodyDef& body) { body.material = material; });
}
void World::setFilter(BodyId id, const CollisionFilter& filter) {
  impl_->editBody("setFilter", id, [&](BodyDef& body) { body.filter = filter; });
}
void World::setMotion(BodyId id, Motion motion) {
  impl_->editBody("setMotion", id, [&](BodyDef& body) { body.motion = motion; });
}
void World::setMass(BodyId id, double mass) {
  impl_->editBody("setMass", id, [&](BodyDef& body) { body.mass = mass; });
}
void World::setShape(BodyId id, const Shape& shape) {
  impl_->editBody("setShape", id, [&](BodyDef& body) { body.shape = shape; });
}
void World::setDamping(BodyId id, double linear, double angular) {
  impl_->editBody("setDamping", id,
                  [&](BodyDef& body) { body.linearDamping = linear, body.angularDamping = angular; });
}
void World::setGravityScale(BodyId id, double scale) {
  impl_->editBody("setGravityScale", id, [&](BodyDef& body) { body.gravityScale = scale; });
}
void World::setLocks(BodyId id, const std::array<bool, 3>& translation, const std::array<bool, 3>& rotation) {
  impl_->editBody("setLocks", id,
                  [&](BodyDef& body) { body.lockTranslation = translation, body.lockRotation = rotation; });
}
void World::setSensor(BodyId id, bool sensor) {
  impl_->editBody("setSensor", id, [&](BodyDef& body) { body.sensor = sensor; });
}

void World::setUserData(BodyId id, std::uint64_t userData) {
  impl_->requireAlive(id);
  withMemory("setUserData", [&] { impl_->registry.bodies.edit(id).def.userData = userData; });
}
void World::setUserData(JointId id, std::uint64_t userData) {
  impl_->requireAlive(id);
  withMemory("setUserData", [&] { impl_->registry.joints.edit(id).def.userData = userData; });
}
void World::setUserData(DeformableId id, std::uint64_t userData) {
  impl_->requireAlive(id);
  withMemory("setUserData", [&] { common(impl_->registry.softs.edit(id).def).userData = userData; });
}
std::uint64_t World::userData(BodyId id) const { return definition(id).userData; }
std::uint64_t World::userData(JointId id) const { return definition(id).userData; }
std::uint64_t World::userData(DeformableId id) const { return common(definition(id)).userData; }

void World::Impl::setMaterialPairs(std::vector<MaterialPair> pairs) {
  engine->apply(surfacesEdit(registry.surfaces, pairs));
  registry.materialPairs = std::move(pairs);
  configure(true);
}
void World::setMaterialPair(const MaterialPair& pair) {
  validate(pair, "pair");
  withMemory("setMaterialPair", [&] {
    std::vector<MaterialPair> pairs = impl_->registry.materialPairs;
    std::erase_if(pairs, [&](const MaterialPair& p) { return ofSameMaterials(p, pair); });
    pairs.push_back(pair);
    impl_->setMaterialPairs(std::move(pairs));
  });
  impl_->pass(inputs::SetMaterialPair{pair});
}
void World::removeMaterialPair(const std::string& a, const std::string& b) {
  withMemory("removeMaterialPair", [&] {
    const MaterialPair pair{a, b};
    std::vector<MaterialPair> pairs = impl_->registry.materialPairs;
    if (std::erase_if(pairs, [&](const MaterialPair& p) { return ofSameMaterials(p, pair); }) == 0)
      throw Error("pair", "two names that have a rule", "\"" + a + "\" and \"" + b + "\"");
    impl_->setMaterialPairs(std::move(pairs));
    impl_->pass(inputs::SetMaterialPair{pair, true});
  });
}
const std::vector<MaterialPair>& World::materialPairs() const { return impl_->registry.materialPairs; }

Material World::materialOf(BodyId id, int part) const {
  const BodyDef& def = definition(id);
  const ShapePartDef* const found = partOf(def.shape, part);
  return found ? found->material.value_or(def.material) : def.material;
}
std::uint64_t World::shapeUserData(BodyId id, int part) const {
  return partUserData(definition(id).shape, part);
}

std::vector<JointId> World::jointsOf(BodyId id) const {
  impl_->requireAlive(id);
  return withMemory("jointsOf", [&] {
    std::vector<JointId> joints = impl_->registry.bodies[id].joints;
    std::ranges::sort(joints, {}, &JointId::index);
    return joints;
  });
}

std::vector<ContactPoint> World::contactsOf(BodyId id) const {
  impl_->requireAlive(id);
  std::vector<ContactPoint> points = contacts();
  std::erase_if(points, [id](const ContactPoint& p) { return p.a != id && p.b != id; });
  return points;
}

void World::setVelocity(BodyId id, const Vec3& velocity, const Vec3& angularVelocity) {
  BodyState moving = state(id);
  moving.velocity = velocity, moving.angularVelocity = angularVelocity;
  setState(id, moving);
}

void World::applyAngularImpulse(BodyId id, const Vec3& impulse) {
  impl_->requireAlive(id);
  checks::finite(impulse, "impulse");
  const BodyRecord& body = impl_->registry.bodies[id];
  if (body.def.motion != Motion::Dynamic) {
    impl_->idle.force.seen = true;
    return;
  }
  setState(id, impl_->turned(id, impulse));
}
BodyState World::Impl::turned(BodyId id, const Vec3& angularImpulse) const {
  const BodyRecord& body = registry.bodies[id];
  const BodyState own = bodyState(id);
  BodyState moving = body.frame.toAuthor(own);
  const Vec3 local = rotateInverse(own.orientation, angularImpulse), inertia = body.mass.inertia;
  moving.angularVelocity += rotate(own.orientation,
                                   Vec3{local.x / inertia.x, local.y / inertia.y, local.z / inertia.z});
  return moving;
}

void World::applyImpulseAt(BodyId id, const Vec3& impulse, const Vec3& point) {
  impl_->requireAlive(id);
  checks::finite(impulse, "impulse");
  checks::finite(point, "point");
  const Vec3 twist = cross(point - impl_->bodyState(id).position, impulse);
  checks::finite(twist, "angular impulse");
  if (impl_->isDynamic(id)) {
    // an Error after the first of two edits would leave a half
    BodyState after = impl_->turned(id, twist);
    after.velocity += impulse / impl_->registry.bodies[id].mass.mass;
    validate(after, "state");
  }
  applyImpulse(id, impulse);
  applyAngularImpulse(id, twist);
}

}  // namespace rubble
