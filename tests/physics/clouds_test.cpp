/// Clouds of small fast bodies: none passes a wall, and none passes another one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::Random;

constexpr double kWallFront = 0, kWallThickness = .02;

/// A cloud before a wall across y, whose bodies have one velocity up to a spread [m/s].
Scene cloud(Random& random, int count, double spread) {
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef wall;
  wall.motion = Motion::Static;
  wall.shape = Shape::box({60, kWallThickness / 2, 60});
  wall.position = {0, kWallFront + kWallThickness / 2, 0};
  scene.bodies.push_back(wall);
  const Vec3 velocity{random.uniform(-50, 50), random.logUniform(20, 300), random.uniform(-50, 50)};
  const double extent = random.logUniform(.15, .6);
  while (static_cast<int>(scene.bodies.size()) <= count) {
    BodyDef grain;
    grain.shape = Shape::sphere(random.logUniform(.004, .015));
    grain.position = Vec3{0, -extent - random.uniform(.03, .06), 0} + random.vector(extent);
    grain.velocity = velocity + random.vector(spread);
    // no rows act in the first step: none touches another one
    const auto touches = [&](const BodyDef& other) {
      return length(other.position - grain.position) < 1.2 * (other.shape.radius + grain.shape.radius);
    };
    if (std::none_of(scene.bodies.begin() + 1, scene.bodies.end(), touches)) scene.bodies.push_back(grain);
  }
  return scene;
}

/// Smallest distance of two centers in a step in which each body moves along a straight line and then, after
/// a fraction of the step, stands still.
double leastDistance(const Vec3& between, const Vec3& moveA, double untilA, const Vec3& moveB,
                     double untilB) {
  const auto at = [&](double t) {
    return between + moveB * std::min(t, untilB) - moveA * std::min(t, untilA);
  };
  const double stop = std::min(untilA, untilB);
  double least = 1e9;
  for (const auto& [begin, end] : {std::pair{0., stop}, std::pair{stop, 1.}}) {
    const Vec3 from = at(begin), way = at(end) - from;
    const double square = dot(way, way), t = square > 0 ? std::clamp(-dot(from, way) / square, 0., 1.) : 0;
    least = std::min(least, length(from + way * t));
  }
  return least;
}

TEST(Clouds, NoBodyPassesAWallOrAnotherBody) {
  constexpr int kCount = 120, kSteps = 12;
  int stopped = 0, blocked = 0;
  for (int i = 0; i < 16; ++i) {
    Random random(static_cast<std::uint64_t>(100 + i));
    constexpr double kSpreads[] = {0, 1, 20, 150};
    const Scene scene = cloud(random, kCount, kSpreads[i % 4]);
    World world(scene, test::options(4));
    const double dt = world.params().dt;
    stopped += world.step().stoppedBodies;
    // each body moves along its velocity until it is stopped
    std::vector<Vec3> move;
    std::vector<double> until;
    for (std::size_t k = 1; k < scene.bodies.size(); ++k) {
      const BodyDef& def = scene.bodies[k];
      move.push_back(dt * def.velocity);
      const Vec3 moved = world.state(world.bodyAt(static_cast<int>(k))).position - def.position;
      until.push_back(length(moved) / length(move.back()));
    }
    for (std::size_t a = 0; a < move.size(); ++a)
      for (std::size_t b = a + 1; b < move.size(); ++b) {
        const BodyDef &defA = scene.bodies[a + 1], &defB = scene.bodies[b + 1];
        const double thin = std::min(defA.shape.radius, defB.shape.radius),
                     touch = defA.shape.radius + defB.shape.radius;
        const Vec3 between = defB.position - defA.position;
        blocked += leastDistance(between, move[a], until[a], move[b], 1) < touch;
        blocked += leastDistance(between, move[a], 1, move[b], until[b]) < touch;
        EXPECT_GT(leastDistance(between, move[a], until[a], move[b], until[b]), touch - thin)
            << "cloud " << i << " bodies " << a + 1 << ", " << b + 1;
      }
    for (int step = 1; step < kSteps; ++step) world.step();
    for (int k = 1; k <= kCount; ++k)
      ASSERT_LT(world.state(world.bodyAt(k)).position.y, kWallFront + kWallThickness / 2)
          << "cloud " << i << " body " << k;
  }
  EXPECT_GT(stopped, 500);
  EXPECT_GT(blocked, 150) << "bodies in the way of others, most of them stopped";
}

/// Two grains fly one behind the other, so they have no pair. The first one touches a block, whose contact
/// stops it; the second one would pass beside the block and must not pass the first.
TEST(Clouds, BodyStoppedByAContactBlocksThoseBehindIt) {
  constexpr double kRadius = .01, kSpeed = 200;
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef block;
  block.motion = Motion::Static;
  block.shape = Shape::box({kRadius, kRadius, kRadius});
  block.position = {0, kRadius, 0};
  scene.bodies.push_back(block);
  for (const Vec3& at : {Vec3{.8 * kRadius, -kRadius, 0}, Vec3{2.1 * kRadius, -11 * kRadius, 0}}) {
    BodyDef grain;
    grain.shape = Shape::sphere(kRadius);
    grain.position = at;
    grain.velocity = {0, kSpeed, 0};
    scene.bodies.push_back(grain);
  }
  World world(scene, test::options(4));
  EXPECT_GE(world.step().stoppedBodies, 1);
  const double first = world.state(world.bodyAt(1)).position.y,
               second = world.state(world.bodyAt(2)).position.y;
  EXPECT_NEAR(first, -kRadius, .1 * kRadius);
  EXPECT_LT(second, first - kRadius);
}

/// A jet of grains at 200 m/s that strikes a wall in its first step, and heaps up on it.
Scene jet(int count) {
  constexpr double kRadius = .005, kGap = 10 * kRadius, kSpeed = 200;
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef wall;
  wall.motion = Motion::Static;
  wall.shape = Shape::box({20, .1, 20});
  wall.position = {0, kWallFront + .1, 0};
  scene.bodies.push_back(wall);
  Random random(5);
  const int wide = static_cast<int>(std::ceil(std::cbrt(count)));
  for (int k = 0; k < count; ++k) {
    BodyDef grain;
    grain.shape = Shape::sphere(kRadius);
    const Vec3 cell(k % wide, -(k / wide % wide) - 2, k / wide / wide);
    grain.position = kGap * cell + random.vector(2 * kRadius);
    grain.velocity = {0, kSpeed, 0};
    scene.bodies.push_back(grain);
  }
  return scene;
}

/// In a heap each grain has a few neighbors, whatever it would pass in a step if it were alone.
TEST(Clouds, GrainsThatHeapUpOnAWallPairWithNeighborsAlone) {
  constexpr int kCount = 1500, kSteps = 6, kNeighbors = 9;
  World world(jet(kCount), test::options(4));
  for (int step = 0; step < kSteps; ++step) {
    const StepReport report = world.step();
    EXPECT_LT(report.pairs, kNeighbors * kCount) << "step " << step;
    EXPECT_GT(report.stoppedBodies, kCount / 2) << "step " << step;
  }
  for (int k = 1; k <= kCount; ++k)
    ASSERT_LT(world.state(world.bodyAt(k)).position.y, kWallFront) << "grain " << k;
}

TEST(Clouds, SnapshotOfAJetThatStrikesAWallGoesOnWithTheSameBits) {
  World world(jet(200), test::options(4)), other(jet(200), test::options(4));
  for (int step = 0; step < 2; ++step) ASSERT_GT(world.step().stoppedBodies, 50);
  other.restore(Snapshot::fromBytes(world.snapshot().bytes()));
  for (int step = 0; step < 3; ++step) world.step(), other.step();
  EXPECT_EQ(world.hash(), other.hash());
}

}  // namespace
}  // namespace rubble
