#include "cook/names.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "tests/support/random.h"

namespace rubble {
namespace {

TEST(Names, DistanceCountsLettersThatDiffer) {
  EXPECT_EQ(editDistance("iterations", "iterations", 3), 0u);
  EXPECT_EQ(editDistance("iteration", "iterations", 3), 1u);
  EXPECT_EQ(editDistance("kitten", "sitting", 3), 3u);
  EXPECT_EQ(editDistance("", "abc", 3), 3u);
}

/// Tries both ways to leave out a letter, and the way that keeps or replaces one.
std::size_t distanceByTrying(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const std::string_view restA = a.substr(1), restB = b.substr(1);
  const std::size_t both = distanceByTrying(restA, restB) + (a[0] == b[0] ? 0 : 1);
  return std::min({both, distanceByTrying(restA, b) + 1, distanceByTrying(a, restB) + 1});
}

TEST(Names, DistanceIsThatOfTheShortestWayUpToTheBound) {
  test::Random random(3);
  const auto word = [&] {
    std::string out(static_cast<std::size_t>(random.below(7)), 'a');
    for (char& letter : out) letter = static_cast<char>('a' + random.below(3));
    return out;
  };
  for (int i = 0; i < 1000; ++i) {
    const std::string a = word(), b = word();
    const std::size_t wanted = distanceByTrying(a, b);
    for (const std::size_t most :
         {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{5}, SIZE_MAX}) {
      const std::size_t found = editDistance(a, b, most);
      if (wanted > most)
        EXPECT_GT(found, most) << a << " " << b;
      else
        EXPECT_EQ(found, wanted) << a << " " << b << " " << most;
    }
  }
}

// A word of a million letters is compared with no name.
TEST(Names, DistanceBeyondTheBoundIsNotComputed) {
  EXPECT_GT(editDistance("ab", "abcdef", 3), 3u);
  const std::string longWord(1'000'000, 'x');
  for (int i = 0; i < 10'000; ++i) ASSERT_GT(editDistance(longWord, "iterations", 3), 3u);
}

}  // namespace
}  // namespace rubble
