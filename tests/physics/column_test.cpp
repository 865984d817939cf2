/// Tall columns at 4 iterations: how far they sink, what they bear, and that nothing holds them up.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kIterations = 4, kLevels = 100, kSteps = 300;

WorldOptions columnOptions() { return test::options(kIterations); }

double heightOf(const World& world, int body) { return world.state(world.bodyAt(body)).position.z; }
double sunk(const World& world, const Scene& scene, int body) {
  return scene.bodies[std::size_t(body)].position.z - heightOf(world, body);
}

/// Cubes of 0.5 to 2 m, each turned about the vertical at random.
Scene randomColumn(int levels) {
  std::mt19937 random(3);
  const auto number = [&] { return static_cast<double>(random() - random.min()) / random.max(); };
  Scene scene = test::emptyScene();
  scene.bodies = {test::ground()};
  double top = 0;
  for (int i = 0; i < levels; ++i) {
    const double half = .25 + .75 * number();
    BodyDef cube = test::body(Shape::box({half, half, half}), {0, 0, top + half});
    cube.orientation = fromAxisAngle({0, 0, 1}, 3 * number());
    scene.bodies.push_back(cube);
    top += 2 * half;
  }
  return scene;
}

TEST(Column, OfAHundredCubesSinksByLessThanTwentyMillimetres) {
  const Scene scene = test::tower(kLevels);
  World world(scene, columnOptions());
  test::run(world, kSteps);
  EXPECT_NEAR(sunk(world, scene, kLevels), 0, .02);
}

TEST(Column, BearsAThousandTimesTheMassOfItsCubes) {
  constexpr int kLight = 40;
  Scene scene = test::tower(kLight + 1);
  scene.bodies.back().mass = 1000;
  World world(scene, columnOptions());
  test::run(world, kSteps);
  EXPECT_NEAR(sunk(world, scene, kLight + 1), 0, .06);
}

TEST(Column, OfTenBearsAThousandAndTenThousandTimesTheirMass) {
  constexpr int kLight = 10, kTenSeconds = 600;
  for (const auto& [mass, most] : {std::pair{1e3, .01}, std::pair{1e4, .02}}) {
    Scene scene = test::tower(kLight + 1);
    scene.bodies.back().mass = mass;
    World world(scene, columnOptions());
    test::run(world, kTenSeconds);
    EXPECT_NEAR(sunk(world, scene, kLight + 1), 0, most) << mass;
  }
}

TEST(Column, OfRandomCubesStands) {
  const Scene scene = randomColumn(kLevels);
  World world(scene, columnOptions());
  test::run(world, kSteps);
  for (int i = 1; i <= kLevels; ++i) {
    EXPECT_NEAR(sunk(world, scene, i), 0, .02) << i;
    const Vec3 at = world.state(world.bodyAt(i)).position;
    EXPECT_LT(std::hypot(at.x, at.y), .02) << i;
  }
}

TEST(Column, StandsWhereTheLargestCellsOfAggregatesMeet) {
  // 2^19 g dt^2 is the edge of these cells for unit cubes, and the origin lies two thirds of it inside its
  // cell
  const double edge = std::ldexp(10. / 3600, 19), aside = .001;
  Scene scene = test::tower(kLevels);
  for (int i = 1; i <= kLevels; ++i)
    scene.bodies[std::size_t(i)].position.x = edge / 3 + (i % 2 == 0 ? aside : -aside);
  World world(scene, columnOptions());
  test::run(world, kSteps);
  EXPECT_NEAR(sunk(world, scene, kLevels), 0, .02);
}

TEST(Column, StandsUnderABridgeOnThreeOfThem) {
  constexpr int kFew = 60, kColumns = 3;
  Scene scene = test::emptyScene();
  scene.bodies = {test::ground()};
  for (int k = 0; k < kColumns; ++k)
    for (int i = 0; i < kFew; ++i) scene.bodies.push_back(test::unitCube({3. * k, 0, .5 + i}));
  scene.bodies.push_back(test::body(Shape::box({4, .5, .25}), {3, 0, kFew + .25}));
  World world(scene, columnOptions());
  test::run(world, kSteps);
  EXPECT_NEAR(sunk(world, scene, kColumns * kFew + 1), 0, .02);
}

TEST(Column, FallsFreelyOnceItsGroundIsGone) {
  constexpr int kFall = 30;
  const Scene scene = test::tower(kLevels);
  World world(scene, columnOptions());
  test::run(world, kSteps);
  world.removeBody(world.bodyAt(0));
  const double dt = world.params().dt, free = 10 * dt * dt * kFall * (kFall + 1) / 2;
  std::vector<double> before;
  for (int i = 1; i <= kLevels; ++i) before.push_back(heightOf(world, i));
  test::run(world, kFall);
  for (int i = 1; i <= kLevels; ++i)
    EXPECT_NEAR((before[std::size_t(i - 1)] - heightOf(world, i)) / free, 1, .02) << i;
}

TEST(Column, ClosesAGapWhereACubeIsTakenOut) {
  constexpr int kFew = 60, kOut = 30;
  const Scene scene = test::tower(kFew);
  World world(scene, columnOptions());
  test::run(world, kSteps / 2);
  world.removeBody(world.bodyAt(kOut));
  test::run(world, kSteps);
  EXPECT_NEAR(sunk(world, scene, kFew), 1, .02);
}

TEST(Column, DoesNotThrowBackACubeOfAHundredTimesTheMass) {
  constexpr double kHeight = 5, kRebound = .2;
  Scene scene = test::tower(kLevels);
  BodyDef cube = test::unitCube({0, 0, kLevels + kHeight + .5});
  cube.mass = 100;
  scene.bodies.push_back(cube);
  World world(scene, columnOptions());
  for (int step = 0; step < kSteps; ++step) {
    world.step();
    EXPECT_LT(world.state(world.bodyAt(kLevels + 1)).velocity.z, kRebound) << step;
  }
  EXPECT_NEAR(sunk(world, scene, kLevels + 1), kHeight, .02);
}

}  // namespace
}  // namespace rubble
