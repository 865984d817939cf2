/// Queries of surfaces that are seen from one side, and of distance fields.
#include <gtest/gtest.h>

#include "tests/query/exact.h"
#include "tests/support/expect.h"

namespace rubble {
namespace {

double height(double x, double y) { return .6 * std::sin(1.3 * x) * std::cos(.9 * y); }

/// Waves of 21 by 17 samples, turned; and the triangles that they stand for.
Scene waves(bool mesh) {
  constexpr int kX = 21, kY = 17;
  constexpr double kStep = .4;
  std::vector<double> heights;
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j < kY; ++j)
    for (int i = 0; i < kX; ++i) {
      heights.push_back(height(kStep * i, kStep * j));
      points.push_back({kStep * i, kStep * j, heights.back()});
    }
  for (int j = 0; j + 1 < kY; ++j)
    for (int i = 0; i + 1 < kX; ++i) {
      const int a = j * kX + i;
      triangles.push_back({a, a + 1, a + kX + 1});
      triangles.push_back({a, a + kX + 1, a + kX});
    }
  BodyDef ground = test::ground();
  ground.shape = mesh ? Shape::mesh(points, triangles)
                      : Shape::heightField(kX, kY, {kStep, kStep, 0}, heights);
  ground.position = {1, -2, .5};
  ground.orientation = fromAxisAngle(normalize(Vec3{1, 2, 3}), .8);
  Scene scene = test::emptyScene();
  scene.bodies.push_back(ground);
  return scene;
}

Vec3 randomPoint(const BodyDef& ground, test::Random& random) {
  return ground.position + rotate(ground.orientation,
                                  Vec3{random.uniform(-2, 10), random.uniform(-2, 9), random.uniform(-3, 3)});
}

TEST(QuerySurface, RaysMeetTheFirstTriangleFromItsFront) {
  const std::vector<test::Piece> triangles = test::piecesOf(waves(true).bodies[0]);
  for (const bool mesh : {false, true}) {
    const Scene scene = waves(mesh);
    World world(scene, test::options());
    test::Random random(21);
    int met = 0;
    for (int i = 0; i < 400; ++i) {
      const Vec3 from = randomPoint(scene.bodies[0], random), aim = randomPoint(scene.bodies[0], random);
      const RayQuery ray{from, normalize(aim - from), random.uniform(1, 30), {}};
      double first = 1e30;
      for (const test::Piece& t : triangles) {
        Vec3 c[3];
        for (int k = 0; k < 3; ++k) c[k] = t.position + rotate(t.orientation, t.corner[k]);
        const Vec3 n = normalize(cross(c[1] - c[0], c[2] - c[0]));
        const double over = dot(n, ray.origin - c[0]), s = over / -dot(n, ray.direction);
        if (dot(n, ray.direction) >= 0 || over < 0 || s > ray.maxDistance) continue;
        const Vec3 x = ray.origin + s * ray.direction;
        if (length(test::nearestOnTriangle(c, x) - x) < 1e-9) first = std::min(first, s);
      }
      const RayHit hit = world.castRays(std::vector{ray})[0];
      ASSERT_EQ(hit.hit, first < 1e30) << i;
      if (!hit.hit) continue;
      ++met;
      EXPECT_NEAR(hit.distance, first, 1e-5) << i;
      EXPECT_LT(dot(hit.normal, ray.direction), 0) << i;
    }
    EXPECT_GT(met, 80);
  }
}

TEST(QuerySurface, NearestPointsAndOverlapsAreThoseOfTheNearestTriangle) {
  const std::vector<test::Piece> triangles = test::piecesOf(waves(true).bodies[0]);
  for (const bool mesh : {false, true}) {
    const Scene scene = waves(mesh);
    World world(scene, test::options());
    test::Random random(22);
    for (int i = 0; i < 300; ++i) {
      const Vec3 x = randomPoint(scene.bodies[0], random);
      const double reach = random.logUniform(.3, 100), distance = test::distanceTo(triangles, x),
                   radius = random.uniform(.05, 2);
      const ClosestHit hit = world.closestPoints(std::vector{ClosestQuery{x, reach, {}}})[0];
      ASSERT_EQ(hit.hit, distance <= reach) << i;
      if (hit.hit) {
        EXPECT_NEAR(hit.distance, distance, 1e-5) << i;
        EXPECT_TRUE(test::near(hit.position, x, distance + 1e-5)) << i;
      }
      if (std::fabs(distance - radius) > 1e-5) {
        EXPECT_EQ(world.overlaps(std::vector{OverlapQuery{Shape::sphere(radius), x, {}, {}}})[0].size(),
                  distance < radius ? 1u : 0u)
            << i;
      }
    }
  }
}

/// A ball of radius 1 on a lattice of 0.1, away from the middle of its lattice: chords of 0.1 lie 0.00125
/// inside.
BodyDef sampledBall() {
  constexpr int kN = 31;
  const Vec3 origin{-1.3, -1.4, -1.6};
  std::vector<double> samples;
  for (int z = 0; z < kN; ++z)
    for (int y = 0; y < kN; ++y)
      for (int x = 0; x < kN; ++x) samples.push_back(length(origin + .1 * Vec3{1. * x, 1. * y, 1. * z}) - 1);
  BodyDef ball = test::body(Shape::distanceField({kN, kN, kN}, origin, .1, samples), {3, 2, 1});
  ball.orientation = fromAxisAngle(normalize(Vec3{1, -2, 3}), 1.1);
  return ball;
}

/// The shape of a query has tables of its own.
TEST(QueryField, MeetsAHullAsTheBoxOfItsCorners) {
  Scene scene = test::emptyScene();
  const BodyDef ball = sampledBall();
  scene.bodies.push_back(ball);
  World world(scene, test::options());
  test::Random random(29);
  for (int i = 0; i < 200; ++i) {
    const Vec3 half{random.uniform(.1, .5), random.uniform(.1, .5), random.uniform(.1, .5)};
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k)
      corners.push_back({k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z});
    const Shape box = Shape::box(half), hull = Shape::hull(corners);
    const Vec3 from = ball.position + 4 * random.direction(), way = 1.5 * (ball.position - from);
    const Quat q = random.rotation();
    const auto casts = world.castShapes(
        std::vector{CastQuery{box, from, q, way, {}}, CastQuery{hull, from, q, way, {}}});
    ASSERT_TRUE(casts[0].hit && casts[1].hit) << i;
    // [m]; a cast ends within its tolerance of the surface, at a corner or between two
    EXPECT_NEAR(length(way) * casts[1].fraction, length(way) * casts[0].fraction, .02) << i;
    const Vec3 beside = ball.position + random.vector(2);
    const auto found = world.overlaps(
        std::vector{OverlapQuery{box, beside, q, {}}, OverlapQuery{hull, beside, q, {}}});
    EXPECT_EQ(found[0].size(), found[1].size()) << i;
  }
}

TEST(QueryField, AgreesWithTheBallThatItSamples) {
  Scene scene = test::emptyScene();
  const BodyDef ball = sampledBall();
  scene.bodies.push_back(ball);
  World world(scene, test::options());
  constexpr double kChord = .004;
  test::Random random(23);
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = ball.position + random.vector(3), d = normalize(ball.position + random.vector(1.5) - x);
    const double distance = std::max(0., length(x - ball.position) - 1), along = -dot(x - ball.position, d);
    const double beside = length(x - ball.position + along * d), radius = random.uniform(.1, .5);
    const ClosestHit near = world.closestPoints(std::vector{ClosestQuery{x, 10, {}}})[0];
    ASSERT_TRUE(near.hit) << i;
    EXPECT_NEAR(near.distance, distance, kChord) << i;
    if (std::fabs(distance - radius) > kChord) {
      EXPECT_EQ(world.overlaps(std::vector{OverlapQuery{Shape::sphere(radius), x, {}, {}}})[0].size(),
                distance < radius ? 1u : 0u)
          << i;
    }
    // rays and casts that do not graze
    if (distance == 0) continue;
    const RayHit ray = world.castRays(std::vector{RayQuery{x, d, 20, {}}})[0];
    if (std::fabs(beside - 1) > .1) {
      ASSERT_EQ(ray.hit, along > 0 && beside < 1) << i;
      if (ray.hit) {
        ++met;
        EXPECT_NEAR(ray.distance, along - std::sqrt(1 - beside * beside), 4 * kChord) << i;
        EXPECT_TRUE(test::near(ray.normal, normalize(ray.position - ball.position), .1)) << i;
      }
    }
    const double sum = 1 + radius;
    if (distance > radius + kChord && std::fabs(beside - sum) > .1) {
      const CastHit cast = world.castShapes(
          std::vector{CastQuery{Shape::sphere(radius), x, {}, 20 * d, {}}})[0];
      ASSERT_EQ(cast.hit, along > 0 && beside < sum) << i;
      if (cast.hit) {
        EXPECT_NEAR(20 * cast.fraction, along - std::sqrt(sum * sum - beside * beside), 4 * kChord) << i;
      }
    }
  }
  EXPECT_GT(met, 30);
}

}  // namespace
}  // namespace rubble
