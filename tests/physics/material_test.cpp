/// Materials: combine rules, surface velocity, rolling and torsional friction.
#include <gtest/gtest.h>

#include "tests/support/expect.h"
#include "tests/support/shapes.h"

namespace rubble {
namespace {

using test::options;

/// Deceleration of a box that slides at 4 m/s, over gravity: the dynamic friction of the pair.
double frictionOf(const Material& a, const Material& b) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies[0].material = a;
  scene.bodies.push_back(test::body(Shape::box({.5, .5, .1}), {0, 0, .1}));
  scene.bodies[1].material = b;
  World world(scene, options(20));
  test::run(world, 30);
  BodyState s = world.state(world.bodyAt(1));
  s.velocity = {4, 0, 0};
  world.setState(world.bodyAt(1), s);
  test::run(world, 10);
  const double before = world.state(world.bodyAt(1)).velocity.x;
  test::run(world, 10);
  return (before - world.state(world.bodyAt(1)).velocity.x) / (10 * 10 / 60.);
}

Material rubbing(double friction, Combine rule) {
  Material m;
  m.staticFriction = m.dynamicFriction = friction;
  m.frictionCombine = rule;
  return m;
}

TEST(Material, CombinesByTheLaterRule) {
  const double a = .2, b = .8;
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Usual), rubbing(b, Combine::Usual)), .4, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Average), rubbing(b, Combine::Usual)), .5, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Average), rubbing(b, Combine::Minimum)), .2, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Multiply), rubbing(b, Combine::Minimum)), .16, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Multiply), rubbing(b, Combine::Maximum)), .8, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::GeometricMean), rubbing(b, Combine::Maximum)), .4, .01);
}

TEST(Material, OfAPartCountsWhereThePartTouches) {
  // one runner is ice, the other rubber: only what touches the ground matters
  Material ice = rubbing(0, Combine::Multiply), rubber = rubbing(1, Combine::Multiply);
  const auto slow = [&](const Material& lower, const Material& upper) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::ground(.5));
    scene.bodies.push_back(test::body(Shape::compound({{Shape::box({.5, .5, .1}), {0, 0, -.1}, {}, lower},
                                                       {Shape::box({.5, .5, .1}), {0, 0, .1}, {}, upper}}),
                                      {0, 0, .2}));
    scene.bodies[1].velocity = {4, 0, 0};
    World world(scene, options(10));
    test::run(world, 30);
    return 4 - world.state(world.bodyAt(1)).velocity.x;
  };
  EXPECT_LT(slow(ice, rubber), .05);
  EXPECT_NEAR(slow(rubber, ice), .5 * 10 * .5, .3);
}

TEST(SurfaceVelocity, CarriesABoxAtItsSpeed) {
  for (const std::string& kind : test::groundKinds()) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::groundOf(kind, .5));
    scene.bodies[0].material.surfaceVelocity = {1.5, 0, 0};
    scene.bodies.push_back(test::body(Shape::box({.3, .2, .1}), {-3, 0, .1}, .5));
    World world(scene, options(4));
    // mu g t = 1.5 m/s after 0.3 s
    test::run(world, 9);
    EXPECT_NEAR(world.state(world.bodyAt(1)).velocity.x, .75, .15) << kind;
    test::run(world, 111);
    EXPECT_NEAR(world.state(world.bodyAt(1)).velocity.x, 1.5, .003) << kind;
    EXPECT_NEAR(world.state(world.bodyAt(1)).position.x, -3 + 1.5 * 2 - 1.5 * 1.5 / (2 * 5), .05) << kind;
  }
}

/// How far a ball comes down a slope in 4 s from rest [m].
double rolledDown(double slope, double lever, const std::string& kind) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::groundOf(kind, .8));
  scene.bodies.push_back(test::body(Shape::sphere(.25), {0, 0, .25}, .8));
  scene.bodies[1].material.rollingFriction = lever;
  test::turn(scene, fromAxisAngle(Vec3{0, 1, 0}, slope));
  World world(scene, options(10));
  test::run(world, 240);
  return length(world.state(world.bodyAt(1)).position - scene.bodies[1].position);
}

TEST(RollingFriction, HoldsABallUpToASlopeOfLeverOverRadius) {
  const double lever = .02, limit = std::atan(lever / .25);
  for (const char* kind : {"plane", "box", "mesh"}) {
    EXPECT_LT(rolledDown(.97 * limit, lever, kind), .005) << kind;
    // beyond it: a = (g sin - g cos l / r) / (1 + 2/5)
    const double slope = 1.5 * limit, a = 10 * (std::sin(slope) - std::cos(slope) * lever / .25) / 1.4;
    EXPECT_NEAR(rolledDown(slope, lever, kind), a * 8, .05 * a * 8) << kind;
  }
}

TEST(RollingFriction, StopsABallAfterTheWayOfItsEnergy) {
  const double lever = .01, speed = 1.5;
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies[0].material.rollingFriction = lever;
  scene.bodies.push_back(test::body(Shape::sphere(.25), {0, 0, .25}));
  scene.bodies[1].velocity = {speed, 0, 0};
  scene.bodies[1].angularVelocity = {0, speed / .25, 0};
  World world(scene, options(10));
  test::run(world, 480);
  const BodyState s = world.state(world.bodyAt(1));
  EXPECT_LT(length(s.velocity), 1e-3);
  // 7/10 m v^2 = m g (l / r) way
  const double way = .7 * speed * speed / (10 * lever / .25);
  EXPECT_NEAR(s.position.x, way, .03 * way);
}

TEST(TorsionalFriction, StopsASpinningBallInTime) {
  const double lever = .01, spin = 6;
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::body(Shape::sphere(.25), {0, 0, .25}));
  scene.bodies[1].material.torsionalFriction = lever;
  scene.bodies[1].angularVelocity = {0, 0, spin};
  World world(scene, options(10));
  // 2/5 m r^2 w = m g l t
  const double time = .4 * .25 * .25 * spin / (10 * lever);
  test::run(world, static_cast<int>(.5 * time * 60));
  EXPECT_NEAR(world.state(world.bodyAt(1)).angularVelocity.z, spin / 2, .05 * spin);
  test::run(world, static_cast<int>(.6 * time * 60) + 10);
  EXPECT_LT(length(world.state(world.bodyAt(1)).angularVelocity), 1e-3);
}

}  // namespace
}  // namespace rubble
