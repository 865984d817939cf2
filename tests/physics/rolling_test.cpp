/// Rolling without slip against closed forms: round bodies of any size, from a hundred thousandth of a radian
/// a step to half a radian.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::kGravity;

Shape rollerOf(int kind, double r) {
  if (kind == 0) return Shape::sphere(r);
  if (kind == 1) return Shape::cylinder(r, .4 * r);
  if (kind == 2) return Shape::capsule(r, r);
  if (kind == 4)  // a wheel and its axle
    return Shape::compound({{Shape::cylinder(r, .1 * r), {}, {}}, {Shape::capsule(.2 * r, .3 * r), {}, {}}});
  if (kind == 5)  // two wheels on an axle
    return Shape::compound({{Shape::cylinder(r, .1 * r), {0, 0, .6 * r}, {}},
                            {Shape::cylinder(r, .1 * r), {0, 0, -.6 * r}, {}},
                            {Shape::capsule(.2 * r, .4 * r), {}, {}}});
  if (kind == 6)
    return Shape::compound({{Shape::sphere(r), {}, {}}, {Shape::box({.5 * r, .3 * r, .4 * r}), {}, {}}});
  return Shape::cylinder(r, .4 * r, .2 * r);
}

/// The roller lies across the way, on ground that is tilted about y. Body 1.
World roll(int kind, double r, double slope, double spin, double dt, int iterations, bool plane) {
  const Quat tilt = fromAxisAngle(Vec3{0, 1, 0}, slope);
  Scene scene = test::emptyScene({0, 0, -kGravity});
  BodyDef ground = test::ground(1);
  if (!plane) ground.shape = Shape::box({500, 20, 1}), ground.position = rotate(tilt, {0, 0, -1});
  ground.orientation = tilt;
  scene.bodies.push_back(ground);
  BodyDef def = test::body(rollerOf(kind, r), rotate(tilt, {0, 0, r}), 1);
  def.orientation = tilt * fromAxisAngle(Vec3{1, 0, 0}, std::numbers::pi / 2);
  def.velocity = rotate(tilt, {spin * r, 0, 0});
  def.angularVelocity = {0, spin, 0};
  scene.bodies.push_back(def);
  WorldOptions options = test::options(iterations);
  options.params.dt = dt;
  return World(scene, options);
}

class Roller : public ::testing::TestWithParam<std::tuple<double, double, int>> {};

TEST_P(Roller, OnTheLevelKeepsItsSpeedAndDoesNotSlip) {
  const auto [r, dt, iterations] = GetParam();
  for (const bool plane : {true, false})
    for (int kind = 0; kind < 5; ++kind)
      for (const double turn : {1e-5, 2e-4, .001, .05, .2, .5}) {
        World world = roll(kind, r, 0, turn / dt, dt, iterations, plane);
        test::run(world, static_cast<int>(std::lround(2 / dt)));
        const BodyState s = world.state(world.bodyAt(1));
        EXPECT_NEAR(s.angularVelocity.y * r / s.velocity.x, 1, .002) << kind << ' ' << turn << ' ' << plane;
        EXPECT_NEAR(s.velocity.x / (turn / dt * r), 1, .005) << kind << ' ' << turn << ' ' << plane;
      }
}

TEST_P(Roller, DownASlopeHasTheAccelerationOfTheClosedForm) {
  const auto [r, dt, iterations] = GetParam();
  for (int kind = 0; kind < 3; ++kind)
    for (const double degrees : {5., 20.}) {
      const double slope = degrees * std::numbers::pi / 180;
      World world = roll(kind, r, slope, 0, dt, iterations, true);
      const MassProperties mass = world.massOf(world.bodyAt(1));
      const double a = kGravity * std::sin(slope) / (1 + mass.inertia.z / (mass.mass * r * r));
      // up to half a radian a step
      const double seconds = std::min(2., .5 / dt * r / a);
      const int steps = static_cast<int>(std::lround(seconds / dt));
      test::run(world, steps);
      const BodyState s = world.state(world.bodyAt(1));
      const double v = length(s.velocity);
      EXPECT_NEAR(length(s.angularVelocity) * r / v, 1, .002) << kind << ' ' << degrees;
      EXPECT_NEAR(v / (a * steps * dt), 1, .01) << kind << ' ' << degrees;
    }
}

INSTANTIATE_TEST_SUITE_P(RadiusStepAndIterations, Roller,
                         ::testing::Combine(::testing::Values(.05, .3, 1.),
                                            ::testing::Values(1. / 60, 1. / 240), ::testing::Values(4, 10)));

/// The level of a world that is turned at random is a plane, a box, or the flat end of a cylinder, and comes
/// before the roller or behind it. Speeds are of 1e-5 to 0.3 rad a step. Round-off moves a roller by some
/// 1e-6 rad a step.
TEST(RandomRoller, KeepsItsWayOnAnyGroundInAnyFrame) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    std::mt19937_64 random(seed);
    const auto from = [&](double low, double high) {
      return std::uniform_real_distribution(low, high)(random);
    };
    const auto oneOf = [&](int count) { return static_cast<int>(from(0, count)); };
    const double r = std::pow(10, from(-1.3, .3)), turn = std::pow(10, from(-5, -.5)),
                 dt = oneOf(2) ? 1. / 60 : 1. / 120, speed = turn / dt * r, pi = std::numbers::pi;
    const Quat frame = normalize(Quat{from(-1, 1), from(-1, 1), from(-1, 1), from(-1, 1)}),
               way = frame * fromAxisAngle(Vec3{0, 0, 1}, from(0, 2 * pi));
    Scene scene = test::emptyScene(rotate(frame, {0, 0, -kGravity}));
    const Shape grounds[] = {Shape::plane(), Shape::box({100 * r, 100 * r, r}), Shape::cylinder(100 * r, r)};
    const int which = oneOf(3), kind = oneOf(7);
    BodyDef ground = test::body(grounds[which], rotate(frame, {0, 0, which == 0 ? 0 : -r}));
    ground.motion = Motion::Static, ground.orientation = frame;
    BodyDef roller = test::body(rollerOf(kind, r), rotate(frame, {0, 0, r}));
    roller.orientation = way * fromAxisAngle(Vec3{1, 0, 0}, pi / 2) *
                         fromAxisAngle(Vec3{0, 0, 1}, from(0, 2 * pi));
    roller.velocity = rotate(way, {speed, 0, 0}), roller.angularVelocity = rotate(way, {0, turn / dt, 0});
    const bool first = oneOf(2);
    scene.bodies = first ? std::vector{roller, ground} : std::vector{ground, roller};
    WorldOptions options = test::options(oneOf(2) ? 4 : 10);
    options.params.dt = dt;
    World world(scene, options);
    test::run(world, static_cast<int>(std::lround(2 / dt)));
    const BodyState s = world.state(world.bodyAt(first ? 0 : 1));
    const Vec3 v = rotate(conjugate(way), s.velocity), w = rotate(conjugate(way), s.angularVelocity);
    const double most = .005 + 3e-6 / turn;
    EXPECT_NEAR(v.x / speed, 1, most) << seed << ": kind " << kind << " on " << which;
    EXPECT_NEAR(v.y / speed, 0, most) << seed << ": kind " << kind << " on " << which;
    EXPECT_NEAR(w.y * r / v.x, 1, most) << seed << ": kind " << kind << " on " << which;
  }
}

}  // namespace
}  // namespace rubble
