/// Worlds of a batch have the bits that they have alone.
#include <rubble/worlds.h>

#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::body;
using test::Random;

/// A shape of about that size.
Shape randomShape(Random& random, double size) {
  switch (random.below(6)) {
    case 0:
      return Shape::sphere(size);
    case 1:
      return Shape::capsule(.4 * size, .6 * size);
    case 2:
      return Shape::hull(
          {{size, 0, 0}, {-size, 0, 0}, {0, size, 0}, {0, -size, 0}, {0, 0, size}, {0, 0, -size}});
    case 3:
      return Shape::compound({{Shape::box({size, .3 * size, .3 * size}), {}, {}},
                              {Shape::sphere(.4 * size), {0, 0, .5 * size}, {}}});
    default:
      return Shape::box({size, .7 * size, .5 * size});
  }
}

/// A chain that hangs from the world: hinges with limits, a drive, and a gear-like pulley of springs at
/// times.
void addChain(Scene& scene, Random& random, int links) {
  int last = kWorld;
  const Vec3 top{random.uniform(-1, 1), random.uniform(-1, 1), 2.5};
  for (int i = 0; i < links; ++i) {
    BodyDef link = body(Shape::capsule(.05, .1), top - Vec3{0, 0, .3 * i + .15});
    link.velocity = random.vector(1);
    scene.bodies.push_back(link);
    const int own = static_cast<int>(scene.bodies.size()) - 1;
    const JointType type = random.below(2) == 0 ? JointType::Hinge : JointType::Ball;
    JointDef joint = jointAt(scene, type, own, last, top - Vec3{0, 0, .3 * i});
    if (type == JointType::Hinge) {
      joint.axes[0].min = -.4, joint.axes[0].max = .5;
      if (random.below(2) == 0) joint.axes[0].targetSpeed = 2, joint.axes[0].driveDamping = 3;
    }
    if (random.below(4) == 0) joint.collide = true;
    scene.joints.push_back(joint);
    last = own;
  }
}

void addDeformables(Scene& scene, Random& random) {
  if (random.below(2) == 0) {
    TetSolidDef jelly = tetBox({random.uniform(-1, 0), 0, .6}, {.5, .5, .4}, {2, 2, 2});
    jelly.youngsModulus = 2e4;
    if (random.below(2) == 0) jelly.yieldStress = 500;
    scene.deformables.push_back(jelly);
  }
  if (random.below(2) == 0) {
    ClothDef cloth = clothSheet({-.6, -.6, 1.4}, {1.2, 0, 0}, {0, 1.2, 0}, 5, 5);
    scene.deformables.push_back(cloth);
  }
  if (random.below(2) == 0) scene.deformables.push_back(straightCable({-.5, .2, 1.8}, {.5, .2, 1.8}, 6));
  if (random.below(2) == 0) {
    ParticlesDef grains;
    for (int i = 0; i < 6; ++i) grains.vertices.push_back(Vec3{0, 0, 1} + random.vector(.5));
    scene.deformables.push_back(grains);
  }
  if (!scene.deformables.empty() && random.below(2) == 0) {
    AttachmentDef a;
    a.object = 0;
    a.vertices = {0};
    scene.attachments.push_back(a);
  }
}

/// A small world of nearly anything about the origin.
Scene randomWorld(std::uint64_t seed, int most = 10) {
  Random random(seed);
  Scene scene = test::emptyScene(10 * normalize(Vec3{random.uniform(-.2, .2), 0, -1}) *
                                 random.uniform(.5, 1));
  const int floors = random.below(3);
  if (floors == 0) {
    scene.bodies.push_back(test::ground());
  } else if (floors == 1) {
    BodyDef slab = body(Shape::box({4, 4, .5}), {0, 0, -.5});
    slab.motion = Motion::Static;
    scene.bodies.push_back(slab);
  } else {
    BodyDef mesh = body(
        Shape::mesh({{-4, -4, 0}, {4, -4, .2}, {4, 4, 0}, {-4, 4, .1}}, {{0, 1, 2}, {0, 2, 3}}), {});
    mesh.motion = random.below(2) == 0 ? Motion::Static : Motion::Kinematic;
    if (mesh.motion == Motion::Kinematic) mesh.velocity = {.2, 0, 0};
    scene.bodies.push_back(mesh);
  }
  for (int i = random.below(most); i >= 0; --i) {
    BodyDef def = body(randomShape(random, random.uniform(.15, .4)), Vec3{0, 0, 1.2} + random.vector(1));
    def.orientation = random.rotation();
    def.velocity = random.vector(random.below(5) == 0 ? 30 : 2);
    if (random.below(4) == 0) def.material.restitution = .6;
    if (random.below(6) == 0) def.material.rollingFriction = .02;
    if (random.below(8) == 0) def.material.surfaceVelocity = {.3, 0, 0};
    if (random.below(8) == 0) def.sensor = true;
    if (random.below(8) == 0) def.filter.group = -3;
    if (random.below(8) == 0) def.lockRotation[0] = true;
    scene.bodies.push_back(def);
  }
  if (random.below(2) == 0) addChain(scene, random, 1 + random.below(4));
  if (random.below(2) == 0) addDeformables(scene, random);
  return scene;
}

WorldOptions optionsOf(const std::string& backend = "cpu", int threads = 1) {
  WorldOptions options = test::options(4, backend, threads);
  options.params.sleeping = true;
  options.events = true;
  return options;
}

/// Everything that World tells of its state, as numbers.
std::vector<double> stateOf(const World& world) {
  std::vector<double> out;
  const auto add = [&](const Vec3& v) { out.insert(out.end(), {v.x, v.y, v.z}); };
  for (const BodyId id : world.bodies()) {
    const BodyState s = world.state(id);
    add(s.position), add(s.orientation.v), add(s.velocity), add(s.angularVelocity);
    out.push_back(s.orientation.s), out.push_back(world.asleep(id));
  }
  for (const JointId id : world.joints()) {
    const JointState s = world.state(id);
    add(s.force), add(s.torque);
    for (const JointAxisState& axis : s.axes)
      out.insert(out.end(), {axis.position, axis.speed, axis.limitForce, axis.driveForce});
  }
  for (const DeformableId id : world.deformables())
    for (const std::vector<Vec3>& list : {world.positions(id), world.velocities(id)})
      for (const Vec3& v : list) add(v);
  for (const ContactPoint& c : world.contacts())
    out.push_back(c.a.index), out.push_back(c.b.index), add(c.position), add(c.force);
  for (const VertexContact& c : world.vertexContacts())
    out.push_back(c.vertex), out.push_back(c.body.index), add(c.force);
  for (const SolverState& s : world.solverStates()) out.push_back(s.color);
  out.push_back(static_cast<double>(world.events().contacts.size()));
  out.push_back(static_cast<double>(world.events().sleeps.size()));
  out.push_back(world.time());
  return out;
}

/// The hash of a world in a batch of its own, after each step.
std::vector<std::uint64_t> hashesAlone(const Scene& scene, const WorldOptions& options, int steps) {
  Worlds alone(options);
  alone.add(scene);
  std::vector<std::uint64_t> out;
  for (int k = 0; k < steps; ++k) alone.step(), out.push_back(alone[0].hash());
  return out;
}

struct Batching {
  int worlds, threads, steps;
  const char* backend = "cpu";
};
class BatchOf : public ::testing::TestWithParam<Batching> {};

TEST_P(BatchOf, GivesEachWorldTheBitsThatItHasAlone) {
  const auto [count, threads, steps, backend] = GetParam();
  const int most = count > 100 ? 3 : 10;
  Worlds worlds(optionsOf(backend, threads));
  for (int w = 0; w < count; ++w) ASSERT_EQ(worlds.add(randomWorld(static_cast<std::uint64_t>(w), most)), w);
  worlds.step(steps);
  for (int w = 0; w<count; w += count> 100 ? 13 : 1) {
    const Scene scene = randomWorld(static_cast<std::uint64_t>(w), most);
    World alone(scene, optionsOf(backend));
    test::run(alone, steps);
    ASSERT_EQ(stateOf(worlds[w]), stateOf(alone)) << "world " << w;
    ASSERT_EQ(worlds[w].hash(), hashesAlone(scene, optionsOf(backend), steps).back()) << "world " << w;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, BatchOf,
                         ::testing::Values(Batching{1, 1, 60}, Batching{2, 1, 60}, Batching{7, 3, 60},
                                           Batching{24, 3, 60}, Batching{7, 2, 30, "reference"},
                                           Batching{1000, 3, 20}),
                         [](const auto& info) {
                           return info.param.backend + std::to_string(info.param.worlds) + "Threads" +
                                  std::to_string(info.param.threads);
                         });

TEST(Worlds, StepOnlyThoseOfTheMask) {
  constexpr int kWorlds = 9;
  Worlds worlds(optionsOf("cpu", 3));
  for (int w = 0; w < kWorlds; ++w) worlds.add(randomWorld(100 + static_cast<std::uint64_t>(w)));
  Random random(5);
  std::vector<int> taken(kWorlds, 0);
  for (int k = 0; k < 40; ++k) {
    std::vector<char> active(kWorlds);
    std::vector<std::uint64_t> before;
    for (int w = 0; w < kWorlds; ++w) {
      active[static_cast<std::size_t>(w)] = random.below(3) != 0;
      before.push_back(worlds[w].hash());
    }
    worlds.step(1, active);
    for (std::size_t w = 0; w < kWorlds; ++w) {
      taken[w] += active[w] != 0;
      if (!active[w]) {
        ASSERT_EQ(worlds[static_cast<int>(w)].hash(), before[w]) << "world " << w;
      }
    }
  }
  for (int w = 0; w < kWorlds; ++w) {
    const int steps = taken[static_cast<std::size_t>(w)];
    const Scene scene = randomWorld(100 + static_cast<std::uint64_t>(w));
    EXPECT_EQ(worlds[w].stepCount(), steps);
    EXPECT_EQ(worlds[w].hash(), hashesAlone(scene, optionsOf(), steps).back()) << "world " << w;
  }
}

TEST(Worlds, AThousandResetsTouchNoOtherWorld) {
  constexpr int kWorlds = 40, kRounds = 100, kResets = 10;
  Worlds worlds(optionsOf("cpu", 2));
  std::vector<Snapshot> starts;
  std::vector<std::vector<std::uint64_t>> alone;
  for (int w = 0; w < kWorlds; ++w) {
    const Scene scene = randomWorld(200 + static_cast<std::uint64_t>(w), 5);
    worlds.add(scene);
    alone.push_back(hashesAlone(scene, optionsOf(), kRounds + 2));
  }
  worlds.step();
  for (int w = 0; w < kWorlds; ++w) starts.push_back(worlds[w].snapshot());
  std::vector<std::size_t> age(kWorlds, 0), content(kWorlds);
  std::iota(content.begin(), content.end(), 0);
  Random random(6);
  for (int k = 0; k < kRounds; ++k) {
    // random worlds begin anew, each with the content of a random world
    std::map<int, int> changes;
    while (changes.size() < kResets) changes[random.below(kWorlds)] = random.below(kWorlds);
    std::vector<int> list;
    std::vector<Snapshot> snapshots;
    for (const auto& [at, from] : changes) {
      list.push_back(at), snapshots.push_back(starts[static_cast<std::size_t>(from)]);
      age[static_cast<std::size_t>(at)] = 0,
      content[static_cast<std::size_t>(at)] = static_cast<std::size_t>(from);
    }
    worlds.reset(list, snapshots);
    worlds.step();
    for (std::size_t w = 0; w < kWorlds; ++w)
      ASSERT_EQ(worlds[static_cast<int>(w)].hash(), alone[content[w]][++age[w]])
          << "world " << w << ", round " << k;
  }
}

TEST(Worlds, EditsOfOneWorldAreThoseOfAWorldAlone) {
  Worlds worlds(optionsOf());
  for (int w = 0; w < 3; ++w) worlds.add(randomWorld(300 + static_cast<std::uint64_t>(w)));
  const Scene scene = randomWorld(301);
  World alone(scene, optionsOf());
  const auto edit = [](World& world, int k) {
    BodyDef box = body(Shape::box({.2, .2, .2}), {.1 * k, 0, 3. + k});
    const BodyId added = world.addBody(box);
    world.applyImpulse(added, {0, 1, 0});
    if (k == 1) world.addDeformable(clothSheet({-.6, -.6, 2.4}, {1.2, 0, 0}, {0, 1.2, 0}, 4, 4));
    if (k == 2) world.removeBody(world.bodies()[1]), world.setGravity({1, 0, -5});
  };
  for (int k = 0; k < 4; ++k) {
    edit(worlds[1], k), edit(alone, k);
    worlds.step(10), test::run(alone, 10);
    ASSERT_EQ(stateOf(worlds[1]), stateOf(alone)) << "after edit " << k;
  }
  std::vector<RayQuery> rays;
  Random random(1);
  for (int k = 0; k < 50; ++k) rays.push_back({random.vector(3), random.direction(), 10., {}});
  const auto inBatch = worlds[1].castRays(rays), own = alone.castRays(rays);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    EXPECT_EQ(inBatch[k].hit, own[k].hit);
    EXPECT_EQ(inBatch[k].body, own[k].body);
    EXPECT_EQ(inBatch[k].position, own[k].position);
  }
}

TEST(Worlds, ArraysHaveOneRowPerBodyOfEachWorld) {
  Worlds worlds(optionsOf());
  EXPECT_EQ(worlds.addCopies(test::heap(1), 5), 0);
  worlds.step(3);
  const ArrayView view = worlds.array(StateArray::Position);
  ASSERT_EQ(view.shape[0], 5 * 17);
  for (int w = 0; w < 5; ++w)
    for (const BodyId id : worlds[w].bodies()) {
      const auto row = worlds.rowsOf(w)[static_cast<std::size_t>(id.index)];
      EXPECT_EQ(row, worlds.firstRow(w) + id.index);
      const auto* x = reinterpret_cast<const double*>(static_cast<const char*>(view.data) +
                                                      row * view.strides[0]);
      EXPECT_EQ(worlds[w].state(id).position, (Vec3{x[0], x[1], x[2]}));
    }
}

TEST(Worlds, RefuseWhatOneOfManyCannotDo) {
  Worlds worlds(optionsOf());
  worlds.addCopies(test::tower(1), 2);
  World other(test::tower(1), optionsOf());
  EXPECT_THROW(worlds[2], Error);
  EXPECT_THROW(worlds.step(1, std::vector<char>(1)), Error);
  EXPECT_THROW(worlds[0].restore(other.snapshot()), Error);
  Params params = worlds.params();
  params.iterations = 7;
  EXPECT_THROW(worlds[0].setParams(params), Error);
  worlds.setParams(params);
  EXPECT_EQ(worlds[1].params().iterations, 7);
  WorldOptions lockstep = optionsOf("lockstep");
  EXPECT_THROW(Worlds{lockstep}, Error);
}

}  // namespace
}  // namespace rubble
