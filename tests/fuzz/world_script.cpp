#include "tests/fuzz/world_script.h"

#include <algorithm>
#include <bit>

#include "tests/fuzz/target.h"

namespace rubble::fuzz {
namespace {

WorldOptions optionsFrom(ByteSource& in, const ScriptOptions& options) {
  WorldOptions out;
  out.backend = options.backend;
  out.threads = options.threads;
  out.params = Params::of(static_cast<Preset>(in.below(3)));
  out.params.iterations = 1 + in.below(4);
  out.params.substeps = in.seldom() ? 2 : 1;
  out.params.sleeping = in.flag();
  out.params.sortInterval = in.below(4);
  out.events = in.flag();
  out.timings = false;
  return out;
}

void addCompany(Scene& scene, Company company) {
  const Vec3 far{1e5, 0, 1e3};
  BodyDef body;
  if (company == Company::Still) {
    body.motion = Motion::Static;
    body.shape = Shape::sphere(.1);
    for (int k = 0; k < 3; ++k) {
      body.position = far + Vec3{3. * k, 0, 0};
      scene.bodies.push_back(body);
    }
    return;
  }
  body.position = far;
  body.angularVelocity = {3, 1, 2};
  scene.bodies.push_back(body);
  body.position = far + Vec3{1.5, 0, 0};
  body.material.restitution = .5;
  scene.bodies.push_back(body);
  BodyDef ball;
  ball.shape = Shape::sphere(.5);
  ball.position = far + Vec3{.4, 0, 1};
  ball.material.rollingFriction = .01;
  scene.bodies.push_back(ball);
  JointDef joint;
  joint.bodyA = 1, joint.bodyB = 2;
  joint.anchorA = {.75, 0, 0}, joint.anchorB = {-.75, 0, 0};
  scene.joints.push_back(joint);
  scene.deformables.push_back(clothSheet(far + Vec3{-1, -1, 1.7}, {2, 0, 0}, {0, 2, 0}, 3, 3));
}

/// The ground, so that there is something to touch.
Scene groundScene(ByteSource& in, Company company) {
  Scene scene;
  if (in.flag()) scene.gravity = in.vector(-20, 20);
  BodyDef ground;
  ground.motion = Motion::Static;
  ground.shape = in.flag() ? Shape::box({4, 4, .5}) : Shape::plane();
  ground.position = {0, 0, -1};
  scene.bodies = {ground};
  if (company != Company::None) addCompany(scene, company);
  return scene;
}

bool isFinite(const Vec3& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }
bool isFinite(const BodyState& s) {
  return isFinite(s.position) && isFinite(s.velocity) && isFinite(s.angularVelocity) &&
         std::isfinite(s.orientation.s) && isFinite(s.orientation.v);
}

/// FNV-1a of the bits of numbers.
class Fingerprint {
 public:
  void add(double a) { bits_ = (bits_ ^ std::bit_cast<std::uint64_t>(a)) * 0x100000001b3ull; }
  void add(const Vec3& a) { add(a.x), add(a.y), add(a.z); }
  std::uint64_t bits() const { return bits_; }

 private:
  std::uint64_t bits_ = 0xcbf29ce484222325ull;
};

}  // namespace

WorldScript::WorldScript(ByteSource bytes, const ScriptOptions& options)
    : in_(bytes),
      options_(options),
      worldOptions_(optionsFrom(in_, options)),
      world_(groundScene(in_, options.company), worldOptions_),
      trace_{world_.hash()} {
  company_ = {world_.bodies(), world_.joints(), world_.deformables(), {}};
  alive_.bodies = {company_.bodies.front()};
  company_.bodies.erase(company_.bodies.begin());
}

void WorldScript::run() {
  for (int i = 0; i < options_.mostCommands && !in_.atEnd() && steps_ < options_.mostSteps; ++i) {
    const Alive before = alive_;
    const std::uint64_t hash = trace_.back();
    try {
      command();
      trace_.push_back(world_.hash());
    } catch (const Error& error) {
      errors_.push_back(std::to_string(i) + " " + error.what());
      alive_ = before;
      trace_.push_back(world_.hash());
      expect(trace_.back() == hash, "an Error changed the world: " + errors_.back());
    }
    expectModel();
  }
  step();
  trace_.push_back(fingerprint());
  expectModel();
}

void WorldScript::command() {
  switch (in_.below(20)) {
    case 0:
    case 1:
    case 2:
      return addBodies();
    case 3:
    case 4:
      return addJoint();
    case 5:
    case 6:
      return addDeformable();
    case 7:
      return addAttachment();
    case 8:
      return remove();
    case 9:
      return setBody();
    case 10:
      return push();
    case 11:
      return changeJoint();
    case 12:
      return changeVertices();
    case 13:
      return changeSettings();
    case 14:
      return arrange();
    case 15:
      return query();
    case 16:
      return remember();
    case 17:
      return forget();
    default:
      for (int more = 1 + in_.below(4); more > 0; --more) step();
  }
}

void WorldScript::step() {
  const StepReport report = world_.step();
  ++steps_;
  expectHonest(report);
  expectFinite();
}

void WorldScript::remember() {
  if (memories_.size() < 3) memories_.push_back({world_.snapshot(), alive_, world_.hash()});
}

void WorldScript::forget() {
  if (memories_.empty()) return;
  const Memory& memory = memories_[static_cast<std::size_t>(in_.byte()) % memories_.size()];
  world_.restore(memory.snapshot);
  alive_ = memory.alive;
  expect(world_.hash() == memory.hash, "a restored world is another one");
}

void WorldScript::noteRemoved() {
  const auto dead = [&](auto id) { return !world_.alive(id); };
  std::erase_if(alive_.joints, dead);
  std::erase_if(alive_.attachments, dead);
}

std::uint64_t WorldScript::fingerprint() const {
  Fingerprint out;
  for (const BodyId id : alive_.bodies) {
    const BodyState s = world_.state(id);
    out.add(s.position), out.add(s.orientation.s), out.add(s.orientation.v);
    out.add(s.velocity), out.add(s.angularVelocity);
  }
  for (const DeformableId id : alive_.deformables) {
    for (const Vec3& x : world_.positions(id)) out.add(x);
    for (const Vec3& v : world_.velocities(id)) out.add(v);
  }
  return out.bits();
}

template <class Id>
std::vector<Id> WorldScript::without(std::vector<Id> ids, const std::vector<Id>& company) {
  std::erase_if(ids, [&](const Id& id) { return std::ranges::find(company, id) != company.end(); });
  return ids;
}

void WorldScript::expectModel() {
  expect(without(world_.bodies(), company_.bodies) == alive_.bodies,
         "other bodies are alive than were added and not removed");
  expect(without(world_.joints(), company_.joints) == alive_.joints,
         "other joints are alive than were added and not removed");
  expect(without(world_.deformables(), company_.deformables) == alive_.deformables,
         "other objects are alive than were added");
  expect(world_.attachments() == alive_.attachments, "other attachments are alive than were added");
}

void WorldScript::expectHonest(const StepReport& report) {
  const int bodies = static_cast<int>(alive_.bodies.size() + company_.bodies.size());
  int vertices = 0;
  for (const auto* const ids : {&alive_.deformables, &company_.deformables})
    for (const DeformableId id : *ids) vertices += world_.vertexCount(id);
  expect(report.bodies == bodies, "the report counts other bodies");
  expect(report.vertices == vertices, "the report counts other vertices");
  expect(report.manifolds >= 0 && report.pairs >= 0 && report.contacts >= report.manifolds,
         "a touching pair of the report has no contact");
  expect(report.brokenJoints >= static_cast<int>(report.broken.size()), "a broken joint is not counted");
  for (const JointId id : report.broken)
    expect(world_.alive(id) && world_.state(id).broken, "a joint that broke is not broken");
  int sleeping = 0;
  for (const BodyId id : world_.bodies()) sleeping += world_.asleep(id);
  expect(report.sleepingBodies == sleeping, "the report counts other sleeping bodies");
  expect(report.stoppedBodies <= bodies && report.quarantined >= 0, "the report counts more than there is");
}

void WorldScript::expectFinite() {
  for (const BodyId id : alive_.bodies) {
    const BodyState state = world_.state(id);
    expect(isFinite(state), "a body is not finite");
    farthest_ = std::max({farthest_, length(state.position), length(state.velocity)});
  }
  hadVertices_ |= !alive_.deformables.empty();
  for (const DeformableId id : alive_.deformables) {
    for (const Vec3& x : world_.positions(id)) expect(isFinite(x), "a vertex is not finite");
    for (const Vec3& v : world_.velocities(id)) expect(isFinite(v), "a velocity of a vertex is not finite");
  }
  for (const ContactPoint& c : world_.contacts()) {
    expect(world_.alive(c.a) && world_.alive(c.b), "a contact has a body that is not alive");
    expect(isFinite(c.position) && isFinite(c.force) && isFinite(c.normal), "a contact is not finite");
    const auto isCompany = [&](BodyId id) {
      return std::ranges::find(company_.bodies, id) != company_.bodies.end();
    };
    meetsCompany_ |= isCompany(c.a) != isCompany(c.b);  // a plane that was turned reaches far
  }
  for (const JointId id : alive_.joints) {
    const JointState state = world_.state(id);
    expect(isFinite(state.force) && isFinite(state.torque), "a force of a joint is not finite");
  }
  const Quality quality = world_.quality();
  expect(std::isfinite(quality.kineticEnergy), "the energy is not finite");
}

}  // namespace rubble::fuzz
