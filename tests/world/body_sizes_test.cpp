/// The median and the largest of numbers that come and go, against sorted ones.
#include <world/body_sizes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/random.h"

namespace rubble {
namespace {

TEST(Tally, HasTheMedianAndTheLargestOfWhatIsThere) {
  test::Random random(7);
  Tally tally;
  std::vector<double> numbers;
  EXPECT_TRUE(tally.empty());
  EXPECT_EQ(tally.largest(), 0);
  for (int n = 0; n < 3000; ++n) {
    // many of the same, and runs in which nearly all go
    const bool goes = !numbers.empty() && random.below(100) < (n / 300 % 2 == 0 ? 30 : 70);
    if (goes) {
      const auto place = numbers.begin() + random.below(static_cast<int>(numbers.size()));
      tally.count(*place, -1);
      numbers.erase(place);
    } else {
      numbers.push_back(.25 * random.below(40));
      tally.count(numbers.back(), 1);
    }
    ASSERT_EQ(tally.empty(), numbers.empty());
    if (numbers.empty()) continue;
    std::vector<double> sorted = numbers;
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(tally.median(), sorted[sorted.size() / 2]);
    ASSERT_EQ(tally.largest(), sorted.back());
  }
}

}  // namespace
}  // namespace rubble
