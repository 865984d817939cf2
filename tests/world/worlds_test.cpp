/// Worlds of a batch have the bits that they have alone. Arrays of joints and sensors, and definitions of
/// bodies that change.
#include "tests/support/array_claims.h"

namespace rubble {
namespace {

using test::body;
using test::RandomWorlds;
using test::worldsOptions;

struct Batching {
  int worlds, threads, steps;
  const char* backend = "cpu";
};
class BatchOf : public ::testing::TestWithParam<Batching> {};

TEST_P(BatchOf, GivesEachWorldTheBitsThatItHasAlone) {
  const auto [count, threads, steps, backend] = GetParam();
  const bool many = count > 100;
  test::expectBitsAlone({0, many ? 3 : 10}, count, worldsOptions(backend, threads), steps, many ? 13 : 1);
}

INSTANTIATE_TEST_SUITE_P(Sizes, BatchOf,
                         ::testing::Values(Batching{1, 1, 60}, Batching{2, 1, 60}, Batching{7, 3, 60},
                                           Batching{24, 3, 60}, Batching{7, 2, 30, "reference"},
                                           Batching{1000, 3, 20}),
                         [](const auto& info) {
                           return info.param.backend + std::to_string(info.param.worlds) + "Threads" +
                                  std::to_string(info.param.threads);
                         });

/// Of three hundred worlds in one grid many share its buckets, in which points count a partner twice.
TEST(Worlds, HaveTheBitsThatTheyHaveAloneWhereOthersShareTheirBuckets) {
  test::expectBitsAlone({0, 5}, 300, worldsOptions("cpu", 2), 2);
}

/// On a host a batch has no order of sums of its own.
TEST(Worlds, HaveTheBitsOfWorldsOutsideOfBatches) {
  Worlds worlds(worldsOptions("cpu", 3));
  const RandomWorlds random;
  for (int w = 0; w < 12; ++w) worlds.add(random.scene(w));
  worlds.step(40);
  for (int w = 0; w < 12; ++w) {
    World alone(random.scene(w), worldsOptions());
    test::run(alone, 40);
    ASSERT_EQ(test::stateOf(worlds[w]), test::stateOf(alone)) << "world " << w;
  }
}

TEST(Worlds, StepOnlyThoseOfTheMask) { test::expectMasks({100}, worldsOptions("cpu", 3), 9, 40); }

TEST(Worlds, AThousandResetsTouchNoOtherWorld) {
  test::expectResets({200, 5}, worldsOptions("cpu", 2), 40, 100, 10);
}

TEST(Worlds, EditsOfOneWorldAreThoseOfAWorldAlone) { test::expectEditsAlone({300}, worldsOptions()); }

/// Both engines of a pair find the same after each kernel, with masks and resets.
TEST(Worlds, WithScriptsHaveTheReportOfTheLastStep) {
  Worlds plain(worldsOptions("cpu", 2)), scripted(worldsOptions("cpu", 2));
  for (int w = 0; w < 40; ++w) {
    Scene scene = test::tower(2);
    plain.add(scene);
    // events that change nothing, in two batches
    for (const int step : {2, 5, 6, 300}) scene.events.emplace_back().step = step + w % 2;
    scripted.add(w % 3 == 0 ? scene : test::tower(2));
  }
  std::vector<char> active(40, 1);
  active[3] = active[26] = 0;
  for (const int steps : {4, 0, 1, 9}) {
    const WorldsReport expected = plain.step(steps, active), report = scripted.step(steps, active);
    EXPECT_EQ(report.bodies, expected.bodies);
    EXPECT_EQ(report.pairs, expected.pairs);
    EXPECT_EQ(report.contacts, expected.contacts);
    EXPECT_EQ(report.colors, expected.colors);
    for (const int w : {0, 3, 13, 33, 39}) {
      EXPECT_EQ(scripted[w].stepCount(), plain[w].stepCount());
      EXPECT_EQ(test::stateOf(scripted[w]), test::stateOf(plain[w]));
    }
  }
  // and one that does something takes place before its step
  Scene scene = test::tower(2);
  scene.bodies[1].name = "first";
  Event kick;
  kick.step = 3, kick.setVelocity = {{"first", {0, 0, 9}, {}}};
  scene.events = {kick};
  World alone(scene, worldsOptions());
  const int w = plain.add(scene);
  plain.step(8);
  test::run(alone, 8);
  EXPECT_EQ(test::stateOf(plain[w]), test::stateOf(alone));
}

/// A call of several steps is as many calls: the same bits, time, breaks and report as after the last one.
TEST(Worlds, TakeSeveralStepsAsOneByOne) {
  // weights on joints that break after different numbers of steps
  const auto hanging = [](double mass) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::unitCube({0, 0, 0}));
    scene.bodies.back().mass = mass;
    JointDef joint;
    joint.bodyA = 0, joint.breakForce = 3000;
    scene.joints = {joint};
    return scene;
  };
  for (const bool events : {false, true}) {
    WorldOptions options = worldsOptions("cpu", 2);
    options.events = events;
    Worlds together(options), single(options);
    for (int w = 0; w < 40; ++w)
      for (Worlds* const worlds : {&together, &single}) worlds->add(hanging(200 + 10 * w));
    int breaks = 0;
    for (const int steps : {1, 4, 2, 7, 3}) {
      const WorldsReport all = together.step(steps);
      WorldsReport last;
      for (int k = 0; k < steps; ++k) last = single.step();
      breaks += static_cast<int>(last.broken.size());
      EXPECT_EQ(all.broken, last.broken);
      EXPECT_EQ(all.brokenIn, last.brokenIn);
      EXPECT_EQ(all.contacts, last.contacts);
      for (int w = 0; w < 40; ++w) {
        ASSERT_EQ(together[w].hash(), single[w].hash()) << w;
        EXPECT_EQ(together[w].time(), single[w].time()) << w;
        EXPECT_EQ(together[w].stepCount(), single[w].stepCount()) << w;
        EXPECT_EQ(together[w].state(together[w].joints()[0]).broken,
                  single[w].state(single[w].joints()[0]).broken);
        EXPECT_EQ(together[w].events().joints.size(), single[w].events().joints.size()) << w;
      }
    }
    EXPECT_GT(breaks, 0);
  }
}

TEST(Worlds, AgreeInLockstep) {
  Worlds worlds(worldsOptions("lockstep"));
  const RandomWorlds random{400, 5};
  for (int w = 0; w < 3; ++w) worlds.add(random.scene(w));
  const Snapshot start = worlds[2].snapshot();
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(worlds.step(1, std::vector<char>{1, k % 2 == 0, 1}).difference, "");
    if (k == 3) worlds.reset(std::vector<int>{0}, {&start, 1});
  }
}

/// New parameters wake all bodies of a world in its next step, also if it is left out of the first one.
TEST(Worlds, WakeByNewParametersInTheirOwnNextStep) {
  Worlds worlds(worldsOptions());
  worlds.addCopies(test::tower(2), 2);
  worlds.step(300);
  const BodyId top = worlds[0].bodyAt(2);
  ASSERT_TRUE(worlds[0].asleep(top) && worlds[1].asleep(top));
  Params params = worlds.params();
  params.iterations = 7;
  worlds.setParams(params);
  worlds.step(1, std::vector<char>{1, 0});
  EXPECT_TRUE(!worlds[0].asleep(top) && worlds[1].asleep(top));
  worlds.step(1, std::vector<char>{0, 1});
  EXPECT_FALSE(worlds[1].asleep(top));
  EXPECT_EQ(worlds[0].hash(), worlds[1].hash());
}

TEST(Worlds, ArraysHaveOneRowPerBodyOfEachWorld) {
  Worlds worlds(worldsOptions());
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
  Worlds worlds(worldsOptions());
  worlds.addCopies(test::tower(1), 2);
  World other(test::tower(1), worldsOptions());
  EXPECT_THROW(worlds[2], Error);
  EXPECT_THROW(worlds.step(1, std::vector<char>(1)), Error);
  EXPECT_THROW(worlds[0].restore(other.snapshot()), Error);
  Params params = worlds.params();
  params.iterations = 7;
  EXPECT_THROW(worlds[0].setParams(params), Error);
  worlds.setParams(params);
  EXPECT_EQ(worlds[1].params().iterations, 7);
}

TEST(Arrays, TellWhatJointsAndBodiesTell) {
  for (const char* backend : {"cpu", "reference", "lockstep"})
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      World world(test::randomWorld(600 + seed), test::worldsOptions(backend));
      test::run(world, 15);
      test::expectArraysOfWorld(world, test::copyOfHost);
    }
}

/// A six-dof joint counts turns about the axis that is free, which may be another one in the engine.
TEST(Arrays, HaveTheAxesOfJointsWithSeveral) {
  Scene scene = test::emptyScene({3, 2, -10});
  for (int i = 0; i < 6; ++i) scene.bodies.push_back(body(Shape::box({0.1, 0.2, 0.3}), {2. * i, 0, -0.5}));
  for (int i = 0; i < 3; ++i) {
    JointDef joint = jointAt(scene, JointType::SixDof, i, kWorld, {2. * i, 0, 0});
    for (int axis = 0; axis < 6; ++axis)
      if (axis != 3 + i)
        joint.axes[static_cast<std::size_t>(axis)].min = 0,
        joint.axes[static_cast<std::size_t>(axis)].max = 0;
    scene.joints.push_back(joint);
  }
  scene.joints.push_back(jointAt(scene, JointType::SwingTwist, 3, kWorld, {6, 0, 0}));
  scene.joints.push_back(jointAt(scene, JointType::Slider, 4, kWorld, {8, 0, 0}));
  scene.joints.push_back(jointAt(scene, JointType::Universal, 5, kWorld, {10, 0, 0}));
  World world(scene, test::worldsOptions());
  test::run(world, 20);
  test::expectArraysOfWorld(world, test::copyOfHost);
}

TEST(Arrays, OfManyWorldsAreThoseOfEach) {
  test::expectArraysOfWorlds({620, 4}, test::worldsOptions("cpu", 2), 34, test::copyOfHost);
}

TEST(Arrays, VerticesOfManyWorldsAreThoseOfEachAlone) {
  test::expectVertexArrays(test::worldsOptions("cpu", 2), 35, test::copyOfHost);
  test::expectVertexArrays(test::worldsOptions("reference"), 4, test::copyOfHost);
}

TEST(Arrays, ForcesAlongAxesActOnBothBodies) { test::expectForcesAlongAxes(test::worldsOptions()); }

TEST(Arrays, AccelerometersShowGravityAtRest) {
  test::expectAccelerations(test::worldsOptions(), test::copyOfHost);
}

TEST(Arrays, RaysInManyWorldsHitWhatThoseOfEachHit) {
  test::expectRays({640, 5}, test::worldsOptions("cpu", 2), 35);
}

TEST(Arrays, RaysInManyWorldsHitDeformableObjectsThatTheyAskFor) {
  Worlds worlds(test::worldsOptions("cpu", 2));
  for (int w = 0; w < 3; ++w) {
    Scene scene = test::tower(1);
    if (w > 0) scene.deformables.emplace_back(clothSheet({-1, -1, 1. + w}, {2, 0, 0}, {0, 2, 0}, 2, 2));
    worlds.add(scene);
  }
  std::vector<Worlds::WorldRay> rays;
  for (int w = 0; w < 3; ++w)
    for (const bool deformables : {true, false}) {
      rays.push_back({w, {{.1, .2, 9}, {0, 0, -1}, 20, {}}});
      rays.back().ray.filter.deformables = deformables;
    }
  const std::vector<RayHit> hits = worlds.castRays(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const RayHit own = worlds[rays[i].world].castRay(rays[i].ray);
    EXPECT_EQ(hits[i].body, own.body) << i;
    EXPECT_EQ(hits[i].object, own.object) << i;
    EXPECT_EQ(hits[i].distance, own.distance) << i;
    EXPECT_EQ(hits[i].object != DeformableId{}, rays[i].world > 0 && rays[i].ray.filter.deformables) << i;
  }
}

/// Rows follow joints that are added, removed or restored.
TEST(Arrays, RowsAreThoseOfThePresentJoints) {
  Scene chain = test::emptyScene();
  test::Random random(7);
  test::addChain(chain, random, 6);
  Worlds worlds(test::worldsOptions());
  worlds.addCopies(chain, 3);
  const Snapshot start = worlds[1].snapshot();
  World& world = worlds[1];
  const auto rows = [&] { return worlds.array(JointArray::Position).shape[0]; };
  const std::int64_t before = rows(), each = before / 3;
  const BodyId extra = world.addBody(body(Shape::sphere(0.1), {5, 5, 5}));
  JointDef slider;
  slider.type = JointType::Slider;
  slider.anchorB = {5, 5, 5};
  slider.axes[0].min = 0, slider.axes[0].max = 0.25;
  const JointId added = world.addJoint(slider, extra, {});
  EXPECT_EQ(rows(), before + 1);
  EXPECT_EQ(world.axes().back().joint, added);
  const std::vector<double> upper = test::copyOfHost(worlds.array(JointArray::UpperLimit));
  EXPECT_EQ(upper[static_cast<std::size_t>(2 * each)], 0.25);
  worlds.reset(std::vector<int>{1}, {&start, 1});
  EXPECT_EQ(rows(), before);
  world.removeJoint(world.axes()[0].joint);
  EXPECT_LT(rows(), before);
  EXPECT_THROW(worlds.array(JointArray::AppliedForce), Error);
  const test::HostRows one{{0}, {0.5}};
  EXPECT_THROW(worlds.scatter(JointArray::Position, one.rowView(), one.valueView()), Error);
}

/// A definition that changes before the first step gives the bits of a world that has it from the start.
TEST(SetDefinition, GivesTheWorldThatHasItFromTheStart) {
  for (const char* backend : {"cpu", "reference", "lockstep"}) {
    Scene scene = test::emptyScene({0, 0, -10});
    scene.bodies.push_back(test::ground());
    scene.bodies.push_back(body(Shape::box({0.5, 0.4, 0.3}), {0, 0, 1}));
    scene.bodies[1].velocity = {1, 0, 0};
    World changed(scene, test::worldsOptions(backend));
    BodyDef def = scene.bodies[1];
    def.shape = Shape::sphere(0.45), def.mass = 7, def.material.dynamicFriction = 0.1;
    def.linearDamping = 0.5, def.lockRotation[1] = true, def.position = {99, 99, 99};
    changed.setDefinition(changed.bodyAt(1), def);
    EXPECT_EQ(changed.massOf(changed.bodyAt(1)).mass, 7);
    def.position = scene.bodies[1].position;
    scene.bodies[1] = def;
    World wanted(scene, test::worldsOptions(backend));
    test::run(changed, 60), test::run(wanted, 60);
    EXPECT_EQ(test::stateOf(changed), test::stateOf(wanted)) << backend;
  }
}

TEST(SetDefinition, KeepsPosesAndJointsWhereTheCenterOfMassMoves) {
  Scene scene = test::emptyScene({0, 0, -10});
  scene.bodies.push_back(body(Shape::box({0.1, 0.1, 0.5}), {0, 0, -0.5}));
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 0, kWorld, {0, 0, 0}));
  World world(scene, test::worldsOptions());
  test::run(world, 10);
  const BodyId id = world.bodyAt(0);
  const BodyState before = world.state(id);
  BodyDef def = world.definition(id);
  def.shape = Shape::compound({{def.shape, {}, {}}, {Shape::box({0.3, 0.1, 0.1}), {0, 0.3, -0.4}, {}}});
  world.setDefinition(id, def);
  EXPECT_LT(length(world.state(id).position - before.position), 1e-6);
  test::run(world, 60);
  EXPECT_LT(world.state(world.joints()[0]).gap, 1e-3);
  EXPECT_GT(std::fabs(world.state(world.joints()[0]).axes[0].position), 0.05) << "it hangs askew";
}

}  // namespace
}  // namespace rubble
