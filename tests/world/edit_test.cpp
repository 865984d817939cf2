/// Bodies and joints that come and go: ids, names, slots.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::options;

TEST(WorldIds, OfARemovedBodyAreDeadAndThrow) {
  World world(test::tower(2), options());
  const BodyId id = world.bodyAt(2);
  EXPECT_TRUE(world.alive(id));
  world.removeBody(id);
  EXPECT_FALSE(world.alive(id));
  EXPECT_THROW(world.state(id), Error);
  EXPECT_THROW(world.setState(id, {}), Error);
  EXPECT_THROW(world.applyForce(id, {}), Error);
  EXPECT_THROW(world.applyForceAt(id, {}, {}), Error);
  EXPECT_THROW(world.applyTorque(id, {}), Error);
  EXPECT_THROW(world.applyImpulse(id, {}), Error);
  EXPECT_THROW(world.definition(id), Error);
  EXPECT_THROW(world.massOf(id), Error);
  EXPECT_THROW(world.removeBody(id), Error);
}

TEST(WorldIds, DoNotFindTheNextBodyOfTheirSlot) {
  World world(test::tower(2), options());
  const BodyId old = world.bodyAt(2);
  world.removeBody(old);
  const BodyId fresh = world.addBody(test::unitCube({0, 0, 5}));
  EXPECT_EQ(fresh.index, old.index);
  EXPECT_NE(fresh.generation, old.generation);
  EXPECT_TRUE(world.alive(fresh));
  EXPECT_FALSE(world.alive(old));
  EXPECT_THROW(world.state(old), Error);
  EXPECT_EQ(world.state(fresh).position.z, 5);
}

TEST(WorldIds, OutOfRangeAreNotAlive) {
  World world(test::tower(1), options());
  EXPECT_FALSE(world.alive(BodyId{}));
  EXPECT_FALSE(world.alive(BodyId{99, 0}));
  EXPECT_FALSE(world.alive(JointId{0, 0}));
  EXPECT_THROW(world.bodyAt(2), Error);
  EXPECT_THROW(world.bodyAt(-1), Error);
}

TEST(WorldNames, FindBodiesAndJointsAndAreFreedByRemoval) {
  Scene scene = test::tower(2);
  scene.bodies[1].name = "low";
  scene.bodies[2].name = "high";
  scene.joints.push_back(test::ball(1, {0, 0, .5}, 2, {0, 0, -.5}));
  scene.joints[0].name = "pin";
  World world(scene, options());
  EXPECT_EQ(world.findBody("high"), world.bodyAt(2));
  EXPECT_EQ(world.findJoint("pin"), world.joints()[0]);
  EXPECT_THROW(world.findBody("none"), Error);
  BodyDef twin = test::unitCube({5, 0, 5});
  twin.name = "high";
  EXPECT_THROW(world.addBody(twin), Error);
  world.removeBody(world.findBody("high"));
  EXPECT_THROW(world.findBody("high"), Error);
  EXPECT_THROW(world.findJoint("pin"), Error);
  const BodyId id = world.addBody(twin);
  EXPECT_EQ(world.findBody("high"), id);
}

TEST(WorldEdit, RemovingABodyTakesItsJointsAlong) {
  Scene scene = test::emptyScene();
  for (int i = 0; i < 3; ++i) scene.bodies.push_back(test::unitCube({2. * i, 0, 10}));
  scene.joints.push_back(test::ball(0, {1, 0, 0}, 1, {-1, 0, 0}));
  scene.joints.push_back(test::ball(1, {1, 0, 0}, 2, {-1, 0, 0}));
  scene.joints.push_back(test::ball(kWorld, {0, 0, 11}, 0, {0, 0, 1}));
  World world(scene, options());
  const std::vector<JointId> joints = world.joints();
  test::run(world, 5);
  world.removeBody(world.bodyAt(1));
  EXPECT_FALSE(world.alive(joints[0]));
  EXPECT_FALSE(world.alive(joints[1]));
  EXPECT_TRUE(world.alive(joints[2]));
  EXPECT_THROW(world.state(joints[0]), Error);
  EXPECT_THROW(world.removeJoint(joints[0]), Error);
  const double z = world.state(world.bodyAt(2)).position.z;
  test::run(world, 30);
  EXPECT_LT(world.state(world.bodyAt(2)).position.z, z - 1);
}

TEST(WorldEdit, BodiesListsTheAliveOnesByIndex) {
  World world(test::tower(3), options());
  world.removeBody(world.bodyAt(2));
  const std::vector<BodyId> ids = world.bodies();
  ASSERT_EQ(ids.size(), 3u);
  EXPECT_EQ(ids[0], world.bodyAt(0));
  EXPECT_EQ(ids[1], world.bodyAt(1));
  EXPECT_EQ(ids[2], world.bodyAt(3));
  EXPECT_EQ(world.step().bodies, 3);
}

TEST(WorldEdit, ABodyAddedWhileRunningFallsAndLands) {
  World world(test::tower(1), options());
  test::run(world, 10);
  const BodyId id = world.addBody(test::unitCube({0, 0, 3}));
  test::run(world, 120);
  EXPECT_NEAR(world.state(id).position.z, 1.5, .01);
  EXPECT_NEAR(world.state(world.bodyAt(1)).position.z, .5, .01);
}

TEST(WorldEdit, RemovingTheSupportLetsABodyFall) {
  World world(test::tower(2), options());
  test::run(world, 60);
  world.removeBody(world.bodyAt(1));
  test::run(world, 30);
  EXPECT_NEAR(world.state(world.bodyAt(2)).position.z, .5, .02);
}

TEST(WorldEdit, AnotherBodyInASlotTakesOverNoContacts) {
  World world(test::tower(2), options());
  test::run(world, 60);
  world.removeBody(world.bodyAt(2));
  // in the slot of a resting cube, off the ground and clear of the other
  BodyDef def = test::unitCube({0, 0, 3});
  const BodyId id = world.addBody(def);
  world.step();
  EXPECT_NEAR(world.state(id).velocity.z, -10. / 60, 1e-6);
}

TEST(WorldEdit, AThousandBodiesAddedToARunningWorldAllCollide) {
  World world(test::tower(1), options(4));
  test::run(world, 3);
  // separate columns of two cubes: one touches the ground, one the cube below
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 25; ++x)
      for (int z = 0; z < 2; ++z) world.addBody(test::unitCube({3. + 1.5 * x, 1.5 * y, .5 + z}));
  const StepReport report = world.step();
  EXPECT_EQ(report.bodies, 1002);
  EXPECT_EQ(report.manifolds, 1001);
  EXPECT_EQ(report.contacts, 4004);
  test::run(world, 60);
  for (const BodyId id : world.bodies()) {
    if (world.definition(id).motion == Motion::Static) continue;
    const double z = world.state(id).position.z;
    EXPECT_NEAR(z, z > 1 ? 1.5 : .5, .01);
  }
}

TEST(WorldEdit, APlaneAddedOrRemovedWhileRunningActsAtOnce) {
  World world(test::tower(1), options());
  test::run(world, 10);
  world.removeBody(world.bodyAt(0));
  test::run(world, 30);
  EXPECT_LT(world.state(world.bodyAt(1)).position.z, -.5);
  BodyDef floor = test::ground();
  floor.position = {0, 0, -4};
  world.addBody(floor);
  test::run(world, 120);
  EXPECT_NEAR(world.state(world.bodyAt(1)).position.z, -3.5, .02);
}

TEST(WorldEdit, MassComesFromDensityOrIsSet) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::body(Shape::box({.5, 1, 1.5}), {}));
  scene.bodies[0].density = 500;
  scene.bodies.push_back(test::body(Shape::sphere(2), {10, 0, 0}));
  scene.bodies[1].mass = 7;
  World world(scene, options());
  const MassProperties box = world.massOf(world.bodyAt(0)), sphere = world.massOf(world.bodyAt(1));
  EXPECT_NEAR(box.mass, 3000, 1e-9);
  EXPECT_TRUE(test::near(box.inertia, Vec3{3000. / 12 * 13, 3000. / 12 * 10, 3000. / 12 * 5}, 1e-9));
  EXPECT_NEAR(sphere.mass, 7, 1e-12);
  EXPECT_TRUE(test::near(sphere.inertia, Vec3{1, 1, 1} * (.4 * 7 * 4), 1e-12));
}

TEST(MassProperties, OfACapsuleAreThoseOfItsPoints) {
  // the integrals by slices across the axis
  const double r = .3, h = .7, density = 2;
  double mass = 0, axial = 0, across = 0;
  constexpr int kSlices = 200000;
  const double dz = 2 * (h + r) / kSlices;
  for (int i = 0; i < kSlices; ++i) {
    const double z = -(h + r) + (i + .5) * dz, beyond = std::max(0., std::fabs(z) - h);
    const double a2 = r * r - beyond * beyond, slice = density * 3.14159265358979 * a2 * dz;
    mass += slice, axial += slice * a2 / 2, across += slice * (a2 / 4 + z * z);
  }
  const MassProperties m = massProperties(Shape::capsule(r, h), density);
  EXPECT_NEAR(m.mass, mass, 1e-6 * mass);
  EXPECT_TRUE(test::near(m.inertia, Vec3{across, across, axial}, 1e-6 * across));
}

}  // namespace
}  // namespace rubble
