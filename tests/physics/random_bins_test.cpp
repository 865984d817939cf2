/// Random bins and random throws: nothing leaves, nothing passes, whatever the shapes, sizes, speeds and
/// walls.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/physics/bullets.h"
#include "tests/physics/random_bins.h"

namespace rubble::test {
namespace {

/// Outcome of many bins.
struct BinCount {
  int left = 0, unsettled = 0, quarantined = 0, failed = 0;
};
BinCount settleBins(std::uint64_t first, std::uint64_t last) {
  BinCount count;
  for (std::uint64_t seed = first; seed < last; ++seed) {
    const BinOutcome out = settle(randomBin(seed));
    count.left += out.outside > 0, count.unsettled += out.unsettled > 0,
        count.quarantined += out.quarantined > 0, count.failed += !out.holds();
    if (!out.holds())
      std::cout << "bin " << seed << ": " << out.outside << " left, " << out.restless << " move, depth "
                << out.depth << ", energy +" << out.energyGain << '\n';
  }
  return count;
}

/// How many bins fail is a figure that docs/scenes.md states under Open; these bounds are what holds today,
/// and none but a lower one takes their place.
TEST(RandomBins, KeepWhatIsThrownIn) {
  const BinCount count = settleBins(0, 40);
  EXPECT_EQ(count.left, 0);
  EXPECT_LE(count.unsettled, 1);
  EXPECT_EQ(count.quarantined, 0);
  EXPECT_LE(count.failed, 4);
}
TEST(LongRandomBins, KeepWhatIsThrownIn) {
  const BinCount count = settleBins(0, 2000);
  EXPECT_LE(count.left, 6);
  EXPECT_EQ(count.quarantined, 0);
}

/// Throws of which the kinetic energy ever is more than 1.02 times that of the start: that of a free body
/// that turns by more than 0.8 rad in a step is off by up to that.
int gaining(std::uint64_t first, std::uint64_t last) {
  int count = 0;
  for (std::uint64_t seed = first; seed < last; ++seed) count += take(randomThrow(seed)).gain > .02;
  return count;
}
TEST(Bullets, SeldomGainEnergy) { EXPECT_LE(gaining(0, 2000), 5); }

int passed(std::uint64_t first, std::uint64_t last) {
  int count = 0;
  for (std::uint64_t seed = first; seed < last; ++seed) {
    const Throw shot = randomThrow(seed);
    if (!take(shot).passed) continue;
    ++count;
    std::cout << "throw " << seed << ": " << shot.bullet << " at " << shot.plate << ", " << shot.speed
              << " m/s\n";
  }
  return count;
}
TEST(Bullets, DoNotPassPlates) { EXPECT_EQ(passed(0, 2000), 0); }
TEST(LongBullets, DoNotPassPlates) { EXPECT_EQ(passed(0, 20000), 0); }

}  // namespace
}  // namespace rubble::test
