/// Per-body damping, locked axes, inertia and filters, in closed form.
#include <gtest/gtest.h>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

TEST(BodyDamping, IsExponentialAtAnyTimeStep) {
  for (const double dt : {1. / 30, 1. / 60, 1. / 240}) {
    Scene scene = test::emptyScene({0, 0, 0});
    BodyDef def = test::unitCube({});
    def.velocity = {3, 0, 0}, def.angularVelocity = {0, 2, 0};
    def.linearDamping = .8, def.angularDamping = 1.5;
    scene.bodies.push_back(def);
    WorldOptions options = test::options(4, "reference");
    options.params.dt = dt;
    World world(scene, options);
    test::run(world, static_cast<int>(2 / dt + .5));
    EXPECT_NEAR(world.state(world.bodyAt(0)).velocity.x, 3 * std::exp(-1.6), 1e-9);
    EXPECT_NEAR(world.state(world.bodyAt(0)).angularVelocity.y, 2 * std::exp(-3.), 1e-9);
  }
}

TEST(BodyDamping, ABodyFallsAtGravityOverDamping) {
  Scene scene = test::emptyScene();
  BodyDef def = test::unitCube({});
  def.linearDamping = 2;
  scene.bodies.push_back(def);
  World world(scene, test::options(4, "reference"));
  test::run(world, 60);
  EXPECT_NEAR(world.state(world.bodyAt(0)).velocity.z, -5 * (1 - std::exp(-2.)), 1e-9);
}

TEST(BodyLocks, HoldExactlyUnderContacts) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  for (int i = 0; i < 4; ++i) {
    BodyDef def = test::unitCube({.3 * i, 0, .6 + 1.1 * i});
    def.orientation = fromAxisAngle(Vec3{0, 1, 0}, .2 * i);
    def.velocity = {1, 5, 0}, def.angularVelocity = {1, 1, 1};
    def.lockTranslation = {false, true, false};
    def.lockRotation = {true, false, true};
    scene.bodies.push_back(def);
  }
  World world(scene, test::options(4));
  test::run(world, 240);
  bool moved = false;
  for (int i = 1; i <= 4; ++i) {
    const BodyState s = world.state(world.bodyAt(i));
    EXPECT_EQ(s.position.y, 0) << i;
    EXPECT_EQ(s.orientation.v.x, 0) << i;
    EXPECT_EQ(s.orientation.v.z, 0) << i;
    EXPECT_GT(s.position.z, .45) << i;
    moved |= std::fabs(s.position.x - scene.bodies[std::size_t(i)].position.x) > .1;
  }
  EXPECT_TRUE(moved);
}

TEST(BodyInertia, TakesThePlaceOfTheShapes) {
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef def = test::unitCube({});
  def.inertia = Vec3{1, 2, 2.5};
  scene.bodies.push_back(def);
  World world(scene, test::options(1, "reference"));
  world.applyTorque(world.bodyAt(0), {0, 0, 5});
  world.step();
  EXPECT_NEAR(world.state(world.bodyAt(0)).angularVelocity.z, 2. / 60, 1e-8);
}

TEST(BodyInertia, ThatNoBodyCanHaveIsRefused) {
  BodyDef def = test::unitCube({});
  def.inertia = Vec3{1, 1, 3};
  EXPECT_THROW(validate(def, "body"), Error);
  def.inertia.reset();
  def.linearDamping = -1;
  EXPECT_THROW(validate(def, "body"), Error);
}

/// Does a cube that falls on another rest on it? Both meet the ground.
bool rests(const CollisionFilter& lower, const CollisionFilter& upper, bool exclude = false) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::unitCube({0, 0, .5}));
  scene.bodies.push_back(test::unitCube({0, 0, 1.6}));
  scene.bodies[0].filter.layers = 0xffffffffu;
  scene.bodies[1].filter = lower, scene.bodies[2].filter = upper;
  if (exclude) scene.exclusions.emplace_back(1, 2);
  World world(scene, test::options(4));
  test::run(world, 60);
  const double z = world.state(world.bodyAt(2)).position.z;
  EXPECT_TRUE(std::fabs(z - 1.5) < .01 || std::fabs(z - .5) < .01) << z;
  return z > 1;
}

TEST(BodyFilter, LayersAndMasksMustAgreeOnBothSides) {
  EXPECT_TRUE(rests({}, {}));
  EXPECT_TRUE(rests({1, 2}, {2, 1}));
  EXPECT_FALSE(rests({1, 2}, {1, 1}));
  EXPECT_FALSE(rests({1, 2}, {2, 2}));
}

TEST(BodyFilter, GroupsGoBeforeMasks) {
  EXPECT_FALSE(rests({1, ~0u, -3}, {1, ~0u, -3}));
  EXPECT_TRUE(rests({1, ~0u, -3}, {1, ~0u, -4}));
  EXPECT_TRUE(rests({1, 2, 5}, {1, 2, 5}));
}

TEST(BodyFilter, ExcludedPairsPassOneAnother) {
  EXPECT_FALSE(rests({}, {}, true));
  Scene scene = test::tower(2);
  World world(scene, test::options(4));
  world.setCollide(world.bodyAt(1), world.bodyAt(2), false);
  test::run(world, 60);
  EXPECT_NEAR(world.state(world.bodyAt(2)).position.z, .5, .01);
}

}  // namespace
}  // namespace rubble
