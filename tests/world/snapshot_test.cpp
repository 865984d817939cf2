/// Snapshots continue bit for bit.
#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::hashes;
using test::options;

class SnapshotOf : public ::testing::TestWithParam<const char*> {};

TEST_P(SnapshotOf, ContinuesBitForBit) {
  World world(test::heap(3), options(4, GetParam()));
  test::run(world, 40);
  const Snapshot snapshot = world.snapshot();
  const std::uint64_t hash = world.hash();
  const double time = world.time();
  const auto first = hashes(world, 30);
  world.restore(snapshot);
  EXPECT_EQ(world.hash(), hash);
  EXPECT_EQ(world.time(), time);
  EXPECT_EQ(world.stepCount(), 40);
  EXPECT_EQ(hashes(world, 30), first);
}

TEST_P(SnapshotOf, ContinuesInAnotherWorld) {
  World world(test::heap(3), options(4, GetParam()));
  test::run(world, 40);
  const Snapshot snapshot = world.snapshot();
  World other(test::tower(1), options(7, GetParam()));
  test::run(other, 3);
  other.restore(snapshot);
  EXPECT_EQ(other.params().iterations, 4);
  EXPECT_EQ(hashes(other, 30), hashes(world, 30));
}

TEST_P(SnapshotOf, BringsBackRemovedBodiesAndForgetsAddedOnes) {
  Scene scene = test::heap(2);
  scene.bodies[3].name = "third";
  World world(scene, options(4, GetParam()));
  test::run(world, 30);
  const Snapshot snapshot = world.snapshot();
  const auto first = hashes(world, 20);
  world.restore(snapshot);
  const BodyId third = world.findBody("third");
  world.removeBody(third);
  BodyDef sphere = test::body(Shape::sphere(.5), {0, 0, 9});
  for (int i = 0; i < 50; ++i) {
    sphere.position.x = 2. * i;
    world.addBody(sphere);
  }
  world.setGravity({1, 2, 3});
  test::run(world, 10);
  world.restore(snapshot);
  EXPECT_TRUE(world.alive(third));
  EXPECT_EQ(world.findBody("third"), third);
  EXPECT_EQ(world.bodies().size(), scene.bodies.size());
  EXPECT_EQ(world.gravity(), scene.gravity);
  EXPECT_EQ(hashes(world, 20), first);
}

TEST_P(SnapshotOf, HasTheRollingThatAPairRuleGives) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  for (int i = 0; i < 12; ++i) {
    scene.bodies.push_back(test::body(Shape::sphere(0.25), {0.6 * i, 0, 0.25}));
    scene.bodies.back().velocity = {0, 1 + 0.1 * i, 0};
    scene.bodies.back().material.name = "ball";
  }
  scene.bodies[0].material.name = "floor";
  MaterialPair rule{"ball", "floor"};
  rule.rollingFriction = 0.02;
  scene.materialPairs.push_back(rule);
  World world(scene, options(4, GetParam()));
  test::run(world, 10);
  const auto reread = [](const World& from) { return Snapshot::fromBytes(from.snapshot().bytes()); };
  const Snapshot rolling = reread(world);
  // a rule that came or went since the last step
  world.removeMaterialPair("ball", "floor");
  const Snapshot without = reread(world);
  const auto slipping = hashes(world, 10);
  world.setMaterialPair(rule);
  const Snapshot with = reread(world);
  const auto again = hashes(world, 10);
  world.restore(rolling);
  const auto first = hashes(world, 10);
  EXPECT_NE(first, slipping);
  for (const Scene& other : {scene, test::emptyScene()}) {
    World fresh(other, options(4, GetParam()));
    const auto continued = [&](const Snapshot& from) {
      fresh.restore(from);
      return hashes(fresh, 10);
    };
    EXPECT_EQ(continued(without), slipping);
    EXPECT_EQ(continued(rolling), first);
    EXPECT_EQ(continued(with), again);
    fresh.restore(rolling), fresh.removeMaterialPair("ball", "floor");
    EXPECT_EQ(continued(rolling), first);
    EXPECT_EQ(fresh.firstDifference(), "");
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, SnapshotOf, ::testing::Values("cpu", "reference", "lockstep"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Snapshot, ThatIsEmptyThrows) {
  World world(test::tower(1), options());
  EXPECT_THROW(world.restore(Snapshot{}), Error);
}

TEST(WorldHash, DistinguishesStates) {
  World a(test::heap(1), options()), b(test::heap(1), options());
  EXPECT_EQ(a.hash(), b.hash());
  BodyState state = b.state(b.bodyAt(3));
  state.velocity.x += 1e-6;
  b.setState(b.bodyAt(3), state);
  EXPECT_NE(a.hash(), b.hash());
  a.step();
  World c(test::heap(1), options());
  EXPECT_NE(a.hash(), c.hash());
  c.step();
  EXPECT_EQ(a.hash(), c.hash());
}

TEST(WorldHash, SeesForcesThatWait) {
  World a(test::heap(1), options()), b(test::heap(1), options());
  b.applyForce(b.bodyAt(2), {1, 0, 0});
  EXPECT_NE(a.hash(), b.hash());
}

TEST(Snapshot, AJointThatIsMadeAgainAfterARestoreActsAsBefore) {
  Scene scene;
  for (const double x : {0., 1.}) {
    BodyDef body;
    body.shape = Shape::box({.4, .1, .1});
    body.position = {x, 0, 5};
    scene.bodies.push_back(body);
  }
  World world(scene, options(4));
  const std::vector<BodyId> bodies = world.bodies();
  const Snapshot apart = world.snapshot();
  const auto joinedRun = [&] {
    world.restore(apart);
    world.step();
    JointDef joint;
    joint.type = JointType::Ball;
    joint.anchorA = {.5, 0, 0}, joint.anchorB = {-.5, 0, 0};
    world.addJoint(joint, bodies[0], bodies[1]);
    world.applyImpulse(bodies[0], {0, 3, 0});
    for (int n = 0; n < 20; ++n) world.step();
    return world.hash();
  };
  const std::uint64_t first = joinedRun();
  EXPECT_EQ(joinedRun(), first);
}

}  // namespace
}  // namespace rubble
