/// Worlds of a batch have the bits that they have alone.
#include "tests/support/worlds_claims.h"

namespace rubble {
namespace {

using test::RandomWorlds;
using test::worldsOptions;

struct Batching {
  int worlds, threads, steps;
  const char* backend = "cpu";
};
class BatchOf : public ::testing::TestWithParam<Batching> {};

TEST_P(BatchOf, GivesEachWorldTheBitsThatItHasAlone) {
  const auto [count, threads, steps, backend] = GetParam();
  const bool many = count > 100;
  test::expectBitsAlone({0, many ? 3 : 10}, count, worldsOptions(backend, threads), steps, many ? 13 : 1);
}

INSTANTIATE_TEST_SUITE_P(Sizes, BatchOf,
                         ::testing::Values(Batching{1, 1, 60}, Batching{2, 1, 60}, Batching{7, 3, 60},
                                           Batching{24, 3, 60}, Batching{7, 2, 30, "reference"},
                                           Batching{1000, 3, 20}),
                         [](const auto& info) {
                           return info.param.backend + std::to_string(info.param.worlds) + "Threads" +
                                  std::to_string(info.param.threads);
                         });

/// On a host a batch has no order of sums of its own.
TEST(Worlds, HaveTheBitsOfWorldsOutsideOfBatches) {
  Worlds worlds(worldsOptions("cpu", 3));
  const RandomWorlds random;
  for (int w = 0; w < 12; ++w) worlds.add(random.scene(w));
  worlds.step(40);
  for (int w = 0; w < 12; ++w) {
    World alone(random.scene(w), worldsOptions());
    test::run(alone, 40);
    ASSERT_EQ(test::stateOf(worlds[w]), test::stateOf(alone)) << "world " << w;
  }
}

TEST(Worlds, StepOnlyThoseOfTheMask) { test::expectMasks({100}, worldsOptions("cpu", 3), 9, 40); }

TEST(Worlds, AThousandResetsTouchNoOtherWorld) {
  test::expectResets({200, 5}, worldsOptions("cpu", 2), 40, 100, 10);
}

TEST(Worlds, EditsOfOneWorldAreThoseOfAWorldAlone) { test::expectEditsAlone({300}, worldsOptions()); }

/// Both engines of a pair find the same after each kernel, with masks and resets.
TEST(Worlds, AgreeInLockstep) {
  Worlds worlds(worldsOptions("lockstep"));
  const RandomWorlds random{400, 5};
  for (int w = 0; w < 3; ++w) worlds.add(random.scene(w));
  const Snapshot start = worlds[2].snapshot();
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(worlds.step(1, std::vector<char>{1, k % 2 == 0, 1}).difference, "");
    if (k == 3) worlds.reset(std::vector<int>{0}, {&start, 1});
  }
}

TEST(Worlds, ArraysHaveOneRowPerBodyOfEachWorld) {
  Worlds worlds(worldsOptions());
  EXPECT_EQ(worlds.addCopies(test::heap(1), 5), 0);
  worlds.step(3);
  const ArrayView view = worlds.array(StateArray::Position);
  ASSERT_EQ(view.shape[0], 5 * 17);
  for (int w = 0; w < 5; ++w)
    for (const BodyId id : worlds[w].bodies()) {
      const auto row = worlds.rowsOf(w)[static_cast<std::size_t>(id.index)];
      EXPECT_EQ(row, worlds.firstRow(w) + id.index);
      const auto* x = reinterpret_cast<const double*>(static_cast<const char*>(view.data) +
                                                      row * view.strides[0]);
      EXPECT_EQ(worlds[w].state(id).position, (Vec3{x[0], x[1], x[2]}));
    }
}

TEST(Worlds, RefuseWhatOneOfManyCannotDo) {
  Worlds worlds(worldsOptions());
  worlds.addCopies(test::tower(1), 2);
  World other(test::tower(1), worldsOptions());
  EXPECT_THROW(worlds[2], Error);
  EXPECT_THROW(worlds.step(1, std::vector<char>(1)), Error);
  EXPECT_THROW(worlds[0].restore(other.snapshot()), Error);
  Params params = worlds.params();
  params.iterations = 7;
  EXPECT_THROW(worlds[0].setParams(params), Error);
  worlds.setParams(params);
  EXPECT_EQ(worlds[1].params().iterations, 7);
}

}  // namespace
}  // namespace rubble
