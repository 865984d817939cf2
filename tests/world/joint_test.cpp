/// Joints in a world: measures, breakage, collision of the jointed bodies.
#include <gtest/gtest.h>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::options;

/// A cube of 1 kg hanging from the world by its top.
Scene hanging() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  scene.joints.push_back(test::ball(0, {0, 0, .5}, kWorld, {0, 0, .5}));
  return scene;
}

TEST(BallJoint, CarriesTheWeightOfItsBody) {
  World world(hanging(), options(20, "reference"));
  test::run(world, 120);
  const JointState joint = world.state(world.joints()[0]);
  EXPECT_FALSE(joint.broken);
  EXPECT_LT(joint.gap, 1e-3);
  // on B, the world: the body pulls it down
  EXPECT_TRUE(test::near(joint.force, Vec3{0, 0, -10}, .1));
}

TEST(BallJoint, BreaksWhereItsForceReachesTheThresholdAndTheBodyFalls) {
  for (const double threshold : {11., 9.}) {
    Scene scene = hanging();
    scene.joints[0].breakForce = threshold;
    World world(scene, options(20, "reference"));
    int broken = 0;
    for (int i = 0; i < 120; ++i) broken += world.step().brokenJoints;
    const bool holds = threshold > 10;
    EXPECT_EQ(broken, holds ? 0 : 1);
    EXPECT_EQ(world.state(world.joints()[0]).broken, !holds);
    if (holds) {
      EXPECT_NEAR(world.state(world.bodyAt(0)).position.z, 0, 1e-3);
    } else {
      EXPECT_LT(world.state(world.bodyAt(0)).position.z, -5);
    }
  }
}

TEST(FixedJoint, HoldsACantileverAndReportsItsMoment) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  JointDef joint = test::ball(0, {-.5, 0, 0}, kWorld, {-.5, 0, 0});
  joint.type = JointType::Fixed;
  scene.joints.push_back(joint);
  World world(scene, options(20, "reference"));
  test::run(world, 240);
  const JointState state = world.state(world.joints()[0]);
  EXPECT_LT(state.gap, 1e-3);
  EXPECT_LT(state.angle, 2e-3);
  // 10 N at 0.5 m, on B
  EXPECT_TRUE(test::near(state.torque, Vec3{0, 5, 0}, .1));
  EXPECT_TRUE(test::near(state.force, Vec3{0, 0, -10}, .1));
}

TEST(FixedJoint, BreaksByTorque) {
  for (const double threshold : {6., 4.}) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::unitCube({0, 0, 0}));
    JointDef joint = test::ball(0, {-.5, 0, 0}, kWorld, {-.5, 0, 0});
    joint.type = JointType::Fixed;
    joint.breakTorque = threshold;
    scene.joints.push_back(joint);
    World world(scene, options(20, "reference"));
    test::run(world, 120);
    EXPECT_EQ(world.state(world.joints()[0]).broken, threshold < 5);
  }
}

TEST(BallJoint, OfFiniteStiffnessStretchesByHookesLaw) {
  Scene scene = hanging();
  scene.joints[0].stiffness = 400;
  World world(scene, options(20, "reference"));
  test::run(world, 1200);
  EXPECT_NEAR(world.state(world.joints()[0]).gap, 10. / 400, 1e-4);
  EXPECT_NEAR(world.state(world.bodyAt(0)).position.z, -.025, 1e-4);
}

/// Two cubes that overlap by half, jointed at a common point.
Scene overlapping(bool collide) {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  scene.bodies.push_back(test::unitCube({.5, 0, 0}));
  scene.joints.push_back(test::ball(0, {.25, 0, 0}, 1, {-.25, 0, 0}));
  scene.joints[0].collide = collide;
  return scene;
}

TEST(Joint, KeepsItsBodiesFromCollidingUnlessAsked) {
  World apart(overlapping(false), options());
  EXPECT_EQ(apart.step().manifolds, 0);
  test::run(apart, 30);
  EXPECT_EQ(apart.quality().maxSpeed, 0);
  World both(overlapping(true), options());
  EXPECT_EQ(both.step().manifolds, 1);
}

TEST(Joint, RemovedLetsItsBodiesCollideAgain) {
  World world(overlapping(false), options());
  EXPECT_EQ(world.step().manifolds, 0);
  world.removeJoint(world.joints()[0]);
  EXPECT_EQ(world.step().manifolds, 1);
}

TEST(Joint, AddedWhileRunningCatchesAFallingBody) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  World world(scene, options(20, "reference"));
  test::run(world, 10);
  const double z = world.state(world.bodyAt(0)).position.z;
  JointDef joint;
  joint.anchorB = {0, 0, z};
  const JointId id = world.addJoint(joint, world.bodyAt(0), BodyId{});
  test::run(world, 240);
  EXPECT_NEAR(world.state(world.bodyAt(0)).position.z, z, 2e-3);
  EXPECT_TRUE(world.alive(id));
}

TEST(Joint, SlotsAreUsedAgainWithoutOldLoad) {
  World world(hanging(), options(20, "reference"));
  test::run(world, 120);
  const JointId old = world.joints()[0];
  world.removeJoint(old);
  JointDef joint;
  joint.anchorA = {0, 0, .5};
  joint.anchorB = world.state(world.bodyAt(0)).position + Vec3{0, 0, .5};
  const JointId fresh = world.addJoint(joint, world.bodyAt(0), BodyId{});
  EXPECT_FALSE(world.alive(old));
  EXPECT_EQ(world.state(fresh).force, (Vec3{0, 0, 0}));
}

TEST(Quality, MeasuresGapsEnergyAndSpeed) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 2}));
  scene.bodies[0].velocity = {3, 0, 4};
  scene.bodies[0].angularVelocity = {0, 0, 6};
  scene.joints.push_back(test::ball(0, {0, 0, 0}, kWorld, {0, .3, 2.4}));
  World world(scene, options());
  world.hash();
  const Quality before = world.quality();
  EXPECT_NEAR(before.kineticEnergy, .5 * 25 + .5 * 36 / 6, 1e-5);
  EXPECT_NEAR(before.maxSpeed, 5, 1e-6);
  EXPECT_NEAR(before.jointGapMax, .5, 1e-6);
  EXPECT_NEAR(before.jointGapMean, .5, 1e-6);
}

TEST(Contacts, OfARestingCubeCarryItsWeight) {
  World world(test::tower(1), options(20, "reference"));
  test::run(world, 120);
  const std::vector<ContactPoint> contacts = world.contacts();
  ASSERT_EQ(contacts.size(), 4u);
  Vec3 sum;
  for (const ContactPoint& c : contacts) {
    // from A to B; the ground has the lower index
    EXPECT_EQ(c.a, world.bodyAt(0));
    EXPECT_EQ(c.b, world.bodyAt(1));
    EXPECT_TRUE(test::near(c.normal, Vec3{0, 0, 1}, 1e-6));
    EXPECT_NEAR(c.position.z, 0, 1e-3);
    EXPECT_LT(std::fabs(c.depth), 1e-3);
    sum += c.force;
  }
  EXPECT_TRUE(test::near(sum, Vec3{0, 0, 10}, .1));
}

}  // namespace
}  // namespace rubble
