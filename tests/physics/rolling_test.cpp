/// Rolling without slip against closed forms: round bodies of any size, from a hundred thousandth of a radian
/// a step to half a radian.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
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

}  // namespace
}  // namespace rubble
