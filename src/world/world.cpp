#include <rubble/world.h>

#include <algorithm>
#include <chrono>

#include "cook/checks.h"
#include "math/portable.h"
#include "world/body_additions.h"
#include "world/world_impl.h"

namespace rubble {

double StepReport::stageMs(const std::string& name) const {
  for (const StageTime& stage : stages)
    if (stage.name == name) return stage.ms;
  return 0;
}

World::World(const Scene& scene, const WorldOptions& options) try : impl_(std::make_unique<Impl>()) {
  validate(scene);
  validate(options);
  impl_->params = options.params;
  impl_->engine = makeEngine(options);
  impl_->doublePrecision = options.backend == "reference";
  impl_->wantsEvents = options.events;
  impl_->log = options.log;
  impl_->tasks = options.tasks;
  impl_->build(scene);
} catch (const std::bad_alloc&) {
  throw OutOfMemory("World");
}

void World::Impl::build(const Scene& scene) {
  Registry& r = registry;
  r.gravity = scene.gravity;
  r.materialPairs = scene.materialPairs;
  configure(false);
  r.sceneBodies = addBodies(scene.bodies, "bodies");
  const auto idOf = [&](int body) {
    return body == kWorld ? BodyId{} : r.sceneBodies[static_cast<std::size_t>(body)];
  };
  r.joints.prepare(static_cast<int>(scene.joints.size()));
  for (const JointDef& joint : scene.joints)
    addJoint(joint, idOf(joint.bodyA), idOf(joint.bodyB), idOf(joint.frameBodyA), idOf(joint.frameBodyB));
  for (const auto& [a, b] : scene.exclusions) exclude(idOf(a), idOf(b), true);
  if (!scene.events.empty()) setScript(scene.events);
  for (std::size_t i = 0; i < scene.deformables.size(); ++i)
    r.sceneSofts.push_back(addSoft(scene.deformables[i], Path("deformables")[i]));
  const auto softOf = [&](int object) {
    return object < 0 ? DeformableId{} : r.sceneSofts[static_cast<std::size_t>(object)];
  };
  for (std::size_t i = 0; i < scene.attachments.size(); ++i) {
    const AttachmentDef& a = scene.attachments[i];
    addAttachment(a, softOf(a.object), idOf(a.body), softOf(a.otherObject), Path("attachments")[i]);
  }
}

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

StepReport World::step() {
  runEvents();
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  Registry& r = impl_->registry;
  StepReport report = withMemory("step", [&] {
    StepReport out;
    impl_->flush();
    impl_->findUnlistedBreaks();
    out.step = r.step;
    const int interval = impl_->params.sortInterval;
    out.sorted = impl_->sortSoon || (interval > 0 && r.step % interval == 0);
    if (out.sorted) impl_->engine->sortBodies(), ++impl_->epoch;
    impl_->sortSoon = false;
    try {
      impl_->engine->step(out);
    } catch (const LostPausedContacts&) {
      impl_->countSteps(1, out, false);
      throw;
    }
    impl_->countSteps(1, out, false);
    impl_->finishStep(out);
    out.broken = impl_->broken;
    return out;
  });
  report.totalMs = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  impl_->pass(inputs::Step{});
  if (impl_->log)
    withMemory("log", [&] {
      logStep(report, "step " + std::to_string(report.step), impl_->log);
      impl_->idle.write(impl_->log);
    });
  impl_->broken.clear();
  return report;
}

void World::Impl::finishStep(const StepReport& taken) {
  if (wantsEvents) events = {};
  if (difference != taken.difference) difference = taken.difference;
  findUnlistedBreaks();
  if (wantsEvents) collectEvents(broken);
}

void World::sortBodies() {
  impl_->sortSoon = true;
  impl_->pass(inputs::SortBodies{});
}

const Params& World::params() const { return impl_->params; }
void World::setParams(const Params& params) {
  validate(params);
  const Params before = std::exchange(impl_->params, params);
  try {
    withMemory("setParams", [&] { impl_->configure(true); });
  } catch (...) {
    impl_->params = before;
    throw;
  }
  impl_->pass(inputs::SetParams{params});
}
Vec3 World::gravity() const { return impl_->registry.gravity; }
void World::setGravity(const Vec3& gravity) {
  checks::finite(gravity, "gravity");
  const Vec3 before = std::exchange(impl_->registry.gravity, gravity);
  Undo undo([&] { impl_->registry.gravity = before; });
  withMemory("setGravity", [&] { impl_->configure(true); });
  undo.keep();
  impl_->pass(inputs::SetGravity{gravity});
}
std::int64_t World::stepCount() const { return impl_->registry.step; }
double World::time() const { return impl_->registry.time; }

BodyId World::addBody(const BodyDef& body) {
  const BodyId id = withMemory("addBody", [&] {
    validate(body, "body");
    BodyAdditions added(impl_->registry, *impl_->cooked, 1);
    added.add(body, "body");
    const BodyId id = added.commit(*impl_->engine).front();
    ++impl_->epoch;
    return id;
  });
  impl_->pass(inputs::AddBodies{{&body, 1}});
  return id;
}
void World::removeBody(BodyId id) { removeBodies({&id, 1}); }
void World::setCollide(BodyId a, BodyId b, bool collide) {
  withMemory("setCollide", [&] { impl_->exclude(a, b, !collide); });
  impl_->pass(inputs::SetCollide{a, b, collide});
}
bool World::alive(BodyId id) const { return impl_->registry.bodies.alive(id); }
std::vector<BodyId> World::bodies() const {
  return withMemory("bodies", [&] { return impl_->registry.bodies.ids(); });
}

BodyId World::findBody(const std::string& name) const {
  const auto it = impl_->registry.bodyNames.find(name);
  if (it == impl_->registry.bodyNames.end()) throw Error("body", "the name of a body", "\"" + name + "\"");
  return it->second;
}
BodyId World::bodyAt(int sceneIndex) const {
  const std::vector<BodyId>& ids = impl_->registry.sceneBodies;
  if (sceneIndex < 0 || static_cast<std::size_t>(sceneIndex) >= ids.size())
    throw Error("body", "an index below " + std::to_string(ids.size()), std::to_string(sceneIndex));
  return ids[static_cast<std::size_t>(sceneIndex)];
}
const BodyDef& World::definition(BodyId id) const {
  impl_->requireAlive(id);
  return impl_->registry.bodies[id].def;
}
MassProperties World::massOf(BodyId id) const {
  impl_->requireAlive(id);
  return impl_->registry.bodies[id].mass;
}
BodyState World::state(BodyId id) const {
  impl_->requireAlive(id);
  return impl_->registry.bodies[id].frame.toAuthor(impl_->bodyState(id));
}
void World::setState(BodyId id, const BodyState& state) {
  impl_->requireAlive(id);
  if (impl_->registry.bodies[id].def.motion != Motion::Dynamic) return setStates({&id, 1}, {&state, 1});
  validate(state, "state");
  impl_->engine->apply(SetBodyState{id.index, impl_->registry.bodies[id].frame.toEngine(state)});
  impl_->pass(inputs::SetStates{{&id, 1}, {&state, 1}});
}
void World::setTarget(BodyId id, const Vec3& position, const Quat& orientation) {
  impl_->requireAlive(id);
  if (impl_->registry.bodies[id].def.motion != Motion::Kinematic)
    throw Error("target", "a kinematic body", "another");
  checks::finite(position, "position");
  checks::rotation(orientation, "orientation");
  BodyState s = impl_->bodyState(id);
  const double dt = impl_->params.dt;
  const BodyState target = impl_->registry.bodies[id].frame.toEngine(
      {position, normalize(orientation), {}, {}});
  s.velocity = (target.position - s.position) / dt;
  Quat d = target.orientation * conjugate(s.orientation);
  if (d.s < 0) d = {-d.s, -d.v};
  const double u = length(d.v);
  s.angularVelocity = u > 0 ? d.v * (2 * portable::atan2(u, d.s) / (u * dt)) : Vec3{};
  impl_->engine->apply(SetBodyState{id.index, s});
  impl_->pass(inputs::SetTarget{id, position, orientation});
}
void World::applyForce(BodyId id, const Vec3& force) {
  impl_->requireAlive(id);
  checks::finite(force, "force");
  impl_->push(id, force, {});
}
void World::applyForceAt(BodyId id, const Vec3& force, const Vec3& point) {
  impl_->requireAlive(id);
  checks::finite(force, "force");
  checks::finite(point, "point");
  const Vec3 torque = cross(point - impl_->bodyState(id).position, force);
  checks::finite(torque, "torque");
  impl_->push(id, force, torque);
}
void World::applyTorque(BodyId id, const Vec3& torque) {
  impl_->requireAlive(id);
  checks::finite(torque, "torque");
  impl_->push(id, {}, torque);
}
void World::Impl::push(BodyId id, const Vec3& force, const Vec3& torque) {
  idle.force.seen |= !isDynamic(id);
  engine->apply(AddForce{id.index, force, torque});
  pass(inputs::ApplyForces{{&id, 1}, {&force, 1}, {&torque, 1}});
}
void World::applyImpulse(BodyId id, const Vec3& impulse) { applyImpulses({&id, 1}, {&impulse, 1}); }

Quality World::quality() const {
  return withMemory("quality", [&] {
    impl_->flush();
    return impl_->engine->read().quality();
  });
}

std::size_t World::memoryBytes() const { return impl_->engine->memoryBytes(); }
std::uint64_t World::hash() const {
  return withMemory("hash", [&] {
    impl_->flush();
    return hashOf(*impl_->engine);
  });
}

std::vector<TableHash> World::tableHashes() const {
  return withMemory("tableHashes", [&] {
    impl_->flush();
    return impl_->engine->tableHashes();
  });
}

void World::setInputSink(inputs::Sink sink) { impl_->inputs = std::move(sink); }

Snapshot World::snapshot() const {
  Snapshot out = withMemory("snapshot", [&] {
    impl_->flush();
    auto data = std::make_shared<Snapshot::Data>(
        Snapshot::Data{impl_->registry, impl_->params, impl_->doublePrecision, impl_->engine->snapshot()});
    data->registry.actuators = impl_->actuatorValues(&data->registry.actuatorDefinitions);
    return Snapshot{std::move(data)};
  });
  impl_->pass(inputs::TakeSnapshot{out});
  return out;
}
void World::restore(const Snapshot& snapshot) {
  if (!snapshot.data) throw Error("snapshot", "one made by World::snapshot", "an empty one");
  if (snapshot.data->doublePrecision != impl_->doublePrecision)
    throw Error("snapshot", "one of the precision of this backend",
                snapshot.data->doublePrecision ? "one in double" : "one in float");
  withMemory("restore", [&] {
    Registry copy = snapshot.data->registry;
    impl_->restoreEngine(*snapshot.data->engine, copy);
    impl_->restoreRecords(std::move(copy), snapshot.data->params);
  });
  impl_->pass(inputs::Restore{snapshot});
}

void World::Impl::restoreEngine(const EngineSnapshot& snapshot, const Registry& from) {
  // rules are no part of the state of an engine, but of a batch
  if (inBatch || (registry.materialPairs.empty() && from.materialPairs.empty()))
    return engine->restore(snapshot);
  const SetSurfaces before = surfacesEdit(registry.surfaces, registry.materialPairs),
                    after = surfacesEdit(from.surfaces, from.materialPairs);
  // the first time for the memory that it takes
  engine->apply(after);
  try {
    engine->restore(snapshot);
  } catch (...) {
    engine->apply(before);
    throw;
  }
  engine->apply(after);
}

void World::Impl::restoreRecords(Registry&& from, const Params& own) {
  registry = std::move(from);
  broken.clear(), events = {};
  setActuatorValues(registry.actuators, registry.actuatorDefinitions);
  registry.actuators.clear(), registry.actuatorDefinitions.clear();
  jointRowsChanged = true;
  if (!inBatch) params = own;
  ++epoch;
  configure(false);
  softChanged = false;
}

std::string World::firstDifference() const { return impl_->difference; }

}  // namespace rubble
