/// The order of pairs, where those of the last step are found again, and the levers of boundary constraints.
#include <numeric>

#include "tests/support/core_world.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

TEST(Pairs, AreWrittenInTheOrderOfTheirPartnersHoweverManyThereAre) {
  Random random(1);
  for (int count = 0; count <= kPairSlots; ++count) {
    std::vector<int> slots(2 * kPairSlots);
    std::iota(slots.begin(), slots.end(), 100);
    for (std::size_t k = slots.size(); k-- > 1;)
      std::swap(slots[k], slots[std::size_t(random.below(int(k) + 1))]);
    NeighborSearch search[2]{};
    int left = count;
    // of body 1, whose slots come second
    for (int k = 0; k < kPairSlots; ++k)
      if (random.below(kPairSlots - k) < left) search[1].partners |= 1u << k, --left;
    std::vector<int> offset{0, 3, 3 + count};
    std::vector<Pair> pairs(std::size_t(3 + count));
    SolverData view{};
    view.neighborSearch = search, view.pairSlot = slots.data(), view.pairOffset = offset.data();
    view.pair = pairs.data();
    WritePairs<false>{}(view, 1);
    std::vector<int> expected, written;
    for (int k = 0; k < kPairSlots; ++k)
      if (search[1].partners >> k & 1) expected.push_back(slots[std::size_t(kPairSlots + k)]);
    std::ranges::sort(expected);
    for (int k = 0; k < count; ++k) {
      EXPECT_EQ(pairs[std::size_t(3 + k)].owner, 1);
      written.push_back(pairs[std::size_t(3 + k)].other);
    }
    EXPECT_EQ(written, expected);
  }
}

// They are looked for where they would be if no pair had come or gone before them.
TEST(Pairs, OfTheLastStepAreFoundWhereverTheyAre) {
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    std::vector<Pair> pairs[2];
    std::vector<int> offset[2]{{0}, {0}};
    for (int body = 0; body < 4; ++body)
      for (int when = 0; when < 2; ++when) {
        for (int other = 10; other < 18; ++other)
          if (random.below(3) > 0) pairs[when].push_back({body, other, 1, 0, 0});
        offset[when].push_back(int(pairs[when].size()));
      }
    pairs[0].push_back({});  // none is read behind the last one
    SolverData view{};
    view.oldPair = pairs[0].data(), view.oldPairOffset = offset[0].data();
    view.pair = pairs[1].data(), view.pairOffset = offset[1].data();
    for (std::size_t k = 0; k < pairs[1].size(); ++k) {
      const Pair& p = pairs[1][k];
      int expected = -1;
      for (int old = 0; old < offset[0].back(); ++old)
        if (pairs[0][std::size_t(old)].owner == p.owner && samePair(pairs[0][std::size_t(old)], p))
          expected = old;
      EXPECT_EQ(findOldPair(view, int(k)), expected);
    }
  }
}

TEST(BoundaryConstraints, HaveTheLeversOfTheirBodies) {
  CoreWorld world;
  BodyDef ground;
  ground.motion = Motion::Static, ground.shape = Shape::plane();
  world.add(ground);
  for (int k = 0; k < 600; ++k) {
    BodyDef cube;
    cube.shape = Shape::box({.1, .1, .1});
    cube.position = {.2 * (k % 20), .1 + .2 * (k / 20 % 10), .2 * (k / 200)};
    world.add(cube);
  }
  world.finish();
  CpuExecutor& executor = world.executor();
  int seen = 0;
  bool due = true;
  executor.observe([&](std::string_view stage, std::string_view) {
    if (!due || stage != "coarse") return;
    due = false;
    const SolverData& s = world.view();
    for (int i = 0; i < s.counters->slices; ++i)
      for (int k = s.boundaryOffset[i]; k < s.boundaryOffset[i + 1]; ++k) {
        const BoundaryConstraint& c = s.boundary[k];
        ASSERT_EQ(constraintType(c.code), kContactType);
        const ContactRows& r = s.contact[constraintIndex(c.code)];
        const int body = constraintSide(c.code) == 0 ? r.a : r.b;
        const Aggregate& aggregate = s.aggregate[s.slice[i].aggregate];
        EXPECT_EQ(c.shift, Vec3(s.position[body] - aggregate.center));
        EXPECT_EQ(s.aggregateOf[atLevel(s, aggregate.level, body)], s.slice[i].aggregate);
        ++seen;
      }
  });
  world.begin();
  step(executor);
  EXPECT_GT(seen, 1000);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
