#include <rubble/world.h>

#include <algorithm>
#include <chrono>
#include <numbers>

#include <rubble/info.h>

#include "cook/checks.h"
#include "world/world_impl.h"

namespace rubble {

std::unique_ptr<Engine> makeEngine(const WorldOptions& options) {
  if (options.backend == "cpu") return f32::makeCpuEngine(options.threads, options.timings);
  if (options.backend == "reference") return f64::makeCpuEngine(options.threads, options.timings);
  if (options.backend == "lockstep")
    return f32::makeLockstepEngine(f32::makeCpuEngine(1, options.timings),
                                   f32::makeCpuEngine(options.threads, false));
  if (options.backend == "cuda" || options.backend == "lockstep-cuda") {
    if (!cudaReady()) throw Error("backend", "a machine and a build with CUDA", cudaStatus());
    if (options.backend == "cuda") return makeCudaEngine(options.timings);
    return f32::makeLockstepEngine(f32::makeCpuEngine(options.threads, options.timings),
                                   makeCudaEngine(false));
  }
  std::string names;
  for (const std::string& name : backends()) names += (names.empty() ? "" : ", ") + name;
  throw Error("backend", "one of " + names, "\"" + options.backend + "\"");
}

void validate(const WorldOptions& options) {
  validate(options.params);
  if (options.threads < 0 || options.threads > kMostThreads)
    throw Error("threads", "a number from 0 to " + std::to_string(kMostThreads),
                std::to_string(options.threads));
}

std::vector<std::string> backends() {
  std::vector<std::string> names = {"cpu", "reference", "lockstep"};
  if (cudaReady()) names.insert(names.end(), {"cuda", "lockstep-cuda"});
  return names;
}

double StepReport::stageMs(const std::string& name) const {
  for (const StageTime& stage : stages)
    if (stage.name == name) return stage.ms;
  return 0;
}

World::World(const Scene& scene, const WorldOptions& options) : impl_(std::make_unique<Impl>()) {
  validate(scene);
  validate(options);
  impl_->params = options.params;
  impl_->engine = makeEngine(options);
  impl_->doublePrecision = options.backend == "reference";
  impl_->wantsEvents = options.events;
  impl_->build(scene);
}

void World::Impl::build(const Scene& scene) {
  Registry& r = registry;
  r.gravity = scene.gravity;
  configure(false);
  r.sceneBodies = addBodies(scene.bodies, "bodies");
  const auto idOf = [&](int body) {
    return body == kWorld ? BodyId{} : r.sceneBodies[static_cast<std::size_t>(body)];
  };
  for (const JointDef& joint : scene.joints)
    addJoint(joint, idOf(joint.bodyA), idOf(joint.bodyB), idOf(joint.frameBodyA), idOf(joint.frameBodyB));
  for (const auto& [a, b] : scene.exclusions) exclude(idOf(a), idOf(b), true);
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

StepReport World::step() try {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  impl_->flush();
  StepReport report;
  report.step = impl_->registry.step;
  const int interval = impl_->params.sortInterval;
  report.sorted = std::exchange(impl_->sortSoon, false) || (interval > 0 && report.step % interval == 0);
  if (report.sorted) impl_->engine->sortBodies(), ++impl_->epoch;
  impl_->engine->step(report);
  impl_->difference = report.difference;
  impl_->finishStep(report);
  report.totalMs = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  return report;
} catch (const std::bad_alloc&) {
  throw Error("step", "memory for the tables that it needs", "none left");
}

void World::Impl::finishStep(StepReport& report) {
  if (report.brokenJoints > 0) findBroken(report.broken);
  collectEvents(report);
  ++registry.step;
  registry.time += params.dt;
}

void World::sortBodies() { impl_->sortSoon = true; }

const Params& World::params() const { return impl_->params; }
void World::setParams(const Params& params) {
  validate(params);
  const Params before = std::exchange(impl_->params, params);
  try {
    impl_->configure(true);
  } catch (...) {
    impl_->params = before;
    throw;
  }
}
Vec3 World::gravity() const { return impl_->registry.gravity; }
void World::setGravity(const Vec3& gravity) {
  checks::finite(gravity, "gravity");
  impl_->registry.gravity = gravity;
  impl_->configure(true);
}
std::int64_t World::stepCount() const { return impl_->registry.step; }
double World::time() const { return impl_->registry.time; }

BodyId World::addBody(const BodyDef& body) {
  validate(body, "body");
  std::vector<CookedEntry> fresh;
  return impl_->addBody(body, impl_->ready(body, "body", fresh));
}
void World::removeBody(BodyId id) { impl_->removeBody(id); }
void World::setCollide(BodyId a, BodyId b, bool collide) { impl_->exclude(a, b, !collide); }
bool World::alive(BodyId id) const { return impl_->registry.bodies.alive(id); }
std::vector<BodyId> World::bodies() const { return impl_->registry.bodies.ids(); }

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
  validate(state, "state");
  if (impl_->registry.bodies[id].def.motion != Motion::Dynamic) impl_->wake(id);
  impl_->engine->apply(SetBodyState{id.index, impl_->registry.bodies[id].frame.toEngine(state)});
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
  s.angularVelocity = u > 0 ? d.v * (2 * std::atan2(u, d.s) / (u * dt)) : Vec3{};
  impl_->engine->apply(SetBodyState{id.index, s});
}
void World::applyForce(BodyId id, const Vec3& force) {
  impl_->requireAlive(id);
  checks::finite(force, "force");
  impl_->engine->apply(AddForce{id.index, force, {}});
}
void World::applyForceAt(BodyId id, const Vec3& force, const Vec3& point) {
  impl_->requireAlive(id);
  checks::finite(force, "force");
  checks::finite(point, "point");
  impl_->engine->apply(AddForce{id.index, force, cross(point - impl_->bodyState(id).position, force)});
}
void World::applyTorque(BodyId id, const Vec3& torque) {
  impl_->requireAlive(id);
  checks::finite(torque, "torque");
  impl_->engine->apply(AddForce{id.index, {}, torque});
}
void World::applyImpulse(BodyId id, const Vec3& impulse) { applyImpulses({&id, 1}, {&impulse, 1}); }

JointId World::addJoint(const JointDef& joint, BodyId a, BodyId b, BodyId frameBodyA, BodyId frameBodyB) {
  validate(joint, "joint");
  return impl_->addJoint(joint, a, b, frameBodyA, frameBodyB);
}
void World::removeJoint(JointId id) { impl_->removeJoint(id); }
bool World::alive(JointId id) const { return impl_->registry.joints.alive(id); }
std::vector<JointId> World::joints() const { return impl_->registry.joints.ids(); }
JointId World::findJoint(const std::string& name) const {
  const auto it = impl_->registry.jointNames.find(name);
  if (it == impl_->registry.jointNames.end()) throw Error("joint", "the name of a joint", "\"" + name + "\"");
  return it->second;
}
JointState World::state(JointId id) const {
  impl_->requireAlive(id);
  const JointRecord& joint = impl_->registry.joints[id];
  JointState state = impl_->engine->read().jointState(static_cast<int>(joint.engine.type), joint.engineSlot);
  state.axes.resize(static_cast<std::size_t>(axisCount(joint.def.type)));
  if (joint.engine.turned != 0) {
    const std::vector<JointAxisState> own = state.axes;
    for (std::size_t i = 0; i < own.size(); ++i)
      state.axes[i / 3 * 3 + (i + static_cast<std::size_t>(joint.engine.turned)) % 3] = own[i];
  }
  return state;
}

const JointDef& World::definition(JointId id) const {
  impl_->requireAlive(id);
  return impl_->registry.joints[id].def;
}
std::array<BodyId, 2> World::bodiesOf(JointId id) const {
  impl_->requireAlive(id);
  return {impl_->registry.joints[id].a, impl_->registry.joints[id].b};
}
std::array<BodyId, 2> World::frameBodiesOf(JointId id) const {
  impl_->requireAlive(id);
  return {impl_->registry.joints[id].frameBodyA, impl_->registry.joints[id].frameBodyB};
}
void World::setDefinition(JointId id, const JointDef& joint) { impl_->redefine(id, joint); }
void World::setTargetPosition(JointId id, int axis, double position) {
  impl_->requireAlive(id);
  if (definition(id).type == JointType::Spring)
    throw Error("joint", "setLength for a spring", "setTargetPosition");
  impl_->editAxis(id, axis, [&](JointAxis& a) { a.targetPosition = position; });
}
void World::setTargetSpeed(JointId id, int axis, double speed) {
  impl_->editAxis(id, axis, [&](JointAxis& a) { a.targetSpeed = speed; });
}
void World::setLimits(JointId id, int axis, double min, double max) {
  impl_->requireAlive(id);
  const JointType type = definition(id).type;
  if (hasLength(type) && type != JointType::Spring)
    throw Error("joint", std::string("setLength for a ") + keyword(type), "setLimits");
  impl_->editAxis(id, axis, [&](JointAxis& a) { a.min = min, a.max = max; });
}
void World::setLength(JointId id, double length) {
  impl_->requireAlive(id);
  JointDef def = definition(id);
  if (!hasLength(def.type)) throw Error("joint", "a distance, rope, spring or pulley", keyword(def.type));
  def.length = length;
  impl_->redefine(id, def);
}
void World::setDriveOrientation(JointId id, const Quat& orientation) {
  impl_->requireAlive(id);
  JointDef def = definition(id);
  if (def.type != JointType::SwingTwist) throw Error("joint", "a swing-twist joint", keyword(def.type));
  def.driveOrientation = orientation;
  impl_->redefine(id, def);
}

JointId World::addDragJoint(BodyId id, const Vec3& point, double maxForce, double frequency) {
  impl_->requireAlive(id);
  checks::positive(frequency, "frequency");
  checks::finite(point, "point");
  checks::positiveOrInfinite(maxForce, "maxForce");
  const BodyState body = state(id);
  JointDef def;
  def.type = JointType::Drag;
  def.anchorA = rotateInverse(body.orientation, point - body.position);
  def.anchorB = point;
  const double rate = 2 * std::numbers::pi * frequency;
  def.stiffness = impl_->registry.bodies[id].mass.mass * rate * rate;
  def.dampingRatio = 1;
  def.maxForce = maxForce;
  return addJoint(def, id, {});
}
void World::setDragTarget(JointId id, const Vec3& target) {
  impl_->requireAlive(id);
  JointDef def = definition(id);
  if (def.type != JointType::Drag) throw Error("joint", "a drag joint", keyword(def.type));
  def.anchorB = target;
  impl_->redefine(id, def);
}

Quality World::quality() const {
  impl_->flush();
  return impl_->engine->read().quality();
}

std::size_t World::memoryBytes() const { return impl_->engine->memoryBytes(); }
std::uint64_t World::hash() const {
  impl_->flush();
  return hashOf(*impl_->engine);
}

Snapshot World::snapshot() const {
  impl_->flush();
  return {std::make_shared<Snapshot::Data>(
      Snapshot::Data{impl_->registry, impl_->params, impl_->doublePrecision, impl_->engine->snapshot()})};
}
void World::restore(const Snapshot& snapshot) {
  if (!snapshot.data) throw Error("snapshot", "one made by World::snapshot", "an empty one");
  if (snapshot.data->doublePrecision != impl_->doublePrecision)
    throw Error("snapshot", "one of the precision of this backend",
                snapshot.data->doublePrecision ? "one in double" : "one in float");
  impl_->engine->restore(*snapshot.data->engine);
  impl_->restoreRecords(*snapshot.data);
}

void World::Impl::restoreRecords(const Snapshot::Data& data) {
  registry = data.registry;
  if (!inBatch) params = data.params;
  ++epoch;
  configure(false);
  softChanged = false;
}

std::string World::firstDifference() const { return impl_->difference; }

}  // namespace rubble
