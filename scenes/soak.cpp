#include "soak.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubble::scenes {
namespace {

constexpr double kHalfLink = .2;  // half the edge of jointed cubes [m]
constexpr double kSize = .3;      // of a body, about half its diameter [m]
constexpr std::size_t kMostFaults = 20;
constexpr int kReplaySteps = 20;
// probabilities per step
constexpr double kChurn = .2, kDisturb = .3, kJoints = .1, kSort = .02, kSnapshot = .01, kRestore = .005,
                 kReplay = .005, kLook = .05;
/// Deepest that the center of a body may lie below the ground [m]: a body's own size; above that it has
/// fallen through.
constexpr double kDeepest = kSize;
/// Farthest that a body may be from the start [m]: what the largest impulse would give in a minute.
constexpr double kFarthest = 600;
/// Speed that no body reaches [m/s]: bodies fall from up to 15 m and are pushed by 5 m/s.
constexpr double kFastest = 60;

Scene emptyHeap() {
  Scene scene;
  scene.gravity = {0, 0, -9.81};
  BodyDef ground;
  ground.name = "ground";
  ground.motion = Motion::Static;
  ground.shape = Shape::plane();
  scene.bodies.push_back(ground);
  return scene;
}

}  // namespace

std::uint64_t Soak::Random::bits() {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

Quat Soak::Random::rotation() {
  for (;;) {
    const Quat q{uniform(-1, 1), vector(1)};
    const double norm2 = q.s * q.s + dot(q.v, q.v);
    if (norm2 > .01 && norm2 < 1) return normalize(q);
  }
}

Soak::Soak(const SoakOptions& options)
    : options_(options), random_{options.seed}, world_(emptyHeap(), options.world) {
  if (options.bodies < 2) throw Error("bodies", "at least 2", std::to_string(options.bodies));
  addSome(options.bodies);
}

double Soak::halfWidth() const { return kSize * std::sqrt(static_cast<double>(options_.bodies)) / 2; }

BodyDef Soak::randomBody() {
  BodyDef body;
  const double a = kSize * random_.uniform(.5, 1), b = kSize * random_.uniform(.5, 1),
               c = kSize * random_.uniform(.5, 1);
  const int kind = random_.below(4);
  body.shape = kind == 0   ? Shape::sphere(a)
               : kind == 1 ? Shape::capsule(a / 2, b / 2)
                           : Shape::box({a, b, c});
  body.density = random_.uniform(300, 3000);
  body.material.staticFriction = body.material.dynamicFriction = random_.uniform(.1, 1);
  const double w = halfWidth();
  body.position = {random_.uniform(-w, w), random_.uniform(-w, w), random_.uniform(2, 10)};
  body.orientation = random_.rotation();
  return body;
}

void Soak::addSome(int count) {
  std::vector<BodyDef> bodies;
  for (int k = 0; k < count; ++k) bodies.push_back(randomBody());
  const std::vector<BodyId> ids = world_.addBodies(bodies);
  alive_.insert(alive_.end(), ids.begin(), ids.end());
  counts_.added += count;
}

std::vector<BodyId> Soak::someBodies(int most) {
  std::vector<BodyId> out;
  const int count = std::min(static_cast<int>(alive_.size()), 1 + random_.below(most));
  // consecutive bodies from a random one on, so that no body occurs twice
  const std::size_t first = static_cast<std::size_t>(random_.below(static_cast<int>(alive_.size())));
  for (int k = 0; k < count; ++k)
    out.push_back(alive_[(first + static_cast<std::size_t>(k)) % alive_.size()]);
  return out;
}

void Soak::removeSome(int count) {
  const std::vector<BodyId> gone = someBodies(count);
  world_.removeBodies(gone);
  std::erase_if(alive_, [&](BodyId id) { return std::find(gone.begin(), gone.end(), id) != gone.end(); });
  counts_.removed += static_cast<std::int64_t>(gone.size());
}

void Soak::disturbSome() {
  std::vector<BodyId> ids = someBodies(20);
  const int kind = random_.below(3);
  // a jointed body cannot be moved on its own
  if (kind == 2)
    std::erase_if(
        ids, [&](BodyId id) { return std::find(jointed_.begin(), jointed_.end(), id) != jointed_.end(); });
  std::vector<Vec3> impulses, forces, torques;
  std::vector<BodyState> states;
  for (const BodyId id : ids) {
    const double mass = world_.massOf(id).mass;
    impulses.push_back(mass * random_.vector(5));
    forces.push_back(mass * random_.vector(50));
    torques.push_back(mass * kSize * kSize * random_.vector(50));
    const double w = halfWidth();
    states.push_back({{random_.uniform(-w, w), random_.uniform(-w, w), random_.uniform(2, 10)},
                      random_.rotation(),
                      random_.vector(3),
                      random_.vector(5)});
  }
  const auto count = static_cast<std::int64_t>(ids.size());
  switch (kind) {
    case 0:
      world_.applyImpulses(ids, impulses), counts_.pushed += count;
      break;
    case 1:
      world_.applyForces(ids, forces, torques), counts_.forced += count;
      break;
    default:
      world_.setStates(ids, states), counts_.placed += count;
      break;
  }
}

void Soak::changeJoints() {
  const std::vector<JointId> joints = world_.joints();
  if (!joints.empty() && random_.chance(.5)) {
    world_.removeJoint(joints[static_cast<std::size_t>(random_.below(static_cast<int>(joints.size())))]);
    ++counts_.parted;
    return;
  }
  // two new cubes high above the heap, joined at their faces
  BodyDef a = randomBody();
  a.shape = Shape::box(kHalfLink * Vec3{1, 1, 1});
  a.position.z = 15;
  BodyDef b = a;
  const double arm = 1.2 * kHalfLink;
  const Vec3 along = rotate(a.orientation, Vec3{1, 0, 0});
  b.position = a.position + 2 * arm * along;
  const std::vector<BodyDef> both = {a, b};
  const std::vector<BodyId> ids = world_.addBodies(both);
  alive_.insert(alive_.end(), ids.begin(), ids.end());
  counts_.added += 2;
  JointDef joint;
  joint.type = random_.chance(.5) ? JointType::Ball : JointType::Fixed;
  joint.anchorA = {arm, 0, 0};
  joint.anchorB = {-arm, 0, 0};
  jointed_.insert(jointed_.end(), ids.begin(), ids.end());
  world_.addJoint(joint, ids[0], ids[1]);
  ++counts_.joined;
  joinedNow_ = true;
}

void Soak::edit() {
  const int count = static_cast<int>(alive_.size()), least = options_.bodies / 2,
            most = options_.bodies + options_.bodies / 2;
  const int batch = std::max(1, options_.bodies / 20);
  if (random_.chance(kChurn)) {
    const bool more = count <= least + batch || (count + batch < most && random_.chance(.5));
    if (more)
      addSome(1 + random_.below(batch));
    else
      removeSome(batch);
  }
  if (random_.chance(kDisturb)) disturbSome();
  if (options_.joints && count + 2 < most && random_.chance(kJoints)) changeJoints();
  if (random_.chance(kSort)) {
    world_.sortBodies();
    ++counts_.sorts;
  }
}

void Soak::expect(bool holds, const std::string& what) {
  if (!holds && faults_.size() < kMostFaults)
    faults_.push_back("step " + std::to_string(counts_.steps) + ": " + what);
}

void Soak::check(const StepReport& report) {
  expect(
      report.bodies == static_cast<int>(alive_.size()) + 1,
      std::to_string(report.bodies) + " bodies, where there should be " + std::to_string(alive_.size() + 1));
  expect(report.quarantined == 0, std::to_string(report.quarantined) + " bodies were quarantined");
  expect(report.clashes == 0, std::to_string(report.clashes) + " clashes were left");
  // tables grow only when the scene does
  const std::size_t memory = world_.memoryBytes();
  std::size_t slots = 0;
  for (const BodyId id : alive_) slots = std::max(slots, static_cast<std::size_t>(id.index) + 1);
  const bool reason = !report.grown.empty() || slots > mostSlots_ || joinedNow_;
  expect(memory <= counts_.memory || reason || counts_.steps <= 1,
         "tables grew from " + std::to_string(counts_.memory) + " to " + std::to_string(memory) +
             " bytes for no reason");
  mostSlots_ = std::max(mostSlots_, slots);
  joinedNow_ = false;
  counts_.memory = memory;
  counts_.growths += static_cast<std::int64_t>(report.grown.size());
  counts_.bodies = static_cast<int>(alive_.size());
  counts_.mostBodies = std::max(counts_.mostBodies, counts_.bodies);
}

void Soak::checkStates() {
  ++counts_.reads;
  std::vector<BodyId> expected = alive_;
  expected.push_back(world_.findBody("ground"));
  std::sort(expected.begin(), expected.end(), [](BodyId a, BodyId b) { return a.index < b.index; });
  expect(world_.bodies() == expected, "the bodies are not those that were added and not removed");
  for (const BodyId id : alive_) {
    const BodyState s = world_.state(id);
    const bool finite = std::isfinite(length(s.position)) && std::isfinite(length(s.velocity)) &&
                        std::isfinite(length(s.angularVelocity)) &&
                        std::fabs(s.orientation.s * s.orientation.s + dot(s.orientation.v, s.orientation.v) -
                                  1) < 1e-3;
    expect(finite, "body " + std::to_string(id.index) + " has a state that is none");
    if (!finite) continue;
    expect(length(s.velocity) < kFastest, "body " + std::to_string(id.index) + " flies off at " +
                                              std::to_string(length(s.velocity)) + " m/s");
    expect(s.position.z > -kDeepest, "body " + std::to_string(id.index) + " lies " +
                                         std::to_string(-s.position.z) + " m below the ground");
    expect(length(s.position) < kFarthest, "body " + std::to_string(id.index) + " is lost, " +
                                               std::to_string(length(s.position)) + " m away");
  }
}

void Soak::editAndStep() {
  edit();
  const StepReport report = world_.step();
  ++counts_.steps;
  check(report);
}

void Soak::replay() {
  const Snapshot start = world_.snapshot();
  const Random random = random_;
  const std::vector<BodyId> alive = alive_, jointed = jointed_;
  std::vector<std::uint64_t> first;
  for (int i = 0; i < kReplaySteps; ++i) {
    editAndStep();
    first.push_back(world_.hash());
  }
  world_.restore(start);
  random_ = random;
  alive_ = alive;
  jointed_ = jointed;
  for (int i = 0; i < kReplaySteps; ++i) {
    editAndStep();
    expect(world_.hash() == first[static_cast<std::size_t>(i)],
           "run again from a snapshot, step " + std::to_string(i) + " has other bits");
  }
  ++counts_.replays;
}

void Soak::step() {
  if (random_.chance(kSnapshot)) {
    kept_ = world_.snapshot();
    keptHash_ = world_.hash();
    keptAlive_ = alive_;
    keptJointed_ = jointed_;
    ++counts_.snapshots;
  }
  if (kept_.data && random_.chance(kRestore)) {
    world_.restore(kept_);
    alive_ = keptAlive_;
    jointed_ = keptJointed_;
    ++counts_.restores;
    expect(world_.hash() == keptHash_, "a restored snapshot has other bits");
  }
  if (random_.chance(kReplay)) replay();
  editAndStep();
  if (random_.chance(kLook)) checkStates();
}

}  // namespace rubble::scenes
