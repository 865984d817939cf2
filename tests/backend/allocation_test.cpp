/// A steady step allocates nothing.
#include <gtest/gtest.h>
#include <rubble/worlds.h>

#include "tests/backend/counted_memory.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kCountedSteps = 20;

/// Allocations in kCountedSteps steps of a settled pile.
long allocationsOfSteadySteps(int threads) {
  WorldOptions options = test::options(4, "cpu", threads);
  options.timings = false;
  World world(test::heap(8), options);
  test::run(world, 300);
  const std::size_t bytes = world.memoryBytes();
  const long before = test::allocations();
  test::run(world, kCountedSteps);
  const long after = test::allocations();
  EXPECT_EQ(world.memoryBytes(), bytes);
  return after - before;
}

TEST(SteadyStep, CountsAllocations) {
  if (!test::countsAllocations()) GTEST_SKIP() << "a sanitizer has operators of its own";
  const long before = test::allocations();
  ::operator delete(::operator new(sizeof(int)));  // a new-expression might be left out by the compiler
  EXPECT_EQ(test::allocations(), before + 1);
}

TEST(SteadyStep, AllocatesNothingOnOneThread) { EXPECT_EQ(allocationsOfSteadySteps(1), 0); }

TEST(SteadyStep, AllocatesNothingOnThreeThreads) { EXPECT_EQ(allocationsOfSteadySteps(3), 0); }

TEST(SteadyStep, AllocatesForItsReportOnlyWhenTimed) {
  World world(test::heap(8), test::options(4, "cpu", 1));
  test::run(world, 300);
  const long before = test::allocations();
  test::run(world, kCountedSteps);
  // the list of stages: a few growths of one vector
  EXPECT_LE(test::allocations() - before, 8 * kCountedSteps);
}

TEST(Reset, OfAWorldWithPairRulesLeavesOtherWorldsAlone) {
  // worlds of one batch
  const auto allocationsOf = [](int count) {
    Scene scene = test::tower(1);
    for (BodyDef& body : scene.bodies) body.material.name = "stone";
    scene.materialPairs.push_back({"stone", "stone", 0.3, 0.2});
    Worlds worlds(test::options(4, "cpu", 1));
    worlds.addCopies(scene, count);
    worlds.step(3);
    const Snapshot start = worlds[0].snapshot();
    const std::vector<int> first{0};
    worlds.reset(first, {&start, 1});
    worlds.step(1);
    const long before = test::allocations();
    worlds.reset(first, {&start, 1});
    worlds.step(1);
    return test::allocations() - before;
  };
  // a few lists by world grow by doubling
  EXPECT_LE(allocationsOf(32), allocationsOf(4) + 24);
}

TEST(Capacity, GrowsWithTheWorldAndStaysGrown) {
  World world(test::tower(1), test::options(4));
  test::run(world, 3);
  const std::size_t small = world.memoryBytes();
  std::vector<BodyId> added;
  for (int i = 0; i < 500; ++i)
    added.push_back(world.addBody(test::unitCube({2. * (i % 25), 2. * (i / 25) + 2, .5})));
  test::run(world, 3);
  const std::size_t large = world.memoryBytes();
  EXPECT_GT(large, small);
  // a settled body of a sparse scene takes a few kilobytes
  EXPECT_LT(large, 8192u * 500u + small);
  for (const BodyId id : added) world.removeBody(id);
  test::run(world, 3);
  EXPECT_EQ(world.memoryBytes(), large);
}

}  // namespace
}  // namespace rubble
