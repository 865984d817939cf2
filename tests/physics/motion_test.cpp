/// Free motion, pendulums and rolling against closed forms.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using std::numbers::pi;
using test::kDt;
using test::options;

TEST(FreeFall, IsExactInDiscreteTime) {
  // x_n = v0 t_n + g dt^2 n (n + 1) / 2
  for (const int iterations : {1, 4, 10}) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::unitCube({0, 0, 100}));
    for (const bool exact : {true, false}) {
      World world(scene, options(iterations, exact ? "reference" : "cpu"));
      test::run(world, 60);
      const double tolerance = exact ? 1e-11 : 1e-4;
      EXPECT_NEAR(world.state(world.bodyAt(0)).position.z, 100 - 10 * kDt * kDt * 60 * 61 / 2, tolerance);
      EXPECT_NEAR(world.state(world.bodyAt(0)).velocity.z, -10, tolerance);
    }
  }
}

TEST(FreeFall, DoesNotDependOnMassShapeOrNeighbors) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::body(Shape::sphere(.01), {0, 0, 0}));
  scene.bodies.push_back(test::body(Shape::box({3, .1, 2}), {10, 0, 0}));
  scene.bodies.push_back(test::body(Shape::capsule(.2, 1), {20, 0, 0}));
  // a loose tower: gaps within the detection margin carry no load while it falls
  for (int i = 0; i < 5; ++i) scene.bodies.push_back(test::unitCube({30, 0, 1.01 * i}));
  World world(scene, options(4));
  test::run(world, 60);
  const double fall = 10 * kDt * kDt * 60 * 61 / 2;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    EXPECT_NEAR(world.state(world.bodyAt(static_cast<int>(i))).position.z, scene.bodies[i].position.z - fall,
                1e-4)
        << i;
}

TEST(Projectile, FliesItsParabolaWhileItTumbles) {
  Scene scene = test::emptyScene();
  BodyDef def = test::body(Shape::box({.1, .3, .5}), {0, 0, 0});
  def.velocity = {8, 0, 6};
  def.angularVelocity = {3, 5, 1};
  scene.bodies.push_back(def);
  World world(scene, options(4));
  test::run(world, 60);
  EXPECT_TRUE(
      test::near(world.state(world.bodyAt(0)).position, Vec3{8, 0, 6 - 10 * kDt * kDt * 60 * 61 / 2}, 1e-4));
}

/// Times at which f(step) crosses zero upwards, interpolated [s].
template <class F> std::vector<double> upwardCrossings(World& world, int steps, F&& f) {
  std::vector<double> out;
  double before = f();
  for (int i = 1; i <= steps; ++i) {
    world.step();
    const double now = f();
    if (before < 0 && now >= 0) out.push_back((i - 1 + before / (before - now)) * world.params().dt);
    before = now;
  }
  return out;
}

/// Mean time between the zeros of f from its first to its last [s].
double halfPeriod(const std::vector<double>& times) {
  return (times.back() - times.front()) / double(times.size() - 1);
}

class FreeSpinAt : public ::testing::TestWithParam<std::pair<double, double>> {};

TEST_P(FreeSpinAt, TurnsOverWithThePeriodOfEulersEquations) {
  // nearly about the middle axis, where the period depends on what round-off does to the spin
  const auto [speed, dt] = GetParam();
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::body(Shape::box({.1, .2, .4}), {}));
  scene.bodies[0].angularVelocity = {.01 * speed, speed, 0};
  World world(scene, options(4));
  Params params = world.params();
  params.dt = dt;
  world.setParams(params);

  const Vec3 inertia = world.massOf(world.bodyAt(0)).inertia;
  const auto slope = [&](const Vec3& w) {
    return Vec3{(inertia.y - inertia.z) * w.y * w.z / inertia.x,
                (inertia.z - inertia.x) * w.z * w.x / inertia.y,
                (inertia.x - inertia.y) * w.x * w.y / inertia.z};
  };
  std::vector<double> wanted, found;
  const auto pass = [](std::vector<double>& times, double before, double now, double time, double h) {
    if (before * now < 0) times.push_back(time - h * now / (now - before));
  };
  const double end = 120 / speed, h = 1e-3 / speed;
  Vec3 w = scene.bodies[0].angularVelocity;
  for (double t = h; t < end; t += h) {
    const Vec3 k1 = slope(w), k2 = slope(w + h / 2 * k1), k3 = slope(w + h / 2 * k2), k4 = slope(w + h * k3);
    const double before = w.y;
    w = w + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    pass(wanted, before, w.y, t, h);
  }
  double before = speed;
  for (double t = dt; t < end; t += dt) {
    world.step();
    const BodyState state = world.state(world.bodyAt(0));
    const double now = rotate(conjugate(state.orientation), state.angularVelocity).y;
    pass(found, before, now, t, dt);
    before = now;
  }
  ASSERT_EQ(found.size(), wanted.size());
  EXPECT_NEAR(halfPeriod(found) / halfPeriod(wanted), 1, .01);
}

INSTANTIATE_TEST_SUITE_P(All, FreeSpinAt,
                         ::testing::Values(std::pair{2., 1. / 60}, std::pair{2., 1. / 240},
                                           std::pair{5., 1. / 60}, std::pair{10., 1. / 60},
                                           std::pair{10., 1. / 240}),
                         [](const auto& info) { return "Case" + std::to_string(info.index); });

class PendulumAt : public ::testing::TestWithParam<int> {};

TEST_P(PendulumAt, SwingsWithThePeriodOfACompoundPendulum) {
  // a rod of length 1 on a ball joint at its upper end
  constexpr double kAngle = 5 * pi / 180;
  Scene scene = test::emptyScene();
  BodyDef rod = test::body(Shape::box({.05, .05, .5}), {});
  rod.orientation = fromAxisAngle(Vec3{0, 1, 0}, kAngle);
  rod.position = rotate(rod.orientation, Vec3{0, 0, -.5});
  scene.bodies.push_back(rod);
  scene.joints.push_back(test::ball(0, {0, 0, .5}, kWorld, {0, 0, 0}));
  World world(scene, options(GetParam()));
  const MassProperties m = world.massOf(world.bodyAt(0));
  const double period = 2 * pi * std::sqrt((m.inertia.y + m.mass * .25) / (m.mass * 10 * .5)) *
                        (1 + kAngle * kAngle / 16);
  const auto crossings = upwardCrossings(world, 60 * 10,
                                         [&] { return world.state(world.bodyAt(0)).position.x; });
  ASSERT_GE(crossings.size(), 4u);
  const double measured = (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  EXPECT_NEAR(measured, period, .01 * period);
  EXPECT_LT(world.quality().jointGapMax, 1e-3);
}

TEST_P(PendulumAt, NeverSwingsHigherThanItStarted) {
  Scene scene = test::emptyScene();
  BodyDef rod = test::body(Shape::box({.05, .05, .5}), {.5, 0, 0});
  rod.orientation = fromAxisAngle(Vec3{0, 1, 0}, -pi / 2);
  scene.bodies.push_back(rod);
  scene.joints.push_back(test::ball(0, {0, 0, .5}, kWorld, {0, 0, 0}));
  World world(scene, options(GetParam()));
  double highest = -1, lowest = 1;
  for (int i = 0; i < 600; ++i) {
    world.step();
    highest = std::max(highest, world.state(world.bodyAt(0)).position.z),
    lowest = std::min(lowest, world.state(world.bodyAt(0)).position.z);
  }
  EXPECT_LT(highest, .01);
  EXPECT_LT(lowest, -.49);
}

INSTANTIATE_TEST_SUITE_P(Iterations, PendulumAt, ::testing::Values(4, 10));

TEST(Spin, KeepsItsAngularMomentum) {
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef def = test::body(Shape::box({.3, .2, .1}), {});
  def.angularVelocity = {2, 3, 4};
  scene.bodies.push_back(def);
  World world(scene, options(4));
  const Vec3 inertia = world.massOf(world.bodyAt(0)).inertia;
  const auto momentum = [&] {
    const BodyState s = world.state(world.bodyAt(0));
    return rotate(s.orientation, mul(inertia, rotateInverse(s.orientation, s.angularVelocity)));
  };
  const Vec3 first = momentum();
  for (int i = 0; i < 600; ++i) {
    world.step();
    const Vec3 now = momentum();
    // half a step of turning lies between the momentum that is kept and I w at the end of a step
    ASSERT_LT(std::atan2(length(cross(now, first)), dot(now, first)), .05) << i;
    ASSERT_NEAR(length(now), length(first), .005 * length(first)) << i;
  }
}

/// Euler's equations in the body frame by Runge-Kutta: times at which the spin about y changes sign.
std::vector<double> flipTimes(Vec3 w, const Vec3& inertia, double duration) {
  const auto slope = [&](const Vec3& a) {
    const Vec3 torque = -cross(a, mul(inertia, a));
    return Vec3{torque.x / inertia.x, torque.y / inertia.y, torque.z / inertia.z};
  };
  constexpr double h = 1e-4;
  std::vector<double> out;
  for (int i = 0; i < static_cast<int>(duration / h); ++i) {
    const Vec3 k1 = slope(w), k2 = slope(w + h / 2 * k1), k3 = slope(w + h / 2 * k2), k4 = slope(w + h * k3);
    const Vec3 next = w + h / 6 * (k1 + 2. * k2 + 2. * k3 + k4);
    if (w.y * next.y < 0) out.push_back(i * h);
    w = next;
  }
  return out;
}

TEST(Spin, TurnsAboutItsMiddleAxisOverAndOverWithTheRightPeriod) {
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef def = test::body(Shape::box({.5, .3, .1}), {});  // the middle moment of inertia is that about y
  def.angularVelocity = {.05, 5, .05};
  scene.bodies.push_back(def);
  World world(scene, options(4));
  const Vec3 inertia = world.massOf(world.bodyAt(0)).inertia;
  ASSERT_LT(inertia.x, inertia.y);
  ASSERT_LT(inertia.y, inertia.z);
  std::vector<double> flips;
  double before = 5;
  for (int i = 1; i <= 900; ++i) {
    world.step();
    const BodyState s = world.state(world.bodyAt(0));
    const double now = rotateInverse(s.orientation, s.angularVelocity).y;
    if (before * now < 0) flips.push_back((i - 1 + before / (before - now)) * kDt);
    before = now;
  }
  const std::vector<double> expected = flipTimes(def.angularVelocity, inertia, 15);
  ASSERT_GE(expected.size(), 3u);
  ASSERT_EQ(flips.size(), expected.size());
  const auto period = [](const std::vector<double>& times) {
    return (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  };
  EXPECT_NEAR(period(flips), period(expected), .03 * period(expected));
  EXPECT_NEAR(flips[0], expected[0], .03 * expected[0]);
}

TEST(Spin, AboutAPrincipalAxisOfAFastBodyIsKept) {
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef def = test::body(Shape::box({.3, .2, .1}), {});
  def.angularVelocity = {0, 0, 50};
  scene.bodies.push_back(def);
  World world(scene, options(4));
  test::run(world, 600);
  EXPECT_TRUE(test::near(world.state(world.bodyAt(0)).angularVelocity, Vec3{0, 0, 50}, .01));
}

class RollingAt : public ::testing::TestWithParam<int> {};

TEST_P(RollingAt, ASlidingSphereEndsAtFiveSeventhsOfItsSpeed) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground(.3));
  BodyDef def = test::body(Shape::sphere(.5), {0, 0, .5}, .3);
  def.velocity = {5, 0, 0};
  scene.bodies.push_back(def);
  World world(scene, options(GetParam()));
  test::run(world, 180);
  const BodyState s = world.state(world.bodyAt(1));
  EXPECT_NEAR(s.velocity.x, 25. / 7, .01 * 25 / 7);
  EXPECT_NEAR(s.angularVelocity.y * .5, s.velocity.x, .005 * 25 / 7);
  EXPECT_NEAR(s.position.z, .5, .005);
}

INSTANTIATE_TEST_SUITE_P(Iterations, RollingAt, ::testing::Values(4, 10));

TEST(Rolling, ABallRunsDownASlopeAtFiveSeventhsOfASlidingOne) {
  constexpr double kSlope = .2;
  const Quat tilt = fromAxisAngle(Vec3{0, 1, 0}, kSlope);
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground(.8));
  scene.bodies[0].orientation = tilt;
  scene.bodies.push_back(test::body(Shape::sphere(.5), rotate(tilt, Vec3{0, 0, .5}), .8));
  World world(scene, options(10));
  test::run(world, 120);
  const double speed = length(world.state(world.bodyAt(1)).velocity);
  EXPECT_NEAR(speed, 5. / 7 * 10 * std::sin(kSlope) * 2, .02 * speed);
}

}  // namespace
}  // namespace rubble
