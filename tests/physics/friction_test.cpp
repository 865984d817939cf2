/// Dry friction against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::kDt;
using test::options;

/// Way of a cube down a slope, from rest [m].
double wayDown(double slope, double friction, int iterations, int steps) {
  const Quat tilt = fromAxisAngle(Vec3{0, 1, 0}, slope);
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground(friction));
  scene.bodies[0].orientation = tilt;
  BodyDef cube = test::unitCube(rotate(tilt, Vec3{0, 0, .5}), friction);
  cube.orientation = tilt;
  scene.bodies.push_back(cube);
  World world(scene, options(iterations));
  test::run(world, steps);
  return length(world.state(world.bodyAt(1)).position - cube.position);
}

class RampAt : public ::testing::TestWithParam<std::tuple<double, int>> {};

TEST_P(RampAt, HoldsOnePercentBelowTheThreshold) {
  const auto [friction, iterations] = GetParam();
  EXPECT_LT(wayDown(std::atan(.99 * friction), friction, iterations, 300), .005);
}

TEST_P(RampAt, SlidesOnePercentAboveTheThreshold) {
  const auto [friction, iterations] = GetParam();
  const double slope = std::atan(1.01 * friction), t = 300 * kDt;
  const double way = 10 * std::cos(slope) * .01 * friction * t * t / 2;
  const double measured = wayDown(slope, friction, iterations, 300);
  EXPECT_GT(measured, .5 * way);
  EXPECT_LT(measured, 1.5 * way);
}

TEST_P(RampAt, SlidesAtTheRightRateFarAboveTheThreshold) {
  const auto [friction, iterations] = GetParam();
  const double slope = std::atan(1.3 * friction);
  const double way = 10 * std::cos(slope) * .3 * friction * kDt * kDt * 120 * 121 / 2;
  // four iterations start the slide late by up to a tenth
  EXPECT_NEAR(wayDown(slope, friction, iterations, 120), way, (iterations < 10 ? .12 : .03) * way);
}

INSTANTIATE_TEST_SUITE_P(FrictionAndIterations, RampAt,
                         ::testing::Combine(::testing::Values(.25, .5), ::testing::Values(4, 10)),
                         [](const auto& info) {
                           return "mu" + std::to_string(static_cast<int>(100 * std::get<0>(info.param))) +
                                  "At" + std::to_string(std::get<1>(info.param));
                         });

/// Way of a cube that rests on the ground and is given 5 m/s, until it rests again [m].
double stoppingWay(double friction, int iterations, const Vec3& direction = {1, 0, 0}) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground(friction));
  scene.bodies.push_back(test::unitCube({0, 0, .5}, friction));
  World world(scene, options(iterations));
  test::run(world, 60);
  BodyState start = world.state(world.bodyAt(1));
  start.velocity = 5. * direction;
  world.setState(world.bodyAt(1), start);
  test::run(world, 240);
  const BodyState s = world.state(world.bodyAt(1));
  EXPECT_LT(length(s.velocity), .02);
  const Vec3 way = s.position - start.position;
  EXPECT_NEAR(dot(way, Vec3{-direction.y, direction.x, 0}), 0, .01);
  return dot(way, direction);
}

class StoppingAt : public ::testing::TestWithParam<std::tuple<double, int>> {};

TEST_P(StoppingAt, TakesTheDistanceOfDiscreteTime) {
  const auto [friction, iterations] = GetParam();
  const double way = 25 / (2 * friction * 10) - 5 * kDt / 2;
  EXPECT_NEAR(stoppingWay(friction, iterations), way, .02 * way);
}

INSTANTIATE_TEST_SUITE_P(FrictionAndIterations, StoppingAt,
                         ::testing::Combine(::testing::Values(.25, .5), ::testing::Values(1, 4, 10)),
                         [](const auto& info) {
                           return "mu" + std::to_string(static_cast<int>(100 * std::get<0>(info.param))) +
                                  "At" + std::to_string(std::get<1>(info.param));
                         });

TEST(Stopping, DoesNotDependOnTheDirection) {
  const double way = 25 / (2 * .5 * 10) - 5 * kDt / 2;
  for (const double angle : {.3, .785398, 1.9, 4.})
    EXPECT_NEAR(stoppingWay(.5, 10, {std::cos(angle), std::sin(angle), 0}), way, .02 * way) << angle;
}

TEST(Friction, OfAPairIsTheGeometricMean) {
  // 0.25 on 1 is 0.5
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground(1));
  BodyDef cube = test::unitCube({0, 0, .5}, .25);
  cube.velocity = {5, 0, 0};
  scene.bodies.push_back(cube);
  World world(scene, options(10));
  test::run(world, 240);
  const double way = 25 / (2 * .5 * 10) - 5 * kDt / 2;
  EXPECT_NEAR(world.state(world.bodyAt(1)).position.x, way, .02 * way);
}

TEST(Friction, StaticHoldsWhereDynamicWouldSlide) {
  const double slope = std::atan(.45);
  const Quat tilt = fromAxisAngle(Vec3{0, 1, 0}, slope);
  for (const double speed : {0., 1.}) {
    Scene scene = test::emptyScene();
    for (int i = 0; i < 2; ++i) {
      scene.bodies.push_back(i == 0 ? test::ground() : test::unitCube(rotate(tilt, Vec3{0, 0, .5})));
      scene.bodies[static_cast<std::size_t>(i)].orientation = tilt;
      scene.bodies[static_cast<std::size_t>(i)].material = {.6, .3, 0};
    }
    scene.bodies[1].velocity = rotate(tilt, Vec3{speed, 0, 0});
    World world(scene, options(10));
    test::run(world, 120);
    const double v = length(world.state(world.bodyAt(1)).velocity);
    // at rest it stays, pushed it goes faster and faster
    if (speed == 0) {
      EXPECT_LT(v, .001);
    } else {
      EXPECT_NEAR(v, 1 + 10 * std::cos(slope) * .15 * 2, .1);
    }
  }
}

TEST(Friction, WithoutFrictionNothingHolds) {
  const double slope = .1;
  const double way = 10 * std::sin(slope) * kDt * kDt * 60 * 61 / 2;
  EXPECT_NEAR(wayDown(slope, 0, 10, 60), way, .005 * way);
}

TEST(Friction, SlowsASpinAtItsRate) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground(.5));
  BodyDef cube = test::unitCube({0, 0, .5}, .5);
  cube.angularVelocity = {0, 0, 5};
  scene.bodies.push_back(cube);
  World world(scene, options(10));
  test::run(world, 10);
  // four corners at r = sqrt(0.5), I = 1/6: mu m g r / I
  EXPECT_NEAR(world.state(world.bodyAt(1)).angularVelocity.z, 5 - 10 * kDt * .5 * 10 * std::sqrt(.5) * 6,
              .05);
  EXPECT_LT(length(world.state(world.bodyAt(1)).position - Vec3{0, 0, .5}), .01);
}

/// A cube of 1 kg and 1 m on the ground, pushed along x at a height [m] and to one side [m] with a force that
/// grows: at which share of mu_s m g it slips.
double slippingPush(double height, double side, int iterations) {
  Scene scene = test::emptyScene();
  for (const BodyDef& body : {test::ground(), test::unitCube({0, 0, .5})}) {
    scene.bodies.push_back(body);
    scene.bodies.back().material = {.5, .3, 0};
  }
  World world(scene, options(iterations));
  test::run(world, 30);
  const BodyId cube = world.bodyAt(1);
  for (double share = 0; share < 1.2; share += (share < .6 ? .25 : .05) * kDt) {
    world.applyForceAt(cube, {share * 5, 0, 0}, {0, side, height});
    world.step();
    const BodyState s = world.state(cube);
    if (length(s.velocity) + .5 * length(s.angularVelocity) > .05) return share;
  }
  return 2;
}

/// The same for four points that bear equal loads, at the corners of the base: the least over all poles of
/// the turn.
double slippingPushOfFourPoints(double side) {
  double least = 1;
  for (double pole = -20; pole < 20; pole += .001)
    if (std::fabs(pole - side) > 1e-3)
      least = std::min(least,
                       .5 * (std::hypot(.5, .5 - pole) + std::hypot(.5, .5 + pole)) / std::fabs(pole - side));
  return least;
}

class PushAt : public ::testing::TestWithParam<int> {};

TEST_P(PushAt, SlipsAtStaticFrictionAtAnyHeight) {
  for (const double height : {0., .25, .5, .75, .9})
    EXPECT_NEAR(slippingPush(height, 0, GetParam()), 1, .02) << height;
}

TEST_P(PushAt, SlipsAndTurnsAtTheClosedFormOffCenter) {
  for (const double side : {.1, .25}) {
    const double exact = slippingPushOfFourPoints(side);
    EXPECT_NEAR(slippingPush(.3, side, GetParam()), exact, .02 * exact) << side;
  }
}

INSTANTIATE_TEST_SUITE_P(Iterations, PushAt, ::testing::Values(4, 10));

/// A block on a spring whose end moves on: it sticks until the spring pulls with mu_s m g, and swings about
/// mu_d m g until it stands still again. With D = (mu_s - mu_d) m g / k and w^2 = k / m the period is 2 D / V
/// + 2 (pi - atan(D w / V)) / w.
TEST(StickSlip, HasThePeriodOfTheClosedForm) {
  constexpr double kStatic = .5, kDynamic = .3, kSpring = 20, kSpeed = .1;
  const double d = (kStatic - kDynamic) * 10 / kSpring, w = std::sqrt(kSpring);
  const double exact = 2 * d / kSpeed + 2 / w * (std::acos(-1.) - std::atan(d * w / kSpeed));
  for (const int iterations : {4, 10}) {
    Scene scene = test::emptyScene();
    for (const BodyDef& body : {test::ground(), test::body(Shape::box({.5, .5, .25}), {0, 0, .25})}) {
      scene.bodies.push_back(body);
      scene.bodies.back().material = {kStatic, kDynamic, 0};
    }
    scene.bodies[1].mass = 1;
    World world(scene, options(iterations));
    const BodyId block = world.bodyAt(1);
    test::run(world, 30);
    const double origin = world.state(block).position.x;
    bool slid = false;
    double first = 0, last = 0;
    int slips = 0;
    for (int i = 0; i < 2000; ++i) {
      const double pull = kSpring * (kSpeed * i * kDt - (world.state(block).position.x - origin));
      world.applyForce(block, {pull, 0, 0});
      world.step();
      const bool slides = world.state(block).velocity.x > .5 * kSpeed;
      if (slides && !slid && ++slips >= 2) (slips == 2 ? first : last) = i * kDt;
      slid = slides;
    }
    ASSERT_GT(slips, 5);
    EXPECT_NEAR((last - first) / (slips - 2), exact, .05 * exact) << iterations;
  }
}

}  // namespace
}  // namespace rubble
