/// Bodies whose motion per step exceeds their thickness: at what CCD stops them, its cost, and the energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::Random;

enum class Floor { Plane, Box, Mesh, Heights };
constexpr std::array kFloors = {Floor::Plane, Floor::Box, Floor::Mesh, Floor::Heights};

/// A floor whose top is at z = 0.
BodyDef floorOf(Floor kind) {
  BodyDef def;
  def.motion = Motion::Static;
  constexpr double kHalf = 20;
  if (kind == Floor::Plane) def.shape = Shape::plane();
  if (kind == Floor::Box) def.shape = Shape::box({kHalf, kHalf, .05}), def.position = {0, 0, -.05};
  if (kind == Floor::Mesh) {
    const std::vector<Vec3> corners = {
        {-kHalf, -kHalf, 0}, {kHalf, -kHalf, 0}, {kHalf, kHalf, 0}, {-kHalf, kHalf, 0}};
    def.shape = Shape::mesh(corners, {{0, 1, 2}, {0, 2, 3}});
  }
  if (kind == Floor::Heights) {
    constexpr int kSamples = 9;
    def.shape = Shape::heightField(kSamples, kSamples,
                                   {2 * kHalf / (kSamples - 1), 2 * kHalf / (kSamples - 1), 0},
                                   std::vector<double>(kSamples * kSamples, 0));
    def.position = {-kHalf, -kHalf, 0};
  }
  return def;
}

/// A stopped body has made only a part of its motion, and gravity has worked on that part alone, on any
/// floor.
TEST(FastBodies, GainNoEnergyWhereTheyStop) {
  Random random(1);
  int stopped = 0;
  for (int i = 0; i < 80; ++i) {
    const Floor kind = kFloors[static_cast<std::size_t>(i) % kFloors.size()];
    Scene scene = test::emptyScene({0, 0, -10});
    scene.bodies.push_back(floorOf(kind));
    BodyDef body;
    const double size = random.logUniform(.01, .3);
    body.shape = i % 2 == 0 ? Shape::sphere(size) : Shape::box({size, size, size});
    const double speed = random.logUniform(40 * size, 60);
    body.position = {.3, .2, 2 * size + random.uniform(.2, 2) * speed / 30};
    body.velocity = {random.uniform(-1, 1), 0, -speed};
    scene.bodies.push_back(body);
    WorldOptions options = test::options(4);
    options.params.dt = 1. / 30;
    World world(scene, options);
    const auto energy = [&] {
      const Quality q = world.quality();
      return q.kineticEnergy + q.potentialEnergy;
    };
    const double start = energy(), scale = world.quality().kineticEnergy;
    for (int n = 0; n < 20; ++n) {
      stopped += world.step().stoppedBodies;
      EXPECT_LE(energy() - start, 1e-5 * scale) << "case " << i << " step " << n;
    }
  }
  EXPECT_GT(stopped, 20);
}

/// The swept box of a body at rest is no larger than the body. An impact moves it farther within the step.
TEST(FastBodies, WhatIsStruckDoesNotPassWhatItIsDrivenInto) {
  Random random(2);
  for (int i = 0; i < 120; ++i) {
    const Floor kind = kFloors[static_cast<std::size_t>(i) % kFloors.size()];
    Scene scene = test::emptyScene({0, 0, 0});
    scene.bodies.push_back(floorOf(kind));
    BodyDef ball;
    ball.shape = Shape::sphere(.02);
    ball.density = 500;
    ball.position = {.3, .2, random.uniform(.05, .5)};
    scene.bodies.push_back(ball);
    BodyDef hammer;
    hammer.shape = i % 3 == 0 ? Shape::box({.1, .1, .1}) : Shape::sphere(.1);
    hammer.density = 8000;
    hammer.position = ball.position + Vec3{0, 0, .02 + .1 + random.uniform(.001, .05)};
    hammer.velocity = {0, 0, -random.uniform(3, 40)};
    scene.bodies.push_back(hammer);
    World world(scene, test::options(i % 2 == 0 ? 4 : 10));
    for (int n = 0; n < 30; ++n) {
      world.step();
      ASSERT_GT(world.state(world.bodyAt(1)).position.z, -.01) << "case " << i << " step " << n;
    }
  }
}

/// Bodies that fall side by side do not meet, however fast.
TEST(FastBodies, CloudFindsFewPairsHoweverFastItFalls) {
  constexpr int kWide = 10;
  for (const double speed : {0., 50., 500.}) {
    Random random(3);
    Scene scene = test::emptyScene({0, 0, -10});
    scene.bodies.push_back(test::ground());
    for (int k = 0; k < kWide * kWide * kWide; ++k) {
      BodyDef pebble;
      pebble.shape = Shape::sphere(.01);
      const Vec3 cell{double(k % kWide), double(k / kWide % kWide), double(k / kWide / kWide)};
      pebble.position = .05 * cell + random.vector(.01) + Vec3{0, 0, 200};
      pebble.velocity = {0, 0, -speed};
      scene.bodies.push_back(pebble);
    }
    World world(scene, test::options(4));
    const StepReport report = world.step();
    // at most those above and below in its column
    EXPECT_LE(report.pairs, 10 * kWide * kWide * kWide) << speed;
    EXPECT_EQ(report.stoppedBodies, 0);
  }
}

}  // namespace
}  // namespace rubble
