/// Arrays of joints and sensors, and definitions of bodies that change.
#include "tests/support/array_claims.h"

namespace rubble {
namespace {

using test::body;

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

TEST(Arrays, ForcesAlongAxesActOnBothBodies) { test::expectForcesAlongAxes(test::worldsOptions()); }

TEST(Arrays, AccelerometersShowGravityAtRest) {
  test::expectAccelerations(test::worldsOptions(), test::copyOfHost);
}

TEST(Arrays, RaysInManyWorldsHitWhatThoseOfEachHit) {
  test::expectRays({640, 5}, test::worldsOptions("cpu", 2), 35);
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
  def.motion = Motion::Static;
  EXPECT_THROW(world.setDefinition(id, def), Error);
}

}  // namespace
}  // namespace rubble
