/// Restitution: ladders of bounces, chains of balls, what is conserved.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::kGravity;

constexpr double kHeight = 2;

WorldOptions optionsAt(double dt, int iterations = 4) {
  WorldOptions o = test::options(iterations);
  o.params.dt = dt;
  return o;
}

/// What falls flat on the ground, and the height of its center there.
struct Dropped {
  const char* name;
  Shape shape;
  double rest;
  Quat orientation{};
};
const Dropped kDropped[] = {{"sphere", Shape::sphere(.5), .5},
                            {"box", Shape::box({.4, .3, .2}), .2},
                            {"capsule", Shape::capsule(.2, .3), .2, fromAxisAngle({0, 1, 0}, std::acos(0.))}};

/// Highest places of the center above its place of rest: of the drop, then after each impact.
std::vector<double> apexes(const Dropped& d, double e, double dt, int bounces, int iterations) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::body(d.shape, {0, 0, d.rest + kHeight}));
  scene.bodies.back().orientation = d.orientation;
  scene.bodies.back().material.restitution = e;
  World world(scene, optionsAt(dt, iterations));
  std::vector<double> found{kHeight};
  bool rises = false;
  double highest = 0;
  for (int i = 0; i * dt < 10 && static_cast<int>(found.size()) <= bounces; ++i) {
    world.step();
    const BodyState now = world.state(world.bodyAt(1));
    if (now.velocity.z > 0)
      rises = true, highest = std::max(highest, now.position.z - d.rest);
    else if (rises)
      found.push_back(highest), rises = false, highest = 0;
  }
  return found;
}

TEST(Bounces, ReachTheHeightsOfTheRestitution) {
  for (const Dropped& d : kDropped)
    for (const double e : {.1, .3, .5, .8, 1.})
      for (const double dt : {1. / 60, 1. / 240})
        for (const int iterations : {4, 10}) {
          const std::vector<double> found = apexes(d, e, dt, 4, iterations);
          // below this speed a contact is at rest
          const double least = std::max(.3 * std::sqrt(kGravity * 2 * .5), 2 * kGravity * dt),
                       speed = std::sqrt(2 * kGravity * kHeight);
          double expected = kHeight;
          for (std::size_t n = 1; n < found.size(); ++n) {
            if (std::pow(e, static_cast<double>(n) - 1) * speed < 1.2 * least) break;
            expected *= e * e;
            EXPECT_NEAR(found[n], expected, .03 * expected + .5 * std::sqrt(2 * kGravity * expected) * dt)
                << d.name << " e " << e << " dt " << dt << " bounce " << n << " iterations " << iterations;
          }
          EXPECT_GE(found.size(), 2u) << d.name << " e " << e << " dt " << dt;
        }
}

TEST(Bounces, WithoutRestitutionThereAreNone) {
  for (const Dropped& d : kDropped)
    for (const double dt : {1. / 60, 1. / 240})
      for (const double apex : apexes(d, 0, dt, 3, 10))
        EXPECT_TRUE(apex == kHeight || apex < 5e-3) << d.name << " " << apex;
}

TEST(Bounces, AtRestThereAreNoneAtAnySize) {
  for (const double size : {1e-3, 1., 1e3})
    for (const double gravity : {10., 1000.}) {
      Scene scene = test::emptyScene({0, 0, -gravity});
      scene.bodies.push_back(test::ground());
      for (int i = 0; i < 4; ++i) {
        scene.bodies.push_back(test::body(Shape::box(size * Vec3{.5, .5, .5}), size * Vec3{0, 0, .5 + i}));
        scene.bodies.back().material.restitution = 1;
      }
      const double unit = std::sqrt(size / gravity);
      World world(scene, optionsAt(.05 * unit));
      double fastest = 0;
      for (int i = 0; i < 200; ++i) {
        world.step();
        fastest = std::max(fastest, world.quality().maxSpeed);
      }
      EXPECT_LT(fastest, .02 * std::sqrt(gravity * size)) << size << " " << gravity;
    }
}

/// A row of balls along x, with `gap` radii between them; the first `moving` come with 1 m/s. Velocities
/// along x after half a second.
std::vector<double> rowOfBalls(int balls, int moving, double gap, double e, int iterations,
                               double radius = .1) {
  Scene scene = test::emptyScene({0, 0, 0});
  double x = 0;
  for (int i = 0; i < balls; ++i) {
    scene.bodies.push_back(test::body(Shape::sphere(radius), {x, 0, 0}, .3));
    scene.bodies.back().material.restitution = e;
    if (i < moving) scene.bodies.back().velocity = {1, 0, 0};
    x += 2 * radius + (i + 1 < moving ? 0 : i + 1 == moving ? .05 : gap * radius);
  }
  World world(scene, optionsAt(1. / 60, iterations));
  test::run(world, 60);
  std::vector<double> out;
  for (int i = 0; i < balls; ++i) out.push_back(world.state(world.bodyAt(i)).velocity.x);
  return out;
}

TEST(Chains, OfTouchingBallsHandTheSpeedToTheLast) {
  for (const int iterations : {4, 10})
    for (const int moving : {1, 2, 3})
      for (const double gap : {0., .03, .5}) {
        const std::vector<double> v = rowOfBalls(5, moving, gap, 1, iterations);
        for (int i = 0; i < 5; ++i) {
          const bool leaves = i >= 5 - moving;
          // balls that come in touch share a step before they strike: few iterations leave it unfinished
          const double tolerance = !leaves || moving == 1 ? .03 : iterations == 10 ? .025 : .1;
          EXPECT_NEAR(v[static_cast<std::size_t>(i)], leaves ? 1 : 0, tolerance)
              << moving << " gap " << gap << " ball " << i;
        }
      }
}

TEST(Chains, HungOnRodsHandTheSwingToTheLast) {
  Scene scene = test::emptyScene();
  constexpr double kRadius = .1, kLength = 1;
  for (int i = 0; i < 5; ++i) {
    const double angle = i == 0 ? -.5 : 0;
    BodyDef ball = test::body(Shape::sphere(kRadius),
                              {2 * kRadius * i + kLength * std::sin(angle), 0, -kLength * std::cos(angle)},
                              0);
    ball.material.restitution = 1;
    scene.bodies.push_back(ball);
    JointDef rod = test::ball(i, {0, 0, 0}, kWorld, {2 * kRadius * i, 0, 0});
    rod.type = JointType::Distance;
    rod.length = kLength;
    scene.joints.push_back(rod);
  }
  World world(scene, optionsAt(1. / 240, 10));
  double farthest = 0, others = 0;
  bool struck = false;
  for (int i = 0; i < 240; ++i) {
    world.step();
    farthest = std::max(farthest, world.state(world.bodyAt(4)).position.x - 8 * kRadius);
    struck |= world.state(world.bodyAt(4)).velocity.x > .5;
    if (struck && farthest < .2)
      for (int b = 0; b < 4; ++b)
        others = std::max(others, std::abs(world.state(world.bodyAt(b)).velocity.x));
  }
  EXPECT_NEAR(farthest, kLength * std::sin(.5), .06 * kLength * std::sin(.5));
  EXPECT_LT(others, .05);
}

TEST(Chains, OfTwoUnequalBallsFollowTheClosedForm) {
  for (const double ratio : {.01, .5, 3., 100.})
    for (const double e : {0., .4, 1.}) {
      Scene scene = test::emptyScene({0, 0, 0});
      for (int i = 0; i < 2; ++i)
        scene.bodies.push_back(test::body(Shape::sphere(.5), {1.3 * i, 0, 0})),
            scene.bodies.back().material.restitution = e;
      scene.bodies[0].mass = 1, scene.bodies[1].mass = ratio;
      scene.bodies[0].velocity = {3, 0, 0};
      World world(scene, optionsAt(1. / 60));
      test::run(world, 30);
      const double tolerance = e > 0 ? 3e-3 : .1;
      EXPECT_NEAR(world.state(world.bodyAt(0)).velocity.x, 3 * (1 - ratio * e) / (1 + ratio), tolerance)
          << ratio << " " << e;
      EXPECT_NEAR(world.state(world.bodyAt(1)).velocity.x, 3 * (1 + e) / (1 + ratio),
                  tolerance * std::max(1., 1 / ratio))
          << ratio << " " << e;
    }
}

TEST(Bounces, BetweenClosingWallsGainTwiceTheirSpeedEachTime) {
  constexpr double kWall = .5, kStart = 4;
  Scene scene = test::emptyScene({0, 0, 0});
  for (const double side : {-1., 1.}) {
    scene.bodies.push_back(test::body(Shape::box({.5, 2, 2}), {side * 3.5, 0, 0}, 0));
    scene.bodies.back().motion = Motion::Kinematic;
    scene.bodies.back().velocity = {-side * kWall, 0, 0};
  }
  scene.bodies.push_back(test::body(Shape::sphere(.25), {0, 0, 0}, 0));
  scene.bodies.back().material.restitution = 1;
  scene.bodies.back().velocity = {kStart, 0, 0};
  World world(scene, optionsAt(1. / 240));
  int bounces = 0;
  double sign = 1;
  for (int i = 0; i < 840; ++i) {
    world.step();
    const double v = world.state(world.bodyAt(2)).velocity.x;
    if (v * sign < 0) sign = -sign, ++bounces;
    EXPECT_NEAR(std::abs(v), kStart + 2 * kWall * bounces, 1e-3) << i;
  }
  EXPECT_GE(bounces, 4);
}

struct Sums {
  Vec3 momentum;
  double energy;
};
Sums sumsOf(const World& world, int bodies, const Vec3& gravity) {
  Sums out{};
  for (int i = 0; i < bodies; ++i) {
    const BodyId id = world.bodyAt(i);
    const BodyState s = world.state(id);
    const MassProperties mass = world.massOf(id);
    const Vec3 w = rotateInverse(s.orientation, s.angularVelocity);
    out.momentum += mass.mass * s.velocity;
    out.energy += .5 * mass.mass * dot(s.velocity, s.velocity) +
                  .5 * dot(w, Vec3{mass.inertia.x * w.x, mass.inertia.y * w.y, mass.inertia.z * w.z}) -
                  mass.mass * dot(gravity, s.position);
  }
  return out;
}

TEST(Bounces, OfFreeClustersKeepMomentumAndMakeNoEnergy) {
  for (int seed = 0; seed < 20; ++seed) {
    test::Random random(seed);
    Scene scene = test::emptyScene({0, 0, 0});
    constexpr int kBodies = 27;
    for (int i = 0; i < kBodies; ++i) {
      const Shape shape = seed % 2 == 0 || i % 2 == 0 ? Shape::sphere(.3) : Shape::box({.25, .2, .3});
      BodyDef def = test::body(shape,
                               Vec3{.62 * (i % 3), .62 * (i / 3 % 3), .62 * (i / 9)} + random.vector(.005),
                               seed % 4 < 2 ? 0 : .5);
      def.mass = random.uniform(.2, 5);
      def.velocity = random.vector(3);
      def.material.restitution = random.uniform(0, 1);
      scene.bodies.push_back(def);
    }
    World world(scene, optionsAt(1. / 60, 10));
    const Sums start = sumsOf(world, kBodies, {});
    double energy = start.energy;
    for (int i = 0; i < 90; ++i) {
      world.step();
      const Sums now = sumsOf(world, kBodies, {});
      EXPECT_LT(now.energy, energy * 1.001) << seed << " step " << i;
      energy = now.energy;
    }
    const double exchanged = 27 * 2 * 3.;
    EXPECT_LT(length(sumsOf(world, kBodies, {}).momentum - start.momentum), 1e-2 * exchanged) << seed;
  }
}

TEST(Bounces, OfASpinningBallKeepItsAngularMomentumAboutThePoint) {
  constexpr double kRadius = .2;
  for (const double e : {.5, 1.}) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::ground(.5));
    BodyDef ball = test::body(Shape::sphere(kRadius), {0, 0, 1}, .5);
    ball.material.restitution = e, ball.mass = 1;
    ball.angularVelocity = {0, 20, 0};
    scene.bodies.push_back(ball);
    World world(scene, optionsAt(1. / 240, 10));
    test::run(world, 120);
    const BodyState s = world.state(world.bodyAt(1));
    const double inertia = .4 * kRadius * kRadius;
    EXPECT_GT(s.velocity.x, .1);
    EXPECT_NEAR(s.velocity.x * kRadius + inertia * s.angularVelocity.y, inertia * 20, .01 * inertia * 20);
    EXPECT_LE(s.velocity.x, 20 * kRadius * 2 / 7 * 1.01);
  }
}

TEST(Bounces, OnABallAtRestOnTheGroundSetBothInMotion) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground(0));
  for (const double z : {.5, 3.}) {
    scene.bodies.push_back(test::body(Shape::sphere(.5), {0, 0, z}, 0));
    scene.bodies.back().material.restitution = 1;
  }
  World world(scene, optionsAt(1. / 240, 10));
  double highest = 0;
  for (int i = 0; i < 240; ++i) {
    world.step();
    if (world.state(world.bodyAt(2)).velocity.z > 0)
      highest = std::max(highest, world.state(world.bodyAt(2)).position.z);
  }
  // the lower one takes the speed, gives it to the ground and hands it back
  EXPECT_NEAR(highest, 3, .1);
  EXPECT_NEAR(world.state(world.bodyAt(1)).position.z, .5, .02);
}

TEST(Bounces, OnWhatJointsHoldMakeNoEnergy) {
  for (const double mass : {.1, 1., 20.}) {
    Scene scene = test::emptyScene({0, 0, 0});
    BodyDef door = test::body(Shape::box({.05, .5, .5}), {0, 0, 0});
    door.mass = mass;
    BodyDef ball = test::body(Shape::sphere(.2), {-1, .3, 0});
    ball.mass = 1, ball.velocity = {4, 0, 0}, ball.material.restitution = .8;
    scene.bodies = {door, ball};
    JointDef hinge = test::ball(0, {0, -.5, 0}, kWorld, {0, -.5, 0});
    hinge.type = JointType::Hinge;
    hinge.frameA = hinge.frameB = frameAlong({0, 0, 1});
    scene.joints.push_back(hinge);
    World world(scene, optionsAt(1. / 60));
    const double start = sumsOf(world, 2, {}).energy;
    double before = 0;
    for (int i = 0; i < 60; ++i) {
      before = world.state(world.bodyAt(1)).velocity.x;
      world.step();
      EXPECT_LT(sumsOf(world, 2, {}).energy, start * 1.01) << mass << " step " << i;
    }
    // as of a bar about its end: J = (1 + e) v / (1 / m + r^2 / I)
    const double r = .8, inertia = mass * (.5 * .5 / 3 + .05 * .05 / 3 + .25),
                 free = 4 - (1.8 * 4) / (1 + r * r / inertia);
    EXPECT_NEAR(before, free, .25 * 4) << mass;
  }
}

}  // namespace
}  // namespace rubble
