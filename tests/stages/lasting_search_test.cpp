/// Pairs do not depend on when neighbors were last searched for.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/core_world.h"
#include "tests/support/random.h"

namespace rubble::RUBBLE_CORE {
namespace {

/// Two equal worlds of which one searches in every step.
class Twins {
 public:
  Twins() { always_.view().searchesAlways = true; }

  template <class F> void both(F&& f) { f(lasting_), f(always_); }
  /// Finds the pairs in both. Returns whether the one whose searches last has searched.
  bool find() {
    const auto pairs = lasting_.pairs();
    EXPECT_EQ(pairs, always_.pairs());
    found_ += static_cast<int>(pairs.size());
    EXPECT_EQ(always_.view().counters->searched, always_.view().bodies);
    const int searched = lasting_.view().counters->searched;
    if (searched > 0 && searched < lasting_.view().bodies) ++alone_;
    return searched != 0;
  }
  /// Number of times that some bodies have searched and others not.
  int alone() const { return alone_; }
  int found() const { return found_; }
  /// What the last search that lasts has found.
  int neighbors() {
    const SolverData& s = lasting_.view();
    int count = 0;
    for (int i = 0; i < s.bodies; ++i) count += s.neighborSearch[i].found;
    return count;
  }

 private:
  CoreWorld lasting_, always_;
  int found_ = 0, alone_ = 0;
};

BodyDef sphereAt(const rubble::Vec3& position, double radius) {
  BodyDef body;
  body.shape = Shape::sphere(radius);
  body.position = position;
  return body;
}

BodyDef groundPlane() {
  BodyDef plane;
  plane.shape = Shape::plane();
  plane.motion = Motion::Static;
  return plane;
}

/// `sizes`: how many times the largest is as wide as the smallest.
void addRandomBodies(CoreWorld& world, int count, double sizes) {
  test::Random random(5);
  world.add(groundPlane());
  for (int i = 0; i < count; ++i) {
    const double radius = .05 * std::pow(sizes, random.uniform(0, 1));
    world.add(sphereAt({random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(0, 6)}, radius));
  }
  world.finish();
}

TEST(LastingSearch, FindsThePairsOfASearchInEveryStep) {
  constexpr int kBodies = 150, kRounds = 400;
  Twins twins;
  twins.both([](CoreWorld& world) { addRandomBodies(world, kBodies, 60); });
  int searches = 0;
  for (int round = 0; round < kRounds; ++round) {
    searches += twins.find();
    // mostly small moves; now and then a body goes, or comes back, and the plane tilts
    twins.both([&](CoreWorld& world) {
      test::Random random(static_cast<std::uint64_t>(100 + round));
      SolverData& s = world.view();
      const double most = std::pow(10., random.uniform(-6, -1));
      for (int i = 1; i <= kBodies; ++i)
        s.position[i] += Vec3d{random.uniform(-most, most), random.uniform(-most, most),
                               random.uniform(-most, most)};
      if (round % 16 == 3) {
        BodyKind& kind = s.params[1 + round % kBodies].kind;
        kind = kind == BodyKind::Removed ? BodyKind::Dynamic : BodyKind::Removed;
      }
      if (round % 64 == 40) s.orientation[0] = Quat(fromAxisAngle({1, 0, 0}, .001 * round));
      if (round == kRounds / 2) world.add(sphereAt({0, 0, 1}, 1));
    });
  }
  EXPECT_GT(searches, kRounds / 20);
  EXPECT_LT(searches, kRounds * 9 / 10);
  EXPECT_GT(twins.found(), kRounds * kBodies);
}

/// Of bodies at rest some begin to move or stop, a few so fast that their paths are long. A large one, with
/// cells much wider than those of the others, always moves.
TEST(LastingSearch, FindsThePairsOfBodiesAmongOthersAtRest) {
  constexpr int kBodies = 400, kRounds = 300;
  Twins twins;
  twins.both([](CoreWorld& world) {
    world.add(sphereAt({0, 0, 3}, 3));
    addRandomBodies(world, kBodies, 4);
  });
  for (int round = 0; round < kRounds; ++round) {
    twins.find();
    twins.both([&](CoreWorld& world) {
      test::Random random(static_cast<std::uint64_t>(7000 + round));
      SolverData& s = world.view();
      for (int k = 0; k < 12; ++k) {
        const int i = 2 + static_cast<int>(random.uniform(0, kBodies - 1));
        const double speed = std::pow(10., random.uniform(-3, 2));
        const Vec3d way{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        s.velocity[i] = k % 6 == 0 ? Vec3(way * speed) : Vec3{0, 0, 0};
        if (k % 4 == 1) s.position[i] += way * std::pow(10., random.uniform(-3, 1));
        if (k % 6 == 2) s.params[i].kind = k < 6 ? BodyKind::Removed : BodyKind::Dynamic;
      }
      for (int i = 2; i < 2 + kBodies; ++i) s.position[i] += Vec3d(s.velocity[i]) * .01;
      s.position[0] += Vec3d{random.uniform(-.3, .3), random.uniform(-.3, .3), random.uniform(-.3, .3)};
    });
  }
  EXPECT_GT(twins.alone(), kRounds / 4);
  EXPECT_GT(twins.found(), kRounds * kBodies / 20);
}

/// Spheres in a space so small that about half of them have more neighbors than slots.
TEST(LastingSearch, ListsEachCrowdedBodyOnce) {
  constexpr int kBodies = 90, kRounds = 60;
  CoreWorld world;
  test::Random random(11);
  for (int i = 0; i < kBodies; ++i)
    world.add(sphereAt({random.uniform(0, 2), random.uniform(0, 2), random.uniform(0, 2)}, .5));
  // a world of few bodies is scanned
  for (int i = 0; i < 100; ++i) world.add(sphereAt({50. + 3 * i, 0, 0}, .5));
  world.finish();
  SolverData& s = world.view();
  int alone = 0, listed = 0;
  for (int round = 0; round < kRounds; ++round) {
    world.pairs();
    std::set<int> expected;
    for (int i = 0; i < s.bodies; ++i)
      if (s.neighborSearch[i].found > kPairSlots) expected.insert(i);
    const std::set<int> crowded(s.crowdedBody, s.crowdedBody + s.counters->crowded);
    EXPECT_EQ(crowded, expected);
    EXPECT_EQ(crowded.size(), std::size_t(s.counters->crowded));
    listed += s.counters->crowded;
    alone += s.counters->searched > 0 && s.counters->searched < s.bodies;
    if (round % 3 > 0) s.position[round % kBodies] = Vec3d{random.uniform(0, 2), random.uniform(0, 2), 1};
    if (round % 20 == 19)
      for (int i = 0; i < kBodies; ++i) s.position[i].z += .3;
  }
  EXPECT_GT(alone, kRounds / 3);
  EXPECT_GT(listed, kRounds * kBodies / 4);
  EXPECT_LT(listed, kRounds * kBodies * 3 / 4);
}

TEST(LastingSearch, LastsUntilABodyLeavesTheBoxOfItsSearch) {
  Twins twins;
  twins.both([](CoreWorld& world) {
    for (int i = 0; i < 20; ++i) world.add(sphereAt({1.01 * i, 0, 0}, .5));
    world.finish();
  });
  const auto move = [&](double by) {
    twins.both([&](CoreWorld& world) { world.view().position[7].x += by; });
    return twins.find();
  };
  EXPECT_TRUE(twins.find());
  for (int step = 0; step < 5; ++step) EXPECT_FALSE(move(.001));
  EXPECT_EQ(twins.alone(), 0);
  EXPECT_TRUE(move(.2));
  EXPECT_EQ(twins.alone(), 1);
  EXPECT_FALSE(move(0));
}

TEST(LastingSearch, HasNoSlackWhileABodyMovesFar) {
  Twins twins;
  twins.both([](CoreWorld& world) {
    for (int i = 0; i < 20; ++i) world.add(sphereAt({1.06 * i, 0, 0}, .5));
    world.finish();
  });
  EXPECT_TRUE(twins.find());
  const int still = twins.neighbors();
  EXPECT_FALSE(twins.find());
  const auto neighborsAt = [&](float speed) {
    twins.both([&](CoreWorld& world) { world.view().velocity[3] = {0, speed, 0}; });
    EXPECT_TRUE(twins.find());
    return twins.neighbors();
  };
  EXPECT_LT(neighborsAt(4), still);
  EXPECT_EQ(neighborsAt(0), still);
  EXPECT_FALSE(twins.find());
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
