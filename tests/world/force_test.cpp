/// Forces, torques, impulses, states and targets.
#include <gtest/gtest.h>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::kDt;
using test::options;

Scene freeBody() {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::unitCube({1, 2, 3}));
  return scene;
}

TEST(WorldForce, ActsForOneStepAndExactly) {
  World world(freeBody(), options(1, "reference"));
  const BodyId id = world.bodyAt(0);
  world.applyForce(id, {6, 0, 0});
  world.applyForce(id, {0, -12, 0});
  world.step();
  EXPECT_TRUE(test::near(world.state(id).velocity, Vec3{.1, -.2, 0}, 1e-14));
  EXPECT_TRUE(test::near(world.state(id).position, Vec3{1 + .1 * kDt, 2 - .2 * kDt, 3}, 1e-14));
  world.step();
  EXPECT_TRUE(test::near(world.state(id).velocity, Vec3{.1, -.2, 0}, 1e-13));
}

TEST(WorldForce, ActsThroughAllSubstepsOfItsStep) {
  for (const char* backend : {"reference", "cpu", "lockstep"}) {
    WorldOptions with = options(1, backend);
    with.params.substeps = 4;
    World world(freeBody(), with);
    const BodyId id = world.bodyAt(0);
    world.applyForce(id, {6, -12, 0});
    world.applyTorque(id, {0, 0, 2});
    world.step();
    EXPECT_TRUE(test::near(world.state(id).velocity, Vec3{.1, -.2, 0}, 1e-6)) << backend;
    EXPECT_TRUE(test::near(world.state(id).angularVelocity, Vec3{0, 0, 2 * 6 * kDt}, 1e-5)) << backend;
    world.step();
    EXPECT_TRUE(test::near(world.state(id).velocity, Vec3{.1, -.2, 0}, 1e-6)) << backend;
  }
}

/// Rows that held its weight are still stiff and release it only once it moves away.
TEST(WorldForce, LiftsABodyAtRestAtOnce) {
  for (const int iterations : {1, 4, 10, 200}) {
    World world(test::tower(1), options(iterations));
    test::run(world, 90);
    world.applyForce(world.bodyAt(1), {0, 0, 70});
    world.step();
    EXPECT_NEAR(world.state(world.bodyAt(1)).velocity.z, 60 * kDt, .2) << iterations;
  }
}

/// A sudden push against what holds a body, or one that stays, drives it no deeper.
TEST(WorldForce, PressesABodyOnItsSupport) {
  for (const int steps : {1, 30}) {
    World world(test::tower(2), options(4));
    test::run(world, 90);
    const double before = world.state(world.bodyAt(2)).position.z;
    for (int i = 0; i < steps; ++i) {
      world.applyForce(world.bodyAt(2), {0, 0, -500});
      world.step();
      EXPECT_GT(world.state(world.bodyAt(2)).position.z, before - .01) << i;
    }
    test::run(world, 30);
    EXPECT_NEAR(world.state(world.bodyAt(2)).position.z, before, 2e-3);
  }
}

TEST(WorldForce, TorqueTurnsAFreeBodyByItsInertia) {
  World world(freeBody(), options(1, "reference"));
  const BodyId id = world.bodyAt(0);
  world.applyTorque(id, {0, 0, 2});
  world.step();
  // a torque is no part of the guess: one Newton step leaves an error of third order in the turn
  EXPECT_TRUE(test::near(world.state(id).angularVelocity, Vec3{0, 0, 2 * 6 * kDt}, 1e-6));
  EXPECT_TRUE(
      test::sameRotation(world.state(id).orientation, fromAxisAngle(Vec3{0, 0, 1}, 12 * kDt * kDt), 1e-7));
  world.step();
  // a torque is no part of the guess: one Newton step leaves an error of third order in the turn
  EXPECT_TRUE(test::near(world.state(id).angularVelocity, Vec3{0, 0, 2 * 6 * kDt}, 1e-6));
}

TEST(WorldForce, AtAPointIsForceAndMoment) {
  World at(freeBody(), options(1, "reference")), split(freeBody(), options(1, "reference"));
  at.applyForceAt(at.bodyAt(0), {0, 3, 0}, {1.5, 2, 3});
  split.applyForce(split.bodyAt(0), {0, 3, 0});
  split.applyTorque(split.bodyAt(0), {0, 0, 1.5});
  at.step(), split.step();
  EXPECT_EQ(at.hash(), split.hash());
  EXPECT_GT(at.state(at.bodyAt(0)).angularVelocity.z, .1);
}

TEST(WorldForce, ImpulseChangesTheVelocityAtOnce) {
  World world(freeBody(), options(1, "reference"));
  const BodyId id = world.bodyAt(0);
  world.applyImpulse(id, {2, 0, 0});
  EXPECT_TRUE(test::near(world.state(id).velocity, Vec3{2, 0, 0}, 1e-15));
  world.step();
  EXPECT_TRUE(test::near(world.state(id).position, Vec3{1 + 2 * kDt, 2, 3}, 1e-14));
}

TEST(WorldForce, DoesNotMoveStaticBodies) {
  World world(test::tower(1), options());
  world.applyForce(world.bodyAt(0), {100, 0, 0});
  world.applyImpulse(world.bodyAt(0), {100, 0, 0});
  test::run(world, 3);
  EXPECT_EQ(world.state(world.bodyAt(0)).position, (Vec3{0, 0, 0}));
}

TEST(WorldForce, AgainstFrictionMovesACubeOnlyBeyondTheCone) {
  World world(test::tower(1), options(20, "reference"));
  const BodyId id = world.bodyAt(1);
  test::run(world, 30);
  for (int i = 0; i < 120; ++i) {
    world.applyForceAt(id, {5.8, 0, 0}, world.state(id).position - Vec3{0, 0, .4});
    world.step();
  }
  EXPECT_LT(world.state(id).position.x, 1e-3);
  for (int i = 0; i < 60; ++i) {
    world.applyForceAt(id, {7, 0, 0}, world.state(id).position - Vec3{0, 0, .4});
    world.step();
  }
  // (7 - 6) N for 1 s
  EXPECT_NEAR(world.state(id).velocity.x, 1, .05);
}

TEST(WorldGravity, CanBeChangedAndScaled) {
  Scene scene = freeBody();
  scene.gravity = {0, 0, -10};
  scene.bodies[0].gravityScale = .5;
  World world(scene, options(1, "reference"));
  world.step();
  EXPECT_NEAR(world.state(world.bodyAt(0)).velocity.z, -5 * kDt, 1e-14);
  world.setGravity({10, 0, 0});
  EXPECT_EQ(world.gravity(), (Vec3{10, 0, 0}));
  world.step();
  EXPECT_TRUE(test::near(world.state(world.bodyAt(0)).velocity, Vec3{5 * kDt, 0, -5 * kDt}, 1e-13));
}

TEST(WorldTarget, AKinematicBodyIsWhereItWasSent) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  scene.bodies[0].motion = Motion::Kinematic;
  World world(scene, options(1, "reference"));
  const BodyId id = world.bodyAt(0);
  const Quat turn = fromAxisAngle(normalize(Vec3{1, 2, 3}), 1.2);
  world.setTarget(id, {.3, -.4, .5}, turn);
  world.step();
  EXPECT_TRUE(test::near(world.state(id).position, Vec3{.3, -.4, .5}, 1e-12));
  EXPECT_TRUE(test::sameRotation(world.state(id).orientation, turn, 1e-7));
}

TEST(WorldTarget, IsForKinematicBodiesOnly) {
  World world(test::tower(1), options());
  EXPECT_THROW(world.setTarget(world.bodyAt(0), {}, {}), Error);
  EXPECT_THROW(world.setTarget(world.bodyAt(1), {}, {}), Error);
}

TEST(WorldTarget, AKinematicPlatformCarriesABoxByFriction) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::body(Shape::box({5, 5, .5}), {0, 0, -.5}));
  scene.bodies[0].motion = Motion::Kinematic;
  scene.bodies.push_back(test::unitCube({0, 0, .5}));
  World world(scene, options(10, "reference"));
  const BodyId platform = world.bodyAt(0), box = world.bodyAt(1);
  // up to 1 m/s in 0.5 s, then steadily: 2 m/s2 is below mu g = 6
  double x = 0;
  for (int i = 0; i < 120; ++i) {
    x += std::min(1., 2 * kDt * (i + 1)) * kDt;
    world.setTarget(platform, {x, 0, -.5}, {});
    world.step();
  }
  EXPECT_NEAR(world.state(platform).position.x, x, 1e-9);
  EXPECT_NEAR(world.state(box).position.x, x, .01);
  EXPECT_NEAR(world.state(box).velocity.x, 1, .01);
  EXPECT_NEAR(world.state(box).position.z, .5, .005);
}

TEST(WorldTarget, AKinematicLiftRaisesABox) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::body(Shape::box({5, 5, .5}), {0, 0, -.5}));
  scene.bodies[0].motion = Motion::Kinematic;
  scene.bodies[0].velocity = {0, 0, 1};
  scene.bodies.push_back(test::unitCube({0, 0, .5}));
  World world(scene, options(10, "reference"));
  test::run(world, 60);
  EXPECT_NEAR(world.state(world.bodyAt(0)).position.z, .5, 1e-9);
  EXPECT_NEAR(world.state(world.bodyAt(1)).position.z, 1.5, .02);
  EXPECT_NEAR(world.state(world.bodyAt(1)).velocity.z, 1, .01);
}

TEST(WorldState, CanBeWrittenAndIsReadBack) {
  World world(freeBody(), options(1, "reference"));
  const BodyId id = world.bodyAt(0);
  const BodyState state{{5, 6, 7}, fromAxisAngle(Vec3{0, 1, 0}, .3), {1, 0, 0}, {0, 2, 0}};
  world.setState(id, state);
  const BodyState back = world.state(id);
  EXPECT_EQ(back.position, state.position);
  EXPECT_TRUE(test::sameRotation(back.orientation, state.orientation, 1e-7));
  EXPECT_EQ(back.velocity, state.velocity);
  EXPECT_EQ(back.angularVelocity, state.angularVelocity);
  world.step();
  EXPECT_TRUE(test::near(world.state(id).position, Vec3{5 + kDt, 6, 7}, 1e-13));
}

TEST(WorldState, PositionsKeepDoublePrecisionFarFromTheOrigin) {
  Scene scene = test::emptyScene();
  const Vec3 far{1e6, -2e6, 0};
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::unitCube(far + Vec3{0, 0, 1}));
  World world(scene, options(10));
  test::run(world, 120);
  EXPECT_NEAR(world.state(world.bodyAt(1)).position.z, .5, .005);
  EXPECT_NEAR(world.state(world.bodyAt(1)).position.x, 1e6, 1e-3);
}

}  // namespace
}  // namespace rubble
