/// Sleeping islands.
#include <gtest/gtest.h>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

WorldOptions sleepy(const std::string& backend = "cpu", int threads = 1) {
  WorldOptions options = test::options(4, backend, threads);
  options.params.sleeping = true;
  options.events = true;
  return options;
}

/// Two towers of three cubes that are far apart.
Scene towers() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  for (const double x : {0., 10.})
    for (int i = 0; i < 3; ++i) scene.bodies.push_back(test::unitCube({x, 0, .5 + i}));
  return scene;
}

World settled() {
  World world(towers(), sleepy());
  test::run(world, 120);
  return world;
}

TEST(Sleep, ATowerSleepsAndCostsNoRows) {
  World world = settled();
  const StepReport report = world.step();
  EXPECT_EQ(report.sleepingBodies, 6);
  EXPECT_EQ(report.manifolds, 0);
  EXPECT_GT(report.pairs, 0);
  for (int i = 1; i <= 6; ++i) EXPECT_TRUE(world.asleep(world.bodyAt(i)));
  EXPECT_FALSE(world.asleep(world.bodyAt(0)));
}

TEST(Sleep, IsOffByDefault) {
  World world(towers(), test::options(4));
  test::run(world, 120);
  EXPECT_EQ(world.step().sleepingBodies, 0);
}

TEST(Sleep, ChangesNoHeightAndKeepsTheForces) {
  World world = settled(), awake(towers(), test::options(4));
  test::run(world, 120);
  test::run(awake, 240);
  for (int i = 1; i <= 6; ++i)
    EXPECT_TRUE(
        test::near(world.state(world.bodyAt(i)).position, awake.state(awake.bodyAt(i)).position, 2e-3))
        << i;
  EXPECT_NEAR(world.contactLoad(world.bodyAt(0)).force.z, -60, 3);
}

TEST(Sleep, AHitWakesItsIslandAlone) {
  World world = settled();
  BodyDef ball = test::body(Shape::sphere(.3), {-4, 0, 1.5});
  ball.velocity = {8, 0, 2};
  world.addBody(ball);
  double far = 0;
  int woken = 0;
  for (int i = 0; i < 60; ++i) {
    world.step();
    for (const SleepEvent& e : world.events().sleeps) woken += !e.asleep;
    far = std::max(far, length(world.state(world.bodyAt(2)).position - Vec3{0, 0, 1.5}));
    EXPECT_TRUE(world.asleep(world.bodyAt(4)));
  }
  EXPECT_EQ(woken, 3);
  EXPECT_GT(far, .02);
}

TEST(Sleep, EndsWhenTheSupportGoes) {
  World world = settled();
  world.removeBody(world.bodyAt(1));
  test::run(world, 20);
  // free fall of 20 steps of 1/60 s at 10 m/s2: 0.583 m
  EXPECT_LT(world.state(world.bodyAt(3)).position.z, 2.5 - .5);
  EXPECT_TRUE(world.asleep(world.bodyAt(4)));
}

TEST(Sleep, EndsWhenTheGroundGoes) {
  World world = settled();
  world.removeBody(world.bodyAt(0));
  test::run(world, 20);
  for (int i = 1; i <= 6; ++i) EXPECT_LT(world.state(world.bodyAt(i)).velocity.z, -2.5) << i;
}

TEST(Sleep, EndsByForceStateGravityAndWish) {
  const auto wakes = [](auto&& act) {
    World world = settled();
    act(world);
    world.step();
    return std::pair(!world.asleep(world.bodyAt(2)), !world.asleep(world.bodyAt(5)));
  };
  const std::pair own(true, false), both(true, true);
  EXPECT_EQ(wakes([](World& w) { w.applyForce(w.bodyAt(1), {0, 0, 1}); }), own);
  EXPECT_EQ(wakes([](World& w) { w.applyImpulse(w.bodyAt(3), {.1, 0, 0}); }), own);
  EXPECT_EQ(wakes([](World& w) { w.wake(w.bodyAt(2)); }), own);
  EXPECT_EQ(wakes([](World& w) { w.addJoint(test::ball(0, {}, 0, {0, 0, 3}), {}, w.bodyAt(3)); }), own);
  EXPECT_EQ(wakes([](World& w) { w.setGravity({1, 0, -10}); }), both);
  EXPECT_EQ(wakes([](World&) {}), std::pair(false, false));
}

TEST(Sleep, NothingSleepsOnAMovingConveyor) {
  Scene scene = test::emptyScene();
  BodyDef conveyor = test::body(Shape::box({50, 2, .1}), {0, 0, -.1});
  conveyor.motion = Motion::Kinematic;
  conveyor.velocity = {.01, 0, 0};
  scene.bodies.push_back(conveyor);
  scene.bodies.push_back(test::unitCube({0, 0, .5}));
  World world(scene, sleepy());
  test::run(world, 180);
  EXPECT_FALSE(world.asleep(world.bodyAt(1)));
  EXPECT_NEAR(world.state(world.bodyAt(1)).position.x, .03, 3e-3);
}

TEST(Sleep, IsTheSameAtAnyNumberOfThreadsAndInASnapshot) {
  World lockstep(test::heap(3), sleepy("lockstep", 3)), cpu(test::heap(3), sleepy("cpu", 1));
  for (int i = 0; i < 400; ++i) {
    lockstep.step(), cpu.step();
    ASSERT_EQ(lockstep.firstDifference(), "") << i;
  }
  EXPECT_EQ(lockstep.hash(), cpu.hash());
  World world = settled();
  const Snapshot snapshot = world.snapshot();
  world.applyImpulse(world.bodyAt(3), {3, 0, 0});
  test::run(world, 30);
  world.restore(snapshot);
  EXPECT_EQ(world.step().sleepingBodies, 6);
}

}  // namespace
}  // namespace rubble
