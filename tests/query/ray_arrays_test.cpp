/// Rays that are arrays, against the same rays one by one.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include <rubble/worlds.h>

#include "collision/ray_arrays.h"
#include "tests/query/random_scene.h"

namespace rubble {
namespace {

template <class T> ArrayView viewOf(const std::vector<T>& data, std::int64_t numbers) {
  return packedArray(data.data(), std::ssize(data) / numbers, numbers);
}
template <class T> std::vector<T> numbersIn(const ArrayView& view) {
  EXPECT_FALSE(view.device);
  const T* const first = static_cast<const T*>(view.data);
  return {first, first + view.shape[0] * view.shape[1]};
}

/// Origins in double, directions in float.
struct Rays {
  std::vector<double> origins;
  std::vector<float> directions;
  double maxDistance = 40;
  QueryFilter filter = {};

  explicit Rays(int count, unsigned seed = 2) {
    test::Random random(seed);
    for (int i = 0; i < count; ++i) {
      const Vec3 origin = random.vector(15), direction = test::randomWay(random, .1, 3);
      origins.insert(origins.end(), {origin.x, origin.y, origin.z});
      for (const double d : {direction.x, direction.y, direction.z})
        directions.push_back(static_cast<float>(d));
    }
  }
  RayArrays arrays() const { return {viewOf(origins, 3), viewOf(directions, 3), maxDistance, filter}; }
  RayQuery at(std::size_t i) const {
    const auto direction = [&](std::size_t k) { return static_cast<double>(directions[3 * i + k]); };
    return {{origins[3 * i], origins[3 * i + 1], origins[3 * i + 2]},
            {direction(0), direction(1), direction(2)},
            maxDistance,
            filter};
  }
};

/// Returns the number of hits.
int expectHits(const RayHitArrays& found, const std::vector<RayHit>& wanted, double maxDistance) {
  const std::vector<float> distances = numbersIn<float>(found.distances);
  const std::vector<float> normals = numbersIn<float>(found.normals);
  const std::vector<int> bodies = numbersIn<int>(found.bodies);
  EXPECT_EQ(distances.size(), wanted.size());
  EXPECT_EQ(bodies.size(), wanted.size());
  EXPECT_EQ(normals.size(), 3 * wanted.size());
  int hits = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const RayHit& hit = wanted[i];
    hits += hit.hit;
    EXPECT_EQ(distances[i], static_cast<float>(hit.hit ? hit.distance : maxDistance)) << i;
    EXPECT_EQ(bodies[i], hit.hit ? hit.body.index : -1) << i;
    const Vec3 normal = hit.hit ? hit.normal : Vec3{};
    EXPECT_EQ(normals[3 * i], static_cast<float>(normal.x)) << i;
    EXPECT_EQ(normals[3 * i + 2], static_cast<float>(normal.z)) << i;
  }
  return hits;
}

class RayArraysOn : public testing::TestWithParam<std::string> {};

TEST_P(RayArraysOn, HitWhatTheSameRaysHit) {
  World world(test::randomScene(1), test::options(4, GetParam()));
  const Rays rays(300);
  std::vector<RayQuery> queries;
  for (std::size_t i = 0; i < 300; ++i) queries.push_back(rays.at(i));
  const std::vector<RayHit> wanted = world.castRays(queries);
  const int hits = expectHits(world.castRayArrays(rays.arrays()), wanted, rays.maxDistance);
  EXPECT_GT(hits, 50);
  EXPECT_LT(hits, 300);
}

TEST_P(RayArraysOn, OfManyWorldsHitWhatTheSameRaysHit) {
  // more worlds than share an engine, each of which has moved differently
  constexpr int kWorlds = 40, kEach = 4;
  Worlds worlds(test::options(4, GetParam()));
  Scene scene = test::randomScene(1);
  scene.bodies.resize(30);
  worlds.addCopies(scene, kWorlds);
  for (int w = 0; w < kWorlds; ++w) worlds[w].setGravity({0, .5 * w, -9.81});
  worlds.step(3);
  const Rays rays(kWorlds * kEach);
  std::vector<Worlds::WorldRay> even, mixed;
  std::vector<int> numbers;
  for (int i = 0; i < kWorlds * kEach; ++i) {
    numbers.push_back(i * 17 % kWorlds);
    even.push_back({i / kEach, rays.at(static_cast<std::size_t>(i))});
    mixed.push_back({numbers.back(), rays.at(static_cast<std::size_t>(i))});
  }
  EXPECT_GT(expectHits(worlds.castRayArrays(rays.arrays()), worlds.castRays(even), rays.maxDistance), 10);
  EXPECT_GT(expectHits(worlds.castRayArrays(rays.arrays(), viewOf(numbers, 1)), worlds.castRays(mixed),
                       rays.maxDistance),
            10);
}

INSTANTIATE_TEST_SUITE_P(Backends, RayArraysOn, testing::Values("cpu", "reference"));

Scene twoBalls() {
  Scene scene;
  for (const double x : {5., 10.}) {
    BodyDef ball;
    ball.shape = Shape::sphere(1);
    ball.position = {x, 0, 0};
    scene.bodies.push_back(ball);
  }
  return scene;
}

/// From the origin along x.
Rays along(int count) {
  Rays rays(0);
  for (int i = 0; i < count; ++i) {
    rays.origins.insert(rays.origins.end(), {0, 0, 0});
    rays.directions.insert(rays.directions.end(), {2, 0, 0});
  }
  return rays;
}

TEST(RayArrays, SkipTheIgnoredBodyInEachWorld) {
  Worlds worlds(test::options(4));
  worlds.addCopies(twoBalls(), 2);
  Rays rays = along(2);
  EXPECT_EQ(numbersIn<float>(worlds.castRayArrays(rays.arrays()).distances), (std::vector<float>{4, 4}));
  rays.filter.ignore = worlds[0].bodies()[0];
  const RayHitArrays found = worlds.castRayArrays(rays.arrays());
  EXPECT_EQ(numbersIn<float>(found.distances), (std::vector<float>{9, 9}));
  EXPECT_EQ(numbersIn<int>(found.bodies), (std::vector<int>{1, 1}));
  EXPECT_EQ(numbersIn<float>(worlds[1].castRayArrays(rays.arrays()).distances), (std::vector<float>{9, 9}));
}

TEST(RayArrays, OfNoneAreNone) {
  World world(twoBalls(), test::options(4));
  EXPECT_EQ(world.castRayArrays(along(0).arrays()).distances.shape[0], 0);
  Worlds none(test::options(4));
  EXPECT_EQ(none.castRayArrays(along(0).arrays()).normals.shape[0], 0);
}

TEST(RayArrays, NameWhatIsWrong) {
  World world(twoBalls(), test::options(4));
  Worlds worlds(test::options(4));
  worlds.addCopies(twoBalls(), 2);
  const auto pathOf = [](const std::function<void()>& call) -> std::string {
    try {
      call();
    } catch (const Error& error) {
      return error.path();
    }
    return "no error";
  };
  const Rays rays = along(3);
  const auto with = [&](auto&& change) {
    return [&, change] {
      RayArrays arrays = rays.arrays();
      change(arrays);
      world.castRayArrays(arrays);
    };
  };
  EXPECT_EQ(pathOf(with([](RayArrays& a) { a.directions.shape[0] = 2; })), "directions.shape");
  EXPECT_EQ(pathOf(with([](RayArrays& a) { a.origins.typestr = "<i4"; })), "origins.typestr");
  EXPECT_EQ(pathOf(with([](RayArrays& a) { a.maxDistance = 0; })), "maxDistance");
  EXPECT_EQ(pathOf(with([](RayArrays& a) { a.filter.deformables = true; })), "filter.deformables");
  EXPECT_EQ(pathOf(with([](RayArrays& a) { a.origins.device = a.directions.device = true; })), "origins");
  EXPECT_EQ(pathOf(with([](RayArrays& a) { a.directions.device = true; })), "directions");
  Rays still = along(2);
  still.directions[3] = 0;
  EXPECT_EQ(pathOf([&] { world.castRayArrays(still.arrays()); }), "rays[1].direction");
  EXPECT_EQ(pathOf([&] { worlds.castRayArrays(rays.arrays()); }), "origins.shape");
  const std::vector<int> beyond{0, 1, 2};
  EXPECT_EQ(pathOf([&] { worlds.castRayArrays(rays.arrays(), viewOf(beyond, 1)); }), "world");
}

TEST(RayArrays, OnADeviceThatCannotBeCastFindNothing) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr float kHuge = std::numeric_limits<float>::infinity();
  const std::vector<double> origins{0, 0, 0, 0, kNaN, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  const std::vector<float> directions{0, 0, 2, 1, 0, 0, 0, 0, 0, kHuge, 0, 0, 1, 0, 0};
  const std::vector<int> worlds{1, 1, 1, 1, 2};
  EngineRays rays{viewOf(origins, 3), viewOf(directions, 3), 8, {}};
  rays.common.layers = rays.common.mask = 5;
  rays.worlds = viewOf(worlds, 1), rays.worldCount = 2, rays.firstWorld = 3;
  const RayReader read(rays);
  const EngineQuery good = read(0);
  EXPECT_EQ(good.move, (Vec3{0, 0, 8}));
  EXPECT_EQ(good.reach, 8);
  EXPECT_EQ(good.world, 4);
  EXPECT_EQ(good.mask, 5u);
  for (int k = 1; k < 5; ++k) {
    const EngineQuery bad = read(k);
    EXPECT_TRUE(std::isnan(bad.reach)) << k;
    EXPECT_EQ(bad.layers | bad.mask, 0u) << k;
    EXPECT_EQ(bad.move, (Vec3{})) << k;
    EXPECT_GE(bad.world, 3);
    EXPECT_LT(bad.world, 5);
  }
}

}  // namespace
}  // namespace rubble
