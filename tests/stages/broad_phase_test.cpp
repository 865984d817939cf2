/// The grid of levels against all pairs by brute force.
#include "tests/support/core_world.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

BodyDef ball(double radius, const Vec3& position) {
  BodyDef body;
  body.shape = Shape::sphere(radius);
  body.position = position;
  return body;
}

BodyDef staticBox(const Vec3& half, const Vec3& position, const Quat& orientation = {}) {
  BodyDef body;
  body.motion = Motion::Static;
  body.shape = Shape::box(half);
  body.position = position;
  body.orientation = orientation;
  return body;
}

BodyDef groundPlane(const Vec3& position, const Quat& orientation) {
  BodyDef body;
  body.motion = Motion::Static;
  body.shape = Shape::plane();
  body.position = position;
  body.orientation = orientation;
  return body;
}

void expectAllPairs(CoreWorld& world, std::size_t atLeast) {
  world.finish();
  const auto found = world.pairs(), expected = allPairs(world.view());
  EXPECT_GE(expected.size(), atLeast);
  EXPECT_EQ(found, expected);
  EXPECT_EQ(static_cast<std::size_t>(world.view().counters->pairs), found.size()) << "a pair was found twice";
}

TEST(BroadPhase, FindsAllPairsOfEqualBodies) {
  Random random(1);
  CoreWorld world;
  for (int i = 0; i < 400; ++i) world.add(ball(.5, random.vector(4)));
  expectAllPairs(world, 500);
}

TEST(BroadPhase, FindsAllPairsOfSizesFromOneToAThousand) {
  Random random(2);
  CoreWorld world;
  for (int i = 0; i < 500; ++i) {
    const double radius = random.logUniform(.01, 10);
    world.add(ball(radius, random.vector(8)));
  }
  expectAllPairs(world, 5000);
}

TEST(BroadPhase, FindsAllPairsOfFastAndSpinningBodies) {
  Random random(3);
  CoreWorld world;
  for (int i = 0; i < 300; ++i) {
    BodyDef body = ball(.1, random.vector(20));
    body.shape = Shape::box({.1, .2, .3});
    body.orientation = random.rotation();
    body.velocity = random.vector(300);
    body.angularVelocity = random.vector(100);
    world.add(body);
  }
  expectAllPairs(world, 100);
}

/// Streams of pebbles and grains in several directions, of one velocity each up to a spread, through one
/// another and through bodies at rest.
void addStreams(CoreWorld& world, Random& random, int streams, int each, double spread) {
  for (int k = 0; k < streams; ++k) {
    const double radius = random.logUniform(.003, .03), extent = random.logUniform(.3, 2);
    const Vec3 at = random.vector(1), velocity = random.vector(200);
    for (int i = 0; i < each; ++i) {
      BodyDef body = ball(radius * random.uniform(.7, 1.3), at + random.vector(extent));
      if (i % 4 == 0) body.shape = Shape::box({radius, 2 * radius, radius});
      body.orientation = random.rotation();
      body.velocity = velocity + random.vector(spread);
      body.angularVelocity = random.vector(10);
      world.add(body);
    }
  }
  for (int i = 0; i < each; ++i) world.add(ball(random.logUniform(.005, .5), random.vector(3)));
}

TEST(BroadPhase, FindsAllPairsOfStreamsWithLongPaths) {
  int subdivided = 0;
  for (const double spread : {0., .5, 5., 50.}) {
    Random random(static_cast<std::uint64_t>(10 + spread));
    CoreWorld world;
    addStreams(world, random, 4, 150, spread);
    world.add(staticBox({5, 5, .1}, {0, 0, 2}));
    expectAllPairs(world, 200);
    const SolverData& s = world.view();
    for (int i = 0; i < s.bodies; ++i) {
      const Bounds& b = s.bounds[i];
      if (!isLongLevel(b.level)) continue;
      const int bucket = bucketOf(s, layerOf(0, b.level), b.x, b.y, b.z);
      subdivided += halvings(s.cellPaths[bucket], b.level, b.x, b.y, b.z) > 0;
    }
  }
  EXPECT_GT(subdivided, 300);
}

/// Couples of pebbles that touch, with more than a diameter between couples.
std::set<std::pair<int, int>> pairsOfCouples(const Vec3& velocity, double spread) {
  Random random(11);
  CoreWorld world;
  constexpr int kWide = 8;
  constexpr double kRadius = .01, kSpacing = .1;
  for (int k = 0; k < kWide * kWide * kWide; ++k) {
    const Vec3 cell{double(k % kWide), double(k / kWide % kWide), double(k / kWide / kWide)};
    const Vec3 at = kSpacing * cell + random.vector(.01),
               toOther = rotate(random.rotation(), Vec3{kRadius, 0, 0});
    for (const double side : {-1., 1.}) {
      BodyDef pebble = ball(kRadius, at + side * toOther);
      pebble.velocity = velocity + random.vector(spread);
      world.add(pebble);
    }
  }
  world.finish();
  return world.pairs();
}

TEST(BroadPhase, AFallingCloudHasThePairsThatItHasAtRest) {
  const auto atRest = pairsOfCouples({0, 0, 0}, 0);
  EXPECT_EQ(atRest.size(), 512u);
  for (const double speed : {1., 5., 50., 500.}) {
    EXPECT_EQ(pairsOfCouples({0, 0, -speed}, 0), atRest) << speed;
    EXPECT_EQ(pairsOfCouples({.6 * speed, 0, -.8 * speed}, .1), atRest) << speed;
  }
}

TEST(BroadPhase, BoundsHoldABodyAllThroughItsStep) {
  Random random(9);
  CoreWorld world;
  for (int i = 0; i < 200; ++i) {
    BodyDef body = ball(.1, random.vector(20));
    body.shape = Shape::box({random.uniform(.1, 1), random.uniform(.1, 1), random.uniform(.1, 1)});
    body.orientation = random.rotation();
    body.velocity = random.vector(50);
    body.angularVelocity = random.vector(10);
    world.add(body);
  }
  world.finish();
  world.pairs();
  const SolverData& s = world.view();
  for (int i = 0; i < s.bodies; ++i) {
    const Vec3 h = s.params[i].shape.half;
    for (const Real share : {0., .5, 1.}) {
      const Real time = share * s.step->dt;
      const Quat q = expRotation(time * s.angularVelocity[i]) * s.orientation[i];
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 local{(corner & 1) ? h.x : -h.x, (corner & 2) ? h.y : -h.y, (corner & 4) ? h.z : -h.z};
        const Vec3 d = abs(s.position[i] + time * s.velocity[i] + rotate(q, local) - s.bounds[i].center);
        for (int k = 0; k < 3; ++k) EXPECT_LE(d[k], s.bounds[i].half[k]);
      }
    }
  }
}

TEST(BroadPhase, FindsAllPairsWithHugeStaticBoxesAndPlanes) {
  Random random(4);
  CoreWorld world;
  world.add(staticBox({500, 500, 1}, {0, 0, -1}));
  world.add(groundPlane({0, 0, 0}, Quat{}));
  world.add(groundPlane({5, 0, 0}, random.rotation()));
  for (int i = 0; i < 20; ++i)
    world.add(staticBox({random.logUniform(.1, 30), random.logUniform(.1, 30), .5}, random.vector(30),
                        random.rotation()));
  for (int i = 0; i < 400; ++i) {
    BodyDef body = ball(.2, random.vector(10));
    if (i % 3 == 0) body.shape = Shape::capsule(.1, .3);
    if (i % 10 == 0) body.motion = Motion::Kinematic;
    body.orientation = random.rotation();
    world.add(body);
  }
  expectAllPairs(world, 500);
}

TEST(BroadPhase, FindsAllPairsFarFromTheOrigin) {
  Random random(5);
  CoreWorld world;
  for (int i = 0; i < 200; ++i) world.add(ball(.5, Vec3{1e5, -2e5, 3e4} + random.vector(3)));
  expectAllPairs(world, 200);
}

TEST(BroadPhase, FindsAllPairsOfBodiesThatReachOverMoreCellsThanThereAreBuckets) {
  // on the coarsest level some look into cells, and others at all bodies: of two that meet one finds the
  // other in either way
  Random random(9);
  CoreWorld world;
  for (int i = 0; i < 200; ++i) world.add(ball(random.logUniform(1e3, 3e5), random.vector(3e5)));
  expectAllPairs(world, 500);
}

TEST(BroadPhase, FindsMorePartnersThanABodyHasSlotsFor) {
  for (const int bodies : {kScannedBodies, 2 * kScannedBodies}) {
    Random random(6);
    CoreWorld world;
    for (int i = 0; i < bodies; ++i) world.add(ball(.1, random.vector(.1)));
    expectAllPairs(world, static_cast<std::size_t>(bodies * (bodies - 3) / 2));
  }
}

/// Up to kScannedBodies bodies are searched by a scan, more in cells.
TEST(BroadPhase, FindsAllPairsOfSmallWorldsOfSlowAndFastBodies) {
  Random random(12);
  std::size_t found = 0;
  for (int n = 0; n < 60; ++n) {
    CoreWorld world;
    const int bodies = n % 3 == 0 ? kScannedBodies - 1 + n % 4 : 1 + static_cast<int>(random.uniform(0, 60));
    const double extent = .3 * std::cbrt(bodies), fastest = random.logUniform(.1, 100);
    if (n % 2 == 0) world.add(groundPlane({0, 0, -.5 * extent}, random.rotation()));
    for (int i = 0; i < bodies; ++i) {
      BodyDef body = ball(random.logUniform(.01, 1), random.vector(extent));
      if (i % 4 == 0) body.shape = Shape::box({.05, .3, .1});
      if (i % 7 == 0) body.motion = Motion::Static;
      if (i % 2 == 0) body.velocity = random.vector(fastest);
      body.orientation = random.rotation();
      world.add(body);
    }
    expectAllPairs(world, 0);
    found += world.pairs().size();
  }
  EXPECT_GT(found, 1000u);
}

TEST(BroadPhase, SortsPairsByOwnerAndPartner) {
  Random random(7);
  CoreWorld world(2);
  for (int i = 0; i < 500; ++i) world.add(ball(random.logUniform(.1, 1), random.vector(3)));
  world.finish();
  world.pairs();
  const SolverData& s = world.view();
  int k = 0;
  for (int i = 0; i < s.bodies; ++i) {
    EXPECT_EQ(s.pairOffset[i], k);
    for (; k < s.pairOffset[i + 1]; ++k) {
      EXPECT_EQ(s.pair[k].owner, i);
      if (k > s.pairOffset[i]) {
        EXPECT_LT(s.pair[k - 1].other, s.pair[k].other);
      }
    }
  }
  EXPECT_EQ(k, s.counters->pairs);
}

TEST(BroadPhase, LeavesOutExcludedPairs) {
  CoreWorld world;
  for (int i = 0; i < 4; ++i) world.add(ball(.5, {.1 * i, 0, 0}));
  world.finish({{0, 2}, {1, 3}});
  const std::set<std::pair<int, int>> expected{{0, 1}, {0, 3}, {1, 2}, {2, 3}};
  EXPECT_EQ(world.pairs(), expected);
}

TEST(BroadPhase, SkipsPairsWithoutADynamicBody) {
  CoreWorld world;
  for (const Motion motion : {Motion::Static, Motion::Kinematic, Motion::Static, Motion::Dynamic}) {
    BodyDef body = ball(.5, {0, 0, 0});
    body.motion = motion;
    world.add(body);
  }
  world.finish();
  const std::set<std::pair<int, int>> expected{{0, 3}, {1, 3}, {2, 3}};
  EXPECT_EQ(world.pairs(), expected);
}

TEST(BroadPhase, GrowsFromTinyCapacityWithoutDroppingPairs) {
  Random random(8);
  CoreWorld world;
  world.add(ball(.2, {0, 0, 0}));
  world.finish();
  EXPECT_TRUE(world.pairs().empty());
  for (int i = 0; i < 1000; ++i) world.add(ball(.2, random.vector(1.5)));
  expectAllPairs(world, 5000);
}

/// Parts of two compounds whose bounding spheres are within the margin, and no others.
TEST(PartPairs, AreThoseWhosePartsAreNear) {
  CoreWorld world;
  Random random(31);
  std::vector<int> bodies;
  for (int i = 0; i < 2; ++i) {
    BodyDef body;
    body.shape = Shape::compound({{Shape::sphere(.1), {-1, 0, 0}, {}},
                                  {Shape::box({.1, .2, .1}), {.2, .6, 0}, {}},
                                  {Shape::sphere(.2), {.5, 0, .9}, {}}});
    body.position = {1.2 * i, 0, 0};
    body.orientation = random.rotation();
    bodies.push_back(world.add(body));
  }
  world.finish();
  world.begin();
  SolverData& s = world.view();
  std::size_t near = 0;
  for (int round = 0; round < 400; ++round) {
    s.orientation[bodies[0]] = random.rotation(), s.orientation[bodies[1]] = random.rotation();
    const Real margin = pairReach(s, bodies[0], bodies[1]);
    std::set<std::pair<int, int>> found, expected;
    forEachPartPair(s, bodies[0], bodies[1], [&](int a, int b) { found.emplace(a, b); });
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const auto sphereOf = [&](int body, int part) {
          const ShapePart& p = s.shapePart[s.shapeIndex[s.params[body].shape.data + 2] + part];
          return std::pair{Vec3(s.position[body]) + rotate(s.orientation[body], p.position), p.radius};
        };
        const auto [atA, radiusA] = sphereOf(bodies[0], a);
        const auto [atB, radiusB] = sphereOf(bodies[1], b);
        if (length(atB - atA) <= radiusA + radiusB + margin) expected.emplace(a, b);
      }
    EXPECT_EQ(found, expected) << round;
    near += found.size();
  }
  EXPECT_GT(near, 20u);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
