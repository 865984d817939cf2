/// How deep thin bodies rest in what bears them and what weighs on them.
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

/// A tile of half thickness `half` that lies on the ground, and a cube on it.
Scene tileUnderCube(Random& random, double half, double ratio) {
  const double width = half * random.uniform(1, 20), edge = width * random.uniform(1, 4);
  Scene scene = test::emptyScene({0, 0, -10});
  scene.bodies.push_back(test::ground());
  const Shape shape = random.below(2) ? Shape::box({width, width, half}) : Shape::cylinder(width, half);
  BodyDef tile = test::body(shape, {0, 0, half});
  tile.density = 1000;
  scene.bodies.push_back(tile);
  BodyDef cube = test::body(Shape::box({edge, edge, edge}), {0, 0, 2 * half + edge});
  cube.density = ratio * massProperties(tile.shape, 1000).mass / (8 * edge * edge * edge);
  scene.bodies.push_back(cube);
  return scene;
}

/// Depth of the deepest contact in the last second of five, over the thickness of the tile.
double restingDepth(const Scene& scene, double half, double dt, int iterations) {
  WorldOptions o = test::options(iterations);
  o.params.dt = dt;
  World world(scene, o);
  const auto steps = static_cast<int>(std::lround(5 / dt));
  double deepest = 0;
  for (int i = 0; i < steps; ++i) {
    world.step();
    if (i < steps - static_cast<int>(std::lround(1 / dt))) continue;
    for (const ContactPoint& c : world.contacts()) deepest = std::max(deepest, c.depth / (2 * half));
  }
  return deepest;
}

TEST(ThinBodies, RestNoDeeperThanATwentiethOfTheirThickness) {
  for (int seed = 0; seed < 200; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const double half = random.logUniform(.0005, .1), ratio = random.logUniform(1, 1000);
    const double dt = random.below(2) ? 1. / 60 : 1. / 30;
    const int iterations = random.below(2) ? 4 : 10;
    EXPECT_LT(restingDepth(tileUnderCube(random, half, ratio), half, dt, iterations), .05)
        << "seed " << seed << " half " << half << " ratio " << ratio << " dt " << dt << " iterations "
        << iterations;
  }
}

/// A body of millimetres that falls by a part of its size.
Scene smallOverHuge(Random& random, double size) {
  Scene scene = test::emptyScene({0, 0, -10});
  const double half = random.uniform(.2, 2);
  BodyDef floor = test::body(Shape::box({half, half * random.uniform(.5, 1), half}), {0, 0, -half});
  floor.motion = Motion::Static;
  scene.bodies.push_back(floor);
  std::vector<Vec3> corners;
  for (int k = 0; k < 12; ++k) corners.push_back(size / 2 * random.direction());
  const double thin = size * random.uniform(.1, .4);
  const std::array shapes = {Shape::hull(corners), Shape::box({size / 2, size / 3, thin}, thin / 4),
                             Shape::cylinder(size / 2, thin), Shape::cone(size / 3, thin)};
  BodyDef def = test::body(shapes[static_cast<std::size_t>(random.below(4))], {0, 0, size});
  def.position = {half * random.uniform(-.4, .4), half * random.uniform(-.4, .4), size};
  def.orientation = random.rotation();
  scene.bodies.push_back(def);
  return scene;
}

TEST(ThinBodies, LieOnWhatIsAThousandTimesAsLarge) {
  for (int seed = 0; seed < 200; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const double size = random.logUniform(.002, .01);
    WorldOptions o = test::options(4);
    o.params.dt = random.below(2) ? 1. / 60 : 1. / 30;
    World world(smallOverHuge(random, size), o);
    const Vec3 center = world.massOf(world.bodyAt(1)).center;
    double lowest = size;
    for (int i = 0; i < 150; ++i) {
      world.step();
      const BodyState body = world.state(world.bodyAt(1));
      lowest = std::min(lowest, (body.position + rotate(body.orientation, center)).z);
    }
    EXPECT_GT(lowest, 0) << "seed " << seed;
  }
}

}  // namespace
}  // namespace rubble
