/// The same scene in other units and at other time steps.
#include <gtest/gtest.h>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::options;

/// A tower, a sliding cube, a heavy cube on a light one and a pendulum.
Scene sample() {
  Scene scene = test::tower(5);
  BodyDef slider = test::unitCube({10, 0, .5}, .5);
  slider.velocity = {3, 0, 0};
  scene.bodies.push_back(slider);
  scene.bodies.push_back(test::unitCube({0, 10, .5}));
  scene.bodies.push_back(test::unitCube({0, 10, 1.5}));
  scene.bodies.back().mass = 20;
  BodyDef rod = test::body(Shape::box({.5, .05, .05}), {.5, 20, 5});
  rod.mass = 2;
  scene.bodies.push_back(rod);
  scene.joints.push_back(
      test::ball(static_cast<int>(scene.bodies.size()) - 1, {-.5, 0, 0}, kWorld, {0, 20, 5}));
  return scene;
}
constexpr int kTop = 5, kSlider = 6, kHeavy = 8, kRod = 9;

Scene withMasses(Scene scene, double factor) {
  for (BodyDef& def : scene.bodies)
    if (def.mass) *def.mass *= factor;
  return scene;
}

/// Lengths, speeds and gravity times `factor`: the same motion in the same time.
Scene withLengths(Scene scene, double factor) {
  scene.gravity *= factor;
  for (BodyDef& def : scene.bodies) {
    def.position *= factor, def.velocity *= factor;
    def.shape.halfExtents *= factor;
  }
  for (JointDef& joint : scene.joints) joint.anchorA *= factor, joint.anchorB *= factor;
  return scene;
}

std::vector<BodyState> finalStates(const Scene& scene, double dt, double seconds, int iterations,
                                   const std::string& backend = "cpu") {
  WorldOptions o = options(iterations, backend);
  o.params.dt = dt;
  World world(scene, o);
  test::run(world, static_cast<int>(std::lround(seconds / dt)));
  std::vector<BodyState> out;
  for (const BodyId id : world.bodies()) out.push_back(world.state(id));
  return out;
}

TEST(Units, OfMassDoNotMatter) {
  // in double precision, so that nothing hides in round-off
  const auto one = finalStates(sample(), 1. / 60, 1, 4, "reference");
  for (const double factor : {1e-3, 1e3}) {
    const auto scaled = finalStates(withMasses(sample(), factor), 1. / 60, 1, 4, "reference");
    for (std::size_t i = 0; i < one.size(); ++i)
      EXPECT_TRUE(test::near(scaled[i].position, one[i].position, 1e-6)) << factor << " " << i;
  }
}

TEST(Units, OfMassDoNotMatterInSinglePrecision) {
  const auto one = finalStates(sample(), 1. / 60, 2, 4);
  for (const double factor : {1e-3, 1e3}) {
    const auto scaled = finalStates(withMasses(sample(), factor), 1. / 60, 2, 4);
    for (std::size_t i = 0; i < one.size(); ++i)
      EXPECT_TRUE(test::near(scaled[i].position, one[i].position, .01)) << factor << " " << i;
  }
}

TEST(Units, OfLengthDoNotMatter) {
  const auto one = finalStates(sample(), 1. / 60, 2, 4, "reference");
  for (const double factor : {.1, 10.}) {
    const auto scaled = finalStates(withLengths(sample(), factor), 1. / 60, 2, 4, "reference");
    for (std::size_t i = 0; i < one.size(); ++i)
      EXPECT_TRUE(test::near(scaled[i].position / factor, one[i].position, .01)) << factor << " " << i;
  }
}

class TimeStep : public ::testing::TestWithParam<double> {};

TEST_P(TimeStep, KeepsStacksStandingAndHeavyOnLight) {
  const auto states = finalStates(sample(), GetParam(), 5, 4);
  EXPECT_TRUE(test::near(states[kTop].position, Vec3{0, 0, 4.5}, .02));
  EXPECT_TRUE(test::near(states[kHeavy].position, Vec3{0, 10, 1.5}, .02));
}

TEST_P(TimeStep, KeepsTheStoppingDistance) {
  const double dt = GetParam();
  const auto states = finalStates(sample(), dt, 3, 10);
  // mu is the mean of 0.5 and 0.6
  const double way = 9 / (2 * std::sqrt(.5 * .6) * 10) - 3 * dt / 2;
  EXPECT_NEAR(states[kSlider].position.x - 10, way, .03 * way);
}

TEST_P(TimeStep, KeepsTheRodOnItsCircle) {
  const auto states = finalStates(sample(), GetParam(), 3, 10);
  const BodyState& rod = states[kRod];
  const Vec3 anchor = rod.position + rotate(rod.orientation, Vec3{-.5, 0, 0});
  EXPECT_TRUE(test::near(anchor, Vec3{0, 20, 5}, .005));
  EXPECT_LT(rod.position.z, 5.001);
}

TEST_P(TimeStep, KeepsAFreeFallWhenSupportGoes) {
  const double dt = GetParam();
  Scene scene = test::tower(5);
  scene.bodies[0].shape = Shape::box({2, 2, .5});
  scene.bodies[0].position = {0, 0, -.5};
  WorldOptions o = options(4);
  o.params.dt = dt;
  World world(scene, o);
  test::run(world, static_cast<int>(2 / dt));
  const double before = world.state(world.bodyAt(5)).position.z;
  world.removeBody(world.bodyAt(0));
  test::run(world, static_cast<int>(std::lround(.5 / dt)));
  EXPECT_GE(before - world.state(world.bodyAt(5)).position.z, .8 * 10 * .25 / 2);
}

INSTANTIATE_TEST_SUITE_P(Rates, TimeStep, ::testing::Values(1. / 30, 1. / 60, 1. / 240),
                         [](const auto& info) { return "Hz" + std::to_string(std::lround(1 / info.param)); });

TEST(TimeStep, CanChangeWhileAStackStands) {
  World world(test::tower(5), options(4));
  test::run(world, 120);
  for (const double dt : {1. / 240, 1. / 30, 1. / 120}) {
    Params params = world.params();
    params.dt = dt;
    world.setParams(params);
    test::run(world, 60);
    EXPECT_NEAR(world.state(world.bodyAt(5)).position.z, 4.5, .02) << dt;
  }
}

TEST(Substeps, AreStepsOfTheirOwn) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  WorldOptions o = options(4, "reference");
  o.params.substeps = 4;
  World world(scene, o);
  test::run(world, 60);
  const double dt = 1. / 240;
  EXPECT_NEAR(world.state(world.bodyAt(0)).position.z, -10 * dt * dt * 240 * 241 / 2, 1e-10);
  EXPECT_NEAR(world.time(), 1, 1e-12);
}

}  // namespace
}  // namespace rubble
