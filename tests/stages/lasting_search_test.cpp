/// Pairs do not depend on when neighbors were last searched for.
#include <gtest/gtest.h>

#include <cmath>

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
    EXPECT_EQ(always_.view().counters->searched, 1);
    return lasting_.view().counters->searched != 0;
  }
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
  int found_ = 0;
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

void addRandomBodies(CoreWorld& world, int count) {
  test::Random random(5);
  world.add(groundPlane());
  for (int i = 0; i < count; ++i) {
    const double radius = .05 * std::pow(60., random.uniform(0, 1));
    world.add(sphereAt({random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(0, 6)}, radius));
  }
  world.finish();
}

TEST(LastingSearch, FindsThePairsOfASearchInEveryStep) {
  constexpr int kBodies = 150, kRounds = 400;
  Twins twins;
  twins.both([](CoreWorld& world) { addRandomBodies(world, kBodies); });
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
  EXPECT_TRUE(move(.2));
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
