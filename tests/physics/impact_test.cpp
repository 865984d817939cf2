/// Impacts, rebound and stacks.
#include <gtest/gtest.h>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::kDt;
using test::options;

/// A body of 1 kg runs at `speed` into one of `ratio` kg at rest; velocities after a second.
struct HeadOn {
  Vec3 first, second, momentum;
};
HeadOn headOn(const Shape& shape, double speed, double ratio, int iterations, double restitution = 0) {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::body(shape, {-1.2, 0, 0}));
  scene.bodies.push_back(test::body(shape, {0, 0, 0}));
  scene.bodies[0].mass = 1, scene.bodies[1].mass = ratio;
  scene.bodies[0].velocity = {speed, 0, 0};
  for (BodyDef& def : scene.bodies) def.material.restitution = restitution;
  World world(scene, options(iterations));
  test::run(world, 60);
  HeadOn out{world.state(world.bodyAt(0)).velocity, world.state(world.bodyAt(1)).velocity, {}};
  out.momentum = out.first + ratio * out.second;
  return out;
}

TEST(HeadOnImpact, WithoutBounceConservesMomentum) {
  for (const double ratio : {.1, 1., 2., 10.})
    for (const Shape& shape : {Shape::sphere(.5), Shape::box({.5, .5, .5})}) {
      const HeadOn r = headOn(shape, 2, ratio, 20);
      EXPECT_TRUE(test::near(r.momentum, Vec3{2, 0, 0}, .01)) << ratio;
    }
}

TEST(HeadOnImpact, WithoutBounceLeavesBothWithOneVelocity) {
  for (const double ratio : {1., 2.})
    for (const Shape& shape : {Shape::sphere(.5), Shape::box({.5, .5, .5})}) {
      const HeadOn r = headOn(shape, 2, ratio, 20);
      const double together = 2 / (1 + ratio);
      EXPECT_NEAR(r.first.x, together, .05 * 2) << ratio;
      EXPECT_NEAR(r.second.x, together, .05 * 2) << ratio;
    }
}

/// Neither body is fast for its size, so CCD stops neither. The rows of this step resolve the impact.
TEST(HeadOnImpact, OfTwentyMetresASecondKeepsMomentumAtFourIterations) {
  for (const double ratio : {.1, 1., 10.})
    for (const Shape& shape : {Shape::sphere(.5), Shape::box({.5, .5, .5})}) {
      const HeadOn r = headOn(shape, 20, ratio, 4);
      EXPECT_TRUE(test::near(r.momentum, Vec3{20, 0, 0}, .04 * 20)) << ratio << ": " << r.momentum.x;
    }
}

TEST(HeadOnImpact, WithRestitutionSeparatesAtThatShareOfTheClosingSpeed) {
  for (const double e : {.5, 1.}) {
    const HeadOn r = headOn(Shape::sphere(.5), 2, 1, 20, e);
    EXPECT_NEAR(r.second.x - r.first.x, 2 * e, .05 * 2);
    EXPECT_TRUE(test::near(r.momentum, Vec3{2, 0, 0}, .01));
  }
}

/// Largest upward speed after the drop of a sphere from `height` above touching.
double reboundSpeed(double height, double restitution, int iterations) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  BodyDef ball = test::body(Shape::sphere(.5), {0, 0, .5 + height});
  ball.material.restitution = restitution;
  scene.bodies.push_back(ball);
  World world(scene, options(iterations));
  double fastest = 0;
  for (int i = 0; i < 90; ++i) {
    world.step();
    fastest = std::max(fastest, world.state(world.bodyAt(1)).velocity.z);
  }
  return fastest;
}

TEST(Rebound, HasHalfTheSpeedForRestitutionOneHalf) {
  // the impact speed is known up to a step of gravity
  const double speed = std::sqrt(2 * 10 * 2.);
  EXPECT_NEAR(reboundSpeed(2, .5, 10), .5 * speed, .05 * .5 * speed);
  // one point converges by halves: 1/16 of the change of speed is missing after four
  EXPECT_NEAR(reboundSpeed(2, .5, 4), .5 * speed, .1 * .5 * speed);
}

TEST(Rebound, WithoutRestitutionIsSmall) {
  for (const int iterations : {4, 10}) EXPECT_LT(reboundSpeed(1, 0, iterations), .25) << iterations;
}

TEST(Rest, ADroppedBoxComesToRestTouching) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::unitCube({0, 0, .515}));
  World world(scene, options(4));
  test::run(world, 120);
  EXPECT_NEAR(world.state(world.bodyAt(1)).position.z, .5, 1e-3);
  EXPECT_LT(world.quality().maxSpeed, 1e-3);
}

TEST(Stack, OfTenStandsTenSecondsAtFourIterations) {
  World world(test::tower(10), options(4));
  test::run(world, 600);
  const BodyState top = world.state(world.bodyAt(10));
  EXPECT_NEAR(top.position.z, 9.5, .05);
  EXPECT_LT(std::hypot(top.position.x, top.position.y), .05);
  EXPECT_LT(world.quality().maxSpeed, .01);
}

TEST(Stack, FallsFreelyWhenItsSupportIsRemoved) {
  Scene scene = test::tower(10);
  scene.bodies[0].shape = Shape::box({2, 2, .5});
  scene.bodies[0].position = {0, 0, -.5};
  World world(scene, options(4));
  test::run(world, 120);
  std::vector<double> before;
  for (int i = 1; i <= 10; ++i) before.push_back(world.state(world.bodyAt(i)).position.z);
  world.removeBody(world.bodyAt(0));
  test::run(world, 30);
  const double fall = 10 * kDt * kDt * 30 * 31 / 2;
  for (int i = 1; i <= 10; ++i) {
    const double own = before[static_cast<std::size_t>(i - 1)] - world.state(world.bodyAt(i)).position.z;
    EXPECT_GE(own, .8 * fall) << i;
    // the load of the last step pushes the lowest ones a little
    EXPECT_LE(own, 1.1 * fall) << i;
  }
}

TEST(Stack, CarriesItsWeightThroughEveryContact) {
  World world(test::tower(5), options(20));
  test::run(world, 300);
  std::vector<double> load(6, 0);
  for (const ContactPoint& c : world.contacts()) load[static_cast<std::size_t>(c.b.index)] += c.force.z;
  for (int i = 1; i <= 5; ++i) EXPECT_NEAR(load[static_cast<std::size_t>(i)], 10. * (6 - i), .3) << i;
}

TEST(Chain, CutFallsFreely) {
  Scene scene = test::emptyScene();
  for (int i = 0; i < 10; ++i) {
    BodyDef link = test::body(Shape::box({.05, .05, .25}), {0, 0, -.25 - .5 * i});
    scene.bodies.push_back(link);
    scene.joints.push_back(i == 0 ? test::ball(0, {0, 0, .25}, kWorld, {0, 0, 0})
                                  : test::ball(i, {0, 0, .25}, i - 1, {0, 0, -.25}));
  }
  World world(scene, options(4));
  test::run(world, 240);
  EXPECT_LT(world.quality().jointGapMax, .01);
  const double before = world.state(world.bodyAt(9)).position.z;
  world.removeJoint(world.joints()[0]);
  test::run(world, 30);
  const double fall = 10 * kDt * kDt * 30 * 31 / 2;
  EXPECT_NEAR(before - world.state(world.bodyAt(9)).position.z, fall, .1 * fall);
}

}  // namespace
}  // namespace rubble
