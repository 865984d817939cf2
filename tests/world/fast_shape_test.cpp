/// Bodies of every kind whose motion per step exceeds their thickness, against plates of every kind. Plates
/// are 1 m wide and 1 cm thick, or a sheet.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::kDt;
/// Top of every plate [m].
constexpr double kTop = .005;

std::vector<Vec3> boxCorners(const Vec3& half) {
  std::vector<Vec3> out;
  for (int k = 0; k < 8; ++k)
    out.push_back({(k & 1) ? half.x : -half.x, (k & 2) ? half.y : -half.y, (k & 4) ? half.z : -half.z});
  return out;
}

/// A sheet of n by n cells, seen from above.
Shape sheet(int n, bool twoSided) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) points.push_back({1. * i / n - .5, 1. * j / n - .5, kTop});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      triangles.push_back({a, a + 1, a + n + 2});
      triangles.push_back({a, a + n + 2, a + n + 1});
    }
  return Shape::mesh(points, triangles, twoSided);
}

/// The distance to a box, on a lattice that goes a cell beyond it.
Shape latticeBox(const Vec3& half, double spacing) {
  std::array<int, 3> counts;
  Vec3 origin;
  for (int k = 0; k < 3; ++k) {
    const int cells = static_cast<int>(std::ceil(half[k] / spacing - 1e-9)) + 1;
    counts[static_cast<std::size_t>(k)] = 2 * cells + 1;
    origin[k] = -cells * spacing;
  }
  std::vector<double> samples;
  for (int z = 0; z < counts[2]; ++z)
    for (int y = 0; y < counts[1]; ++y)
      for (int x = 0; x < counts[0]; ++x) {
        const Vec3 d = abs(origin + spacing * Vec3{1. * x, 1. * y, 1. * z}) - half;
        const Vec3 out{std::max(d.x, 0.), std::max(d.y, 0.), std::max(d.z, 0.)};
        samples.push_back(length(out) + std::min(0., std::max({d.x, d.y, d.z})));
      }
  return Shape::distanceField(counts, origin, spacing, samples);
}

struct Kind {
  std::string name;
  Shape shape;
};

std::vector<Kind> bullets() {
  constexpr double kR = .005;
  return {{"sphere", Shape::sphere(kR)},
          {"box", Shape::box({kR, kR, kR})},
          {"cylinder", Shape::cylinder(kR, kR)},
          {"cone", Shape::cone(kR, kR)},
          {"roundedBox", Shape::box({kR, kR, kR}, kR / 4)},
          {"hull", Shape::hull(boxCorners({kR, kR, kR}))},
          {"compound",
           Shape::compound({{Shape::sphere(kR), {-kR, 0, 0}, {}}, {Shape::sphere(kR), {kR, 0, 0}, {}}})}};
}

std::vector<Kind> plates() {
  return {{"box", Shape::box({.5, .5, kTop})},
          {"hull", Shape::hull(boxCorners({.5, .5, kTop}))},
          {"cylinder", Shape::cylinder(.5, kTop)},
          {"compound", Shape::compound({{Shape::box({.25, .5, kTop}), {-.25, 0, 0}, {}},
                                        {Shape::box({.25, .5, kTop}), {.25, 0, 0}, {}}})},
          {"mesh", sheet(7, false)},
          {"twoSidedMesh", sheet(7, true)},
          {"heights", Shape::heightField(8, 8, {1. / 7, 1. / 7, 0}, std::vector<double>(64, kTop))},
          {"lattice", latticeBox({.5, .5, kTop}, .01)}};
}

struct ShapeShot {
  Kind bullet, plate;
  double degrees;
};

class FastShape : public testing::TestWithParam<ShapeShot> {};

TEST_P(FastShape, DoesNotPassAPlate) {
  const ShapeShot& shot = GetParam();
  constexpr double kSpeed = 1000, kDistance = 11.7;
  const double angle = shot.degrees * std::numbers::pi / 180;
  const Vec3 d{std::sin(angle), .02, -std::cos(angle)};
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef plate = test::body(shot.plate.shape, {});
  plate.motion = Motion::Static;
  if (shot.plate.name == "heights") plate.position = {-.5, -.5, 0};
  scene.bodies.push_back(plate);
  BodyDef bullet = test::body(shot.bullet.shape, -kDistance * d);
  bullet.density = 11340;
  bullet.velocity = kSpeed * d;
  bullet.orientation = fromAxisAngle(normalize(Vec3{1, 2, 3}), .7);
  scene.bodies.push_back(bullet);
  World world(scene, test::options(4));
  int stops = 0;
  for (int i = 0; i < static_cast<int>(kDistance / kSpeed / kDt) + 12; ++i) {
    stops += world.step().stoppedBodies;
    const Vec3 x = world.state(world.bodyAt(1)).position;
    if (std::fabs(x.x) < .5 && std::fabs(x.y) < .5) {
      EXPECT_GT(x.z, .6 * kTop) << i;
    }
  }
  EXPECT_GE(stops, 1);
  EXPECT_GT(world.state(world.bodyAt(1)).velocity.z, -.005 * kSpeed);
}

std::vector<ShapeShot> shapeShots() {
  std::vector<ShapeShot> all;
  for (const Kind& bullet : bullets())
    for (const Kind& plate : plates())
      for (const double degrees : {0., 60.}) all.push_back({bullet, plate, degrees});
  return all;
}
INSTANTIATE_TEST_SUITE_P(Shots, FastShape, testing::ValuesIn(shapeShots()),
                         [](const testing::TestParamInfo<ShapeShot>& info) {
                           return info.param.bullet.name + "_on_" + info.param.plate.name +
                                  (info.param.degrees == 0 ? "_upright" : "_slanting");
                         });

/// A bullet at 1000 m/s along d from x; body 1.
Scene flight(const Shape& plate, const Vec3& platePosition, const Shape& bullet, const Vec3& x,
             const Vec3& d) {
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef still = test::body(plate, platePosition);
  still.motion = Motion::Static;
  scene.bodies.push_back(still);
  BodyDef fast = test::body(bullet, x, 0);
  fast.density = 11340;
  fast.velocity = 1000 * d;
  scene.bodies.push_back(fast);
  return scene;
}

TEST(FastShapeNearMiss, IsNotTouched) {
  // 1 mm beside the edge of the plate
  for (const Kind& plate : plates()) {
    if (plate.name == "heights" || plate.name == "cylinder") continue;
    for (const Kind& bullet : bullets()) {
      if (bullet.name != "cylinder" && bullet.name != "hull") continue;
      for (const double start : {.02, 3.3, 16.}) {
        World world(flight(plate.shape, {}, bullet.shape, {.506, 0, start}, {0, 0, -1}), test::options(4));
        test::run(world, 3);
        EXPECT_TRUE(test::near(world.state(world.bodyAt(1)).velocity, Vec3{0, 0, -1000}, .1))
            << plate.name << " " << bullet.name << " " << start;
        EXPECT_TRUE(test::near(world.state(world.bodyAt(1)).position, Vec3{.506, 0, start - 50}, 1e-2))
            << plate.name << " " << bullet.name << " " << start;
      }
    }
  }
}

TEST(FastShape, FliesThroughTheBackOfAOneSidedMesh) {
  World world(flight(sheet(7, false), {}, Shape::cylinder(.005, .005), {0, 0, -5}, {0, 0, 1}),
              test::options(4));
  test::run(world, 3);
  EXPECT_TRUE(test::near(world.state(world.bodyAt(1)).position, Vec3{0, 0, 45}, 1e-2));
}

TEST(FastShape, IsHeldByTheBackOfATwoSidedMesh) {
  World world(flight(sheet(7, true), {}, Shape::cylinder(.005, .005), {0, 0, -5}, {0, 0, 1}),
              test::options(4));
  for (int i = 0; i < 12; ++i) {
    world.step();
    EXPECT_LT(world.state(world.bodyAt(1)).position.z, kTop) << i;
  }
}

TEST(FastShape, SlidesOverTheSeamsOfAMesh) {
  // 10 m in each of two steps along a floor of triangles, resting on it: no edge within the floor stops it
  for (const Kind& bullet : bullets()) {
    if (bullet.name == "cone" || bullet.name == "compound") continue;
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> triangles;
    for (int i = 0; i <= 100; ++i) points.insert(points.end(), {{.5 * i - 1, -1, 0}, {.5 * i - 1, 1, 0}});
    for (int i = 0; i < 100; ++i)
      triangles.insert(triangles.end(), {{2 * i, 2 * i + 2, 2 * i + 3}, {2 * i, 2 * i + 3, 2 * i + 1}});
    Scene scene = flight(Shape::mesh(points, triangles), {}, bullet.shape, {0, .1, .005}, {.6, 0, 0});
    scene.gravity = {0, 0, -10};
    scene.bodies[0].material.staticFriction = scene.bodies[0].material.dynamicFriction = 0;
    World world(scene, test::options(4));
    int stops = 0;
    for (int i = 0; i < 4; ++i) stops += world.step().stoppedBodies;
    EXPECT_EQ(stops, 0) << bullet.name;
    EXPECT_NEAR(world.state(world.bodyAt(1)).position.x, 600 * 4 * kDt, .05) << bullet.name;
  }
}

TEST(FastShape, OfALatticeDoesNotPassAPlate) {
  for (const Kind& plate : plates()) {
    Scene scene = flight(plate.shape, plate.name == "heights" ? Vec3{-.5, -.5, 0} : Vec3{},
                         latticeBox({.03, .02, .02}, .01), {.03, .02, 7}, {0, 0, -.3});
    World world(scene, test::options(4));
    for (int i = 0; i < 12; ++i) {
      world.step();
      EXPECT_GT(world.state(world.bodyAt(1)).position.z, kTop) << plate.name << " " << i;
    }
  }
}

TEST(FastShape, StaysInAHollowOfADistanceField) {
  // a box of walls 2 cm thick, made of the distance to its inside
  constexpr int kN = 25;
  constexpr double kSpacing = .02;
  std::vector<double> samples;
  const auto box = [](const Vec3& x, double half) {
    const Vec3 d = abs(x) - Vec3{half, half, half};
    return length(Vec3{std::max(d.x, 0.), std::max(d.y, 0.), std::max(d.z, 0.)}) +
           std::min(0., std::max({d.x, d.y, d.z}));
  };
  const double first = -kSpacing * (kN - 1) / 2;
  for (int z = 0; z < kN; ++z)
    for (int y = 0; y < kN; ++y)
      for (int x = 0; x < kN; ++x) {
        const Vec3 p = Vec3{first, first, first} + kSpacing * Vec3{1. * x, 1. * y, 1. * z};
        samples.push_back(std::max(box(p, .22), -box(p, .18)));
      }
  const Shape hollow = Shape::distanceField({kN, kN, kN}, {first, first, first}, kSpacing, samples);
  World world(flight(hollow, {}, Shape::sphere(.03), {.02, .01, 0}, {.3, .1, -.2}), test::options(4));
  for (int i = 0; i < 60; ++i) {
    world.step();
    const Vec3 x = abs(world.state(world.bodyAt(1)).position);
    // its center does not enter the wall, and in the end it lies on it
    EXPECT_LT(std::max({x.x, x.y, x.z}), i < 40 ? .18 : .155) << i;
  }
}

}  // namespace
}  // namespace rubble
