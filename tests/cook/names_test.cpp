#include "cook/names.h"

#include <gtest/gtest.h>

#include <string>

namespace rubble {
namespace {

TEST(Names, DistanceCountsLettersThatDiffer) {
  EXPECT_EQ(editDistance("iterations", "iterations", 3), 0u);
  EXPECT_EQ(editDistance("iteration", "iterations", 3), 1u);
  EXPECT_EQ(editDistance("kitten", "sitting", 3), 3u);
  EXPECT_EQ(editDistance("", "abc", 3), 3u);
}

// A word of a million letters is compared with no name.
TEST(Names, DistanceBeyondTheBoundIsNotComputed) {
  EXPECT_GT(editDistance("ab", "abcdef", 3), 3u);
  const std::string longWord(1'000'000, 'x');
  for (int i = 0; i < 10'000; ++i) ASSERT_GT(editDistance(longWord, "iterations", 3), 3u);
}

}  // namespace
}  // namespace rubble
