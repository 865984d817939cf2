/// The step report, quarantine of bodies with a state that is not finite, and the limit of spin.
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/expect.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::options;

/// A joint that breaks in the first substep is one of the step, and lets its bodies collide.
TEST(StepReport, HasTheJointsThatBrokeInAnySubstep) {
  Scene scene = test::emptyScene();
  scene.bodies = {test::ground(), test::body(Shape::box({.5, .5, .5}), {0, 0, .4})};
  JointDef joint;
  joint.type = JointType::Fixed;
  joint.bodyA = 1, joint.bodyB = 0;
  joint.anchorB = {0, 0, .4};
  joint.breakForce = 1e-3;
  scene.joints.push_back(joint);
  WorldOptions given = options(4);
  given.params.substeps = 3;
  World world(scene, given);
  const StepReport report = world.step();
  EXPECT_EQ(report.brokenJoints, 1);
  EXPECT_EQ(report.broken, world.joints());
  EXPECT_TRUE(world.state(world.joints()[0]).broken);
  test::run(world, 60);
  EXPECT_GT(world.step().contacts, 0);
}

TEST(StepReport, CountsBodiesManifoldsAndContacts) {
  World world(test::tower(3), options(4));
  test::run(world, 120);
  const StepReport report = world.step();
  EXPECT_EQ(report.step, 120);
  EXPECT_EQ(report.bodies, 4);
  EXPECT_EQ(report.manifolds, 3);
  EXPECT_EQ(report.contacts, 12);
  EXPECT_GE(report.pairs, 3);
  // a tower at rest hardly moves
  EXPECT_EQ(report.recycled, 3);
  EXPECT_EQ(report.colors, 2);
  EXPECT_EQ(report.clashes, 0);
  EXPECT_EQ(report.brokenJoints, 0);
  EXPECT_EQ(report.quarantined, 0);
  EXPECT_EQ(report.spinLimited, 0);
  EXPECT_EQ(world.stepCount(), 121);
  EXPECT_NEAR(world.time(), 121. / 60, 1e-12);
}

TEST(StepReport, NamesItsStagesIfTimed) {
  WorldOptions timed = options(4), plain = options(4);
  plain.timings = false;
  World a(test::tower(3), timed), b(test::tower(3), plain);
  const StepReport report = a.step();
  double sum = 0;
  for (const StageTime& stage : report.stages) {
    EXPECT_FALSE(stage.name.empty());
    EXPECT_EQ(report.stageMs(stage.name), stage.ms);
    sum += stage.ms;
  }
  EXPECT_GT(report.stages.size(), 5u);
  EXPECT_LE(sum, report.totalMs);
  EXPECT_EQ(report.stageMs("no such stage"), 0);
  EXPECT_TRUE(b.step().stages.empty());
  EXPECT_EQ(a.hash(), b.hash());
}

double unfinished(int levels, int iterations, double scale = 1) {
  Scene scene = test::tower(levels);
  scene.gravity *= scale;
  for (BodyDef& body : scene.bodies) body.position *= scale, body.shape.halfExtents *= scale;
  World world(scene, options(iterations));
  double sum = 0;
  for (int i = 0; i < 30; ++i) sum += world.step().unfinishedMotion;
  return sum / 30;
}

TEST(StepReport, ReportsTheResidualOfIterations) {
  const double four = unfinished(20, 4);
  EXPECT_GT(four, 0);
  EXPECT_LT(unfinished(20, 20), .5 * four) << "more iterations leave less";
  EXPECT_LT(unfinished(2, 4), .5 * four) << "a low stack is solved sooner";
  // in lengths of a body: at equal dt sqrt(g / L) no unit of length matters
  EXPECT_NEAR(unfinished(20, 4, .01), four, .02 * four);
}

TEST(StepReport, HasNoResidualWhereNothingTouches) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 5}));
  scene.bodies.back().angularVelocity = {1, 2, 3};
  World world(scene, options(4));
  for (int i = 0; i < 30; ++i) EXPECT_LT(world.step().unfinishedMotion, 1e-6);
}

TEST(StepReport, CountsBodiesWhoseSpinIsLimited) {
  Scene scene = test::emptyScene({0, 0, 0});
  for (int i = 0; i < 3; ++i) {
    scene.bodies.push_back(test::unitCube({3. * i, 0, 0}));
    scene.bodies.back().angularVelocity = {0, 0, i == 1 ? 170. : 100.};
  }
  World world(scene, options(4));
  EXPECT_EQ(world.step().spinLimited, 1);
  // 2 rad per step
  EXPECT_NEAR(world.state(world.bodyAt(1)).angularVelocity.z, 120, 1e-3);
  EXPECT_NEAR(world.state(world.bodyAt(0)).angularVelocity.z, 100, 1e-3);
}

/// The rotation of an aggregate may overflow, which leaves its bodies without an orientation.
TEST(Quarantine, LeavesEveryOrientationOfLengthOneUnderGravityOfAnySize) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    test::Random random(seed);
    Scene scene = test::tower(1);
    for (int i = 0; i < 3; ++i) scene.bodies.push_back(test::unitCube({1.5 * (i + 2), 0, .5}));
    scene.bodies[2].shape = Shape::sphere(.4);
    scene.joints = {jointAt(scene, JointType::Hinge, 2, 3, {3.8, 0, .5})};
    World world(scene, options(2));
    for (int step = 0; step < 4; ++step) {
      world.setGravity(random.vector(random.logUniform(1e3, 1e18)));
      world.step();
      for (const BodyId id : world.bodies()) {
        const Quat q = world.state(id).orientation;
        ASSERT_NEAR(q.s * q.s + dot(q.v, q.v), 1, 1e-4) << "seed " << seed << ", body " << id.index;
      }
    }
  }
}

TEST(Quarantine, FreezesABodyThatIsNotFiniteAndLetsTheRestGoOn) {
  Scene scene = test::tower(3);
  scene.bodies.push_back(test::unitCube({10, 0, 50}));
  scene.bodies.push_back(test::unitCube({-10, 0, 50}));
  scene.bodies.back().mass = 1e-30;
  World world(scene, options(4));
  test::run(world, 10);
  const BodyId light = world.bodyAt(5);
  const Vec3 before = world.state(light).position;
  // its motion in a step is beyond single precision
  world.applyForce(light, {1e18, 0, 0});
  EXPECT_GE(world.step().quarantined, 1);
  EXPECT_EQ(world.state(light).position, before);
  EXPECT_EQ(world.state(light).velocity, (Vec3{0, 0, 0}));
  test::run(world, 49);
  for (const BodyId id : world.bodies())
    EXPECT_TRUE(std::isfinite(length(world.state(id).position))) << id.index;
  EXPECT_NEAR(world.state(world.bodyAt(4)).position.z, 50 - 10 * 60. * 61 / 7200, 1e-3);
  for (int k = 1; k <= 3; ++k) EXPECT_NEAR(world.state(world.bodyAt(k)).position.z, k - .5, .02);
}

}  // namespace
}  // namespace rubble
