/// No table depends on the order in which a loop takes its elements, as threads and lanes of a device may.
#include <gtest/gtest.h>

#include "tests/locality/visitors.h"
#include "tests/physics/random_bins.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

/// The first difference between loops forward and backward in a random bin.
std::string differenceIn(const test::Bin& bin, const Scene& scene, int steps) {
  WorldOptions options = test::options(bin.iterations, "lockstep-backward");
  options.params.dt = bin.dt;
  options.params.sortInterval = 16;  // bodies are sorted within the shortest run
  World world(scene, options);
  for (int i = 0; i < steps; ++i) world.step();
  return world.firstDifference();
}

class OrderOfLoops : public ::testing::TestWithParam<int> {
 protected:
  test::Bin bin() const { return test::randomBin(static_cast<std::uint64_t>(GetParam())); }
};
TEST_P(OrderOfLoops, ChangesNoTable) { EXPECT_EQ(differenceIn(bin(), bin().scene, 30), ""); }
INSTANTIATE_TEST_SUITE_P(Random, OrderOfLoops, ::testing::Range(0, 16));
INSTANTIATE_TEST_SUITE_P(LongRandom, OrderOfLoops, ::testing::Range(16, 400));

class LongOrderOfLoops : public OrderOfLoops {};
TEST_P(LongOrderOfLoops, ChangesNoTableBesideClothRopesAndSolids) {
  const Scene scene = test::withVisitorsFirst(bin().scene, test::visitors(50));
  EXPECT_EQ(differenceIn(bin(), scene, 120), "");
}
INSTANTIATE_TEST_SUITE_P(LongRandom, LongOrderOfLoops, ::testing::Range(0, 20));

}  // namespace
}  // namespace rubble
