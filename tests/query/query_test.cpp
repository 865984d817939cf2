/// Queries against distance functions that share no code with them: in a random world, over every body.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>

#include "tests/query/random_scene.h"
#include "tests/support/expect.h"
#include "tests/support/shapes.h"

namespace rubble {
namespace {

using test::distanceBetween;
using test::distanceTo;
using test::randomFilter;
using test::randomScene;
using test::randomWay;

bool seen(const BodyDef& b, const QueryFilter& f) {
  return (f.sensors || !b.sensor) && (b.filter.layers & f.mask) != 0;
}

/// First point of a way at which some body is nearer than `radius`, by going on by the distance each time.
/// Body and length of the way.
class March {
 public:
  explicit March(const Scene& scene) : scene_(scene) {
    for (const BodyDef& b : scene.bodies) pieces_.push_back(test::piecesOf(b));
  }
  std::optional<std::pair<int, double>> operator()(const QueryFilter& filter, const Vec3& x, const Vec3& d,
                                                   double end, double radius) const {
    double t = 0;
    while (t <= end) {
      double nearest = 1e30;
      int who = -1;
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        if (!seen(scene_.bodies[i], filter)) continue;
        const double s = distanceTo(pieces_[i], x + t * d, nearest + radius) - radius;
        if (s < nearest) nearest = s, who = static_cast<int>(i);
      }
      if (nearest < 1e-8) return std::pair(who, t);
      t += nearest;
    }
    return {};
  }

 private:
  const Scene& scene_;
  std::vector<std::vector<test::Piece>> pieces_;
};

class Query : public testing::TestWithParam<std::string> {};

TEST_P(Query, RaysMeetWhatMarchingMeets) {
  const Scene scene = randomScene(1);
  World world(scene, test::options(4, GetParam()));
  test::Random random(2);
  std::vector<RayQuery> rays;
  for (int i = 0; i < 600; ++i) {
    RayQuery ray{random.vector(18), randomWay(random, .1, 3), random.uniform(1, 80), randomFilter(random)};
    if (i % 5 == 0)
      ray.direction = Vec3{i % 3 == 0 ? 1. : 0., i % 3 == 1 ? -1. : 0., i % 3 == 2 ? 1. : 0.};  // along axes
    rays.push_back(ray);
  }
  const std::vector<RayHit> hits = world.castRays(rays);
  const March march(scene);
  int met = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const RayQuery& ray = rays[i];
    const Vec3 d = normalize(ray.direction);
    const auto expected = march(ray.filter, ray.origin, d, ray.maxDistance, 0);
    ASSERT_EQ(hits[i].hit, expected.has_value()) << i;
    if (!expected) continue;
    ++met;
    EXPECT_NEAR(hits[i].distance, expected->second, 1e-4) << i;
    const BodyDef& body = scene.bodies[static_cast<std::size_t>(hits[i].body.index)];
    EXPECT_NEAR(distanceTo(body, hits[i].position), std::min(0., distanceTo(body, ray.origin)), 1e-4) << i;
    EXPECT_NEAR(length(hits[i].normal), 1, 1e-5);
    EXPECT_LT(dot(hits[i].normal, d), 1e-6);
    // outwards: the distance grows by as much as one goes
    if (hits[i].distance > 0) {
      EXPECT_NEAR(distanceTo(body, hits[i].position + .01 * hits[i].normal), .01, 2e-4) << i;
    }
  }
  EXPECT_GT(met, 150);
}

TEST_P(Query, SpheresThatAreCastMeetWhatMarchingMeets) {
  const Scene scene = randomScene(3);
  World world(scene, test::options(4, GetParam()));
  test::Random random(4);
  std::vector<CastQuery> casts;
  for (int i = 0; i < 200; ++i)
    casts.push_back({Shape::sphere(random.logUniform(.02, 1)), random.vector(16), random.rotation(),
                     randomWay(random, .1, 40), randomFilter(random)});
  const std::vector<CastHit> hits = world.castShapes(casts);
  const March march(scene);
  int met = 0;
  for (std::size_t i = 0; i < casts.size(); ++i) {
    const double way = length(casts[i].displacement), radius = casts[i].shape.radius;
    const auto expected = march(casts[i].filter, casts[i].position, normalize(casts[i].displacement), way,
                                radius);
    if (hits[i].hit != expected.has_value()) {
      // only by a hair
      const double t = hits[i].hit ? hits[i].fraction : expected->second / way;
      double nearest = 1e30;
      for (const BodyDef& b : scene.bodies)
        if (seen(b, casts[i].filter))
          nearest = std::min(
              nearest, std::fabs(distanceTo(b, casts[i].position + t * casts[i].displacement) - radius));
      EXPECT_LT(nearest, 3e-4 * radius) << i;
      continue;
    }
    if (!expected) continue;
    ++met;
    // grazing, the gap of 1e-4 of the size is met earlier by its root
    EXPECT_NEAR(hits[i].fraction * way, expected->second, .05 * radius) << i;
    if (hits[i].fraction == 0) continue;
    const BodyDef& body = scene.bodies[static_cast<std::size_t>(hits[i].body.index)];
    EXPECT_NEAR(distanceTo(body, hits[i].position), 0, 1e-4) << i;
    EXPECT_NEAR(distanceTo(body, casts[i].position + hits[i].fraction * casts[i].displacement), radius,
                3e-4 * radius + 1e-5)
        << i;
  }
  EXPECT_GT(met, 60);
}

TEST_P(Query, ShapesThatAreCastStopAtTouch) {
  const Scene scene = randomScene(5);
  World world(scene, test::options(4, GetParam()));
  test::Random random(6);
  std::vector<CastQuery> casts;
  for (int i = 0; i < 60; ++i)
    casts.push_back(
        {test::randomSolid(random, 3), random.vector(14), random.rotation(), randomWay(random, .1, 20), {}});
  const std::vector<CastHit> hits = world.castShapes(casts);
  int met = 0;
  for (std::size_t i = 0; i < casts.size(); ++i) {
    BodyDef own = test::body(casts[i].shape, casts[i].position);
    own.orientation = casts[i].orientation;
    const auto nearest = [&](double t) {
      own.position = casts[i].position + t * casts[i].displacement;
      double least = 1e30;
      for (const BodyDef& b : scene.bodies)
        if (seen(b, {}) && length(b.position - own.position) < 8 + 1e9 * (b.shape.type == ShapeType::Plane))
          least = std::min(least, distanceBetween(own, b));
      return least;
    };
    const double end = hits[i].hit ? hits[i].fraction : 1;
    for (const double share : {.2, .6, .95})
      if (end > 0) {
        EXPECT_GT(nearest(end * share), 0) << i;
      }
    if (!hits[i].hit) continue;
    ++met;
    EXPECT_LT(nearest(end), 2e-3) << i;
  }
  EXPECT_GT(met, 20);
}

TEST_P(Query, OverlapsAreThoseOfZeroDistance) {
  const Scene scene = randomScene(7);
  World world(scene, test::options(4, GetParam()));
  test::Random random(8);
  std::vector<OverlapQuery> queries;
  for (int i = 0; i < 200; ++i)
    queries.push_back(
        {test::randomSolid(random, 3), random.vector(11), random.rotation(), randomFilter(random)});
  const auto found = world.overlaps(queries);
  std::size_t total = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    BodyDef own = test::body(queries[i].shape, queries[i].position);
    own.orientation = queries[i].orientation;
    std::vector<int> slots;
    for (const BodyId id : found[i]) slots.push_back(id.index);
    EXPECT_TRUE(std::is_sorted(slots.begin(), slots.end()));
    total += slots.size();
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
      const BodyDef& other = scene.bodies[k];
      // no shape reaches further than 4 m from its center
      const bool far = other.shape.type != ShapeType::Plane && length(other.position - own.position) > 8;
      const double distance = seen(other, queries[i].filter) && !far ? distanceBetween(own, other) : 1;
      const bool listed = std::binary_search(slots.begin(), slots.end(), static_cast<int>(k));
      if (distance > 1e-2) {
        EXPECT_FALSE(listed) << i << " " << k << " " << distance;
      }
      if (distance <= 1e-9) {
        EXPECT_TRUE(listed) << i << " " << k;
      }
    }
  }
  EXPECT_GT(total, 60u);
}

TEST_P(Query, ClosestPointsAreThoseOfTheDistanceFunctions) {
  const Scene scene = randomScene(9);
  World world(scene, test::options(4, GetParam()));
  test::Random random(10);
  std::vector<ClosestQuery> queries;
  for (int i = 0; i < 300; ++i)
    queries.push_back({random.vector(16), random.logUniform(.5, 100), randomFilter(random)});
  const std::vector<ClosestHit> hits = world.closestPoints(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    double least = 1e30;
    for (const BodyDef& b : scene.bodies)
      if (seen(b, queries[i].filter)) least = std::min(least, std::max(0., distanceTo(b, queries[i].point)));
    ASSERT_EQ(hits[i].hit, least <= queries[i].maxDistance) << i;
    if (!hits[i].hit) continue;
    EXPECT_NEAR(hits[i].distance, least, 1e-5) << i;
    EXPECT_NEAR(length(hits[i].position - queries[i].point), hits[i].distance, 1e-5) << i;
  }
}

TEST_P(Query, AllHitsOfARayAreTheFirstOfEachBody) {
  const Scene scene = randomScene(21);
  World world(scene, test::options(4, GetParam()));
  test::Random random(22);
  std::vector<RayQuery> rays;
  for (int i = 0; i < 60; ++i)
    rays.push_back({random.vector(18), random.direction(), random.uniform(20, 80), randomFilter(random)});
  const std::vector<RayHit> first = world.castRays(rays);
  const auto all = world.castRaysAll(rays);
  std::size_t most = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(first[i].hit, !all[i].empty()) << i;
    if (!first[i].hit) continue;
    EXPECT_EQ(all[i][0].body, first[i].body) << i;
    EXPECT_EQ(all[i][0].distance, first[i].distance) << i;
    EXPECT_TRUE(std::ranges::is_sorted(all[i], {}, &RayHit::distance)) << i;
    // what marching to each body alone finds
    std::set<int> found, expected;
    for (const RayHit& hit : all[i]) found.insert(hit.body.index);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      Scene alone;
      alone.bodies.push_back(scene.bodies[b]);
      if (March(alone)(rays[i].filter, rays[i].origin, normalize(rays[i].direction), rays[i].maxDistance, 0))
        expected.insert(static_cast<int>(b));
    }
    EXPECT_EQ(found, expected) << i;
    most = std::max(most, found.size());
  }
  EXPECT_GT(most, 2u);
}

TEST_P(Query, AllHitsOfShapesContainTheFirstAndTheOverlaps) {
  const Scene scene = randomScene(23);
  World world(scene, test::options(4, GetParam()));
  test::Random random(24);
  std::vector<CastQuery> casts;
  std::vector<OverlapQuery> places;
  for (int i = 0; i < 40; ++i) {
    casts.push_back({test::randomSolid(random, 3), random.vector(14), random.rotation(),
                     randomWay(random, 5, 40), randomFilter(random)});
    places.push_back(
        {casts.back().shape, casts.back().position, casts.back().orientation, casts.back().filter});
  }
  const std::vector<CastHit> first = world.castShapes(casts);
  const auto all = world.castShapesAll(casts);
  const auto bodies = world.overlaps(places);
  const auto hits = world.overlapsAll(places);
  std::size_t several = 0;
  for (std::size_t i = 0; i < casts.size(); ++i) {
    ASSERT_EQ(first[i].hit, !all[i].empty()) << i;
    if (first[i].hit) {
      EXPECT_EQ(all[i][0].body, first[i].body) << i;
      EXPECT_EQ(all[i][0].fraction, first[i].fraction) << i;
      EXPECT_EQ(all[i][0].position, first[i].position) << i;
    }
    EXPECT_TRUE(std::ranges::is_sorted(all[i], {}, &CastHit::fraction)) << i;
    several += all[i].size() > 1 ? 1 : 0;
    std::set<int> found, expected;
    for (const OverlapHit& hit : hits[i]) found.insert(hit.body.index);
    for (const BodyId id : bodies[i]) expected.insert(id.index);
    EXPECT_EQ(found, expected) << i;
    // what overlaps at the start is met at the start, by one of its parts
    for (const int body : expected) {
      const auto met = std::ranges::find(all[i], body, [](const CastHit& hit) { return hit.body.index; });
      ASSERT_NE(met, all[i].end()) << i;
      EXPECT_EQ(met->fraction, 0) << i;
    }
  }
  EXPECT_GT(several, 5u);
}

/// A sheet at z = 1, a cable along x at z = 3, and a grain at z = 5; a slab of body at z = 0.
Scene softLayers() {
  Scene scene = test::emptyScene({});
  scene.bodies.push_back(test::body(Shape::box({3, 3, 0.25}), {}));
  ClothDef sheet = clothSheet({-2, -2, 1}, {4, 0, 0}, {0, 4, 0}, 5, 7);
  sheet.userData = 7;
  scene.deformables.push_back(sheet);
  CableDef cable = straightCable({-2, 0, 3}, {2, 0, 3}, 8);
  cable.radius = 0.1;
  scene.deformables.push_back(cable);
  ParticlesDef grain;
  grain.radius = 0.3, grain.vertices = {{0, 0, 5}};
  scene.deformables.push_back(grain);
  return scene;
}

TEST_P(Query, SeeDeformableObjectsWhereTheyAre) {
  World world(softLayers(), test::options(4, GetParam()));
  const std::vector<DeformableId> objects = world.deformables();
  test::Random random(25);
  for (int i = 0; i < 40; ++i) {
    const double x = random.uniform(-1.9, 1.9),
                 y = i % 2 == 0 ? random.uniform(-0.3, 0.3) : random.uniform(-1.9, 1.9);
    RayQuery ray{{x, y, 9}, {0, 0, -2}, 20, {}};
    EXPECT_EQ(world.castRay(ray).body, world.bodyAt(0));
    ray.filter.deformables = true;
    std::vector<std::pair<int, double>> expected;  // object, its height
    if (x * x + y * y < 0.09) expected.emplace_back(2, 5 + std::sqrt(0.09 - x * x - y * y));
    if (std::fabs(y) < 0.1) expected.emplace_back(1, 3 + std::sqrt(0.01 - y * y));
    expected.emplace_back(0, 1);
    const std::vector<RayHit> all = world.castRaysAll({{ray}})[0];
    ASSERT_EQ(all.size(), expected.size() + 1) << x << " " << y;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      EXPECT_EQ(all[k].object, objects[static_cast<std::size_t>(expected[k].first)]);
      EXPECT_NEAR(9 - all[k].distance, expected[k].second, 1e-5);
      EXPECT_NEAR(all[k].position.z, expected[k].second, 1e-5);
      EXPECT_EQ(all[k].body, BodyId{});
      EXPECT_GT(all[k].normal.z, 0);
    }
    EXPECT_EQ(all.back().body, world.bodyAt(0));
    const RayHit sheet = all[all.size() - 2];
    EXPECT_EQ(sheet.userData, 7u);
    // the triangle is the one below
    const ClothDef& def = std::get<ClothDef>(world.definition(objects[0]));
    Vec3 low{1e9, 1e9, 0}, high{-1e9, -1e9, 0};
    for (const int v : def.triangles[static_cast<std::size_t>(sheet.triangle)]) {
      const Vec3& at = def.vertices[static_cast<std::size_t>(v)];
      low = {std::min(low.x, at.x), std::min(low.y, at.y), 0};
      high = {std::max(high.x, at.x), std::max(high.y, at.y), 0};
    }
    EXPECT_TRUE(x >= low.x - 1e-6 && x <= high.x + 1e-6 && y >= low.y - 1e-6 && y <= high.y + 1e-6);
    EXPECT_EQ(world.castRay(ray).object, all[0].object);
    ray.filter.ignoreObject = all[0].object;
    EXPECT_EQ(world.castRay(ray).object, all[1].object);
    // casts, overlaps and closest points of spheres
    CastQuery cast{Shape::sphere(0.2), {x, y, 9}, {}, {0, 0, -8.5}, ray.filter};
    cast.filter.ignoreObject = {};
    double met = 1.2;
    if (std::fabs(y) < 0.3) met = 3 + std::sqrt(0.09 - y * y);
    if (x * x + y * y < 0.25) met = 5 + std::sqrt(0.25 - x * x - y * y);
    EXPECT_NEAR(9 - 8.5 * world.castShapes({{cast}})[0].fraction, met, 0.02) << x << " " << y;
    EXPECT_EQ(world.castShapesAll({{cast}})[0].size(),
              std::size_t(met > 3.5) + std::size_t(std::fabs(y) < 0.3) + 1);
    OverlapQuery overlap{Shape::box({0.1, 0.1, 0.1}), {x, y, 1.05}, {}, cast.filter};
    EXPECT_EQ(world.overlapsAll({{overlap}})[0].size(), 1u);
    overlap.position.z = 1.15;
    EXPECT_EQ(world.overlapsAll({{overlap}})[0].size(), 0u);
    const ClosestHit closest = world.closestPoints({{{{x, y, 1.5}, 2, cast.filter}}})[0];
    EXPECT_EQ(closest.object, objects[0]);
    EXPECT_NEAR(closest.distance, 0.5, 1e-6);
  }
  // as bodies of layer 1
  RayQuery other{{0, 0.5, 9}, {0, 0, -1}, 20, {}};
  other.filter.deformables = true, other.filter.mask = 6;
  EXPECT_FALSE(world.castRay(other).hit);
}

TEST_P(Query, AllHitsNameTheTriangleOfAMesh) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::groundOf("mesh"));
  World world(scene, test::options(4, GetParam()));
  test::Random random(26);
  for (int i = 0; i < 20; ++i) {
    const Vec3 from{random.uniform(-4, 4), random.uniform(-4, 4), 2};
    const RayHit ray = world.castRay({from, {0, 0, -1}, 5, {}});
    const CastHit cast = world.castShapesAll({{{Shape::sphere(0.01), from, {}, {0, 0, -5}, {}}}})[0].at(0);
    EXPECT_EQ(cast.triangle, ray.triangle) << from.x << " " << from.y;
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, Query, testing::Values("cpu", "reference", "lockstep"));

/// Few queries are answered body by body, many by the grid.
TEST_P(Query, OneFindsWhatItFindsAmongMany) {
  World world(randomScene(61), test::options(4, GetParam()));
  constexpr int kCount = 60;
  const test::RandomQueries asked(62, kCount);
  const auto rays = world.castRays(asked.rays);
  const auto allRays = world.castRaysAll(asked.rays);
  const auto casts = world.castShapes(asked.casts);
  const auto shapes = world.overlaps(asked.shapes);
  const auto points = world.closestPoints(asked.points);
  const auto same = [](const auto& a, const auto& b) {
    return a.hit == b.hit && a.body == b.body && a.position == b.position;
  };
  int hits = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    EXPECT_TRUE(same(world.castRay(asked.rays[i]), rays[i])) << i;
    EXPECT_TRUE(same(world.castShape(asked.casts[i]), casts[i])) << i;
    EXPECT_TRUE(std::ranges::equal(world.castRayAll(asked.rays[i]), allRays[i], same)) << i;
    EXPECT_TRUE(same(world.closestPoint(asked.points[i]), points[i])) << i;
    EXPECT_EQ(world.overlap(asked.shapes[i]), shapes[i]) << i;
    hits += rays[i].hit + casts[i].hit + points[i].hit + !shapes[i].empty();
  }
  EXPECT_GT(hits, kCount);
}

TEST(QueryWorld, SeesWhereTheLastStepHasPutBodies) {
  World world(test::tower(2), test::options(4));
  world.applyImpulse(world.bodyAt(2), {0, 0, 6});
  test::run(world, 30);
  const RayQuery down{{.2, .1, 50}, {0, 0, -1}, 100, {}};
  const double top = world.state(world.bodyAt(2)).position.z + .5;
  EXPECT_NEAR(world.castRays(std::vector{down})[0].position.z, top, 1e-3);
  RayQuery through = down;
  through.filter.ignore = world.bodyAt(2);
  EXPECT_EQ(world.castRays(std::vector{through})[0].body, world.bodyAt(1));
  world.removeBody(world.bodyAt(2));
  EXPECT_EQ(world.castRays(std::vector{down})[0].body, world.bodyAt(1));
}

TEST(QueryWorld, IgnoresNoOtherBodyThanTheOneThatIsNamed) {
  Scene scene = test::emptyScene();
  scene.bodies = {test::unitCube({0, 0, 0})};
  World world(scene, test::options());
  const BodyId gone = world.bodyAt(0);
  RayQuery ray{{0, 0, 5}, {0, 0, -1}, 10, {}};
  const auto hits = [&](BodyId ignore) {
    ray.filter.ignore = ignore;
    return world.castRays({&ray, 1}).front().hit;
  };
  EXPECT_FALSE(hits(gone));
  EXPECT_TRUE(hits({1000000, 0}));
  world.removeBody(gone);
  const BodyId next = world.addBody(test::unitCube({0, 0, 0}));
  ASSERT_EQ(next.index, gone.index);
  EXPECT_TRUE(hits(gone));
  EXPECT_FALSE(hits(next));
}

TEST(QueryWorld, ChangesNothing) {
  World asked(test::heap(3), test::options(4)), quiet(test::heap(3), test::options(4));
  for (int i = 0; i < 60; ++i) {
    asked.castRays(std::vector{RayQuery{{0, 0, 9}, {.1, .2, -1}, 50, {}}});
    asked.step(), quiet.step();
  }
  EXPECT_EQ(asked.hash(), quiet.hash());
}

TEST(QueryWorld, NamesTheFault) {
  World world(test::tower(1), test::options(4));
  EXPECT_THROW(world.castRays(std::vector{RayQuery{{}, {}, 1, {}}}), Error);
  EXPECT_THROW(world.castShapes(std::vector{CastQuery{Shape::plane(), {}, {}, {}, {}}}), Error);
  EXPECT_THROW(world.overlaps(std::vector{
                   OverlapQuery{Shape::mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), {}, {}, {}}}),
               Error);
  EXPECT_THROW(world.closestPoints(std::vector{ClosestQuery{{}, -1, {}}}), Error);
  EXPECT_TRUE(world.castRays({}).empty());
}

}  // namespace
}  // namespace rubble
