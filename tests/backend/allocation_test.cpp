/// A steady step allocates nothing. Every `new` of this program is counted.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/support/scenes.h"

namespace {
std::atomic<long> allocations{0};

void* countedOrNull(std::size_t bytes, std::size_t alignment) noexcept {
  ++allocations;
  const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
  return std::aligned_alloc(alignment, rounded ? rounded : alignment);
}
void* counted(std::size_t bytes, std::size_t alignment) {
  if (void* p = countedOrNull(bytes, alignment)) return p;
  throw std::bad_alloc();
}
}  // namespace

// Not inlined: a compiler that saw both sides would take free() for a mismatch of the new above it.
#define RUBBLE_NOINLINE __attribute__((noinline))
RUBBLE_NOINLINE void* operator new(std::size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
RUBBLE_NOINLINE void* operator new[](std::size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
RUBBLE_NOINLINE void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return countedOrNull(bytes, alignof(std::max_align_t));
}
RUBBLE_NOINLINE void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return countedOrNull(bytes, alignof(std::max_align_t));
}
RUBBLE_NOINLINE void* operator new(std::size_t bytes, std::align_val_t a) {
  return counted(bytes, static_cast<std::size_t>(a));
}
RUBBLE_NOINLINE void* operator new[](std::size_t bytes, std::align_val_t a) {
  return counted(bytes, static_cast<std::size_t>(a));
}
RUBBLE_NOINLINE void operator delete(void* p) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete[](void* p) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete(void* p, std::size_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

namespace rubble {
namespace {

constexpr int kSteps = 20;

/// Allocations in kSteps steps of a settled pile.
long allocationsOfSteadySteps(int threads) {
  WorldOptions options = test::options(4, "cpu", threads);
  options.timings = false;
  World world(test::heap(8), options);
  test::run(world, 300);
  const std::size_t bytes = world.memoryBytes();
  const long before = allocations;
  test::run(world, kSteps);
  const long after = allocations;
  EXPECT_EQ(world.memoryBytes(), bytes);
  return after - before;
}

TEST(SteadyStep, CountsAllocations) {
  const long before = allocations;
  ::operator delete(::operator new(sizeof(int)));  // a new-expression might be left out by the compiler
  EXPECT_EQ(allocations, before + 1);
}

TEST(SteadyStep, AllocatesNothingOnOneThread) { EXPECT_EQ(allocationsOfSteadySteps(1), 0); }

TEST(SteadyStep, AllocatesNothingOnThreeThreads) { EXPECT_EQ(allocationsOfSteadySteps(3), 0); }

TEST(SteadyStep, AllocatesForItsReportOnlyWhenTimed) {
  World world(test::heap(8), test::options(4, "cpu", 1));
  test::run(world, 300);
  const long before = allocations;
  test::run(world, kSteps);
  // the list of stages: a few growths of one vector
  EXPECT_LE(allocations - before, 8 * kSteps);
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
