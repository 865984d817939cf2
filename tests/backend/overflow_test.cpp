/// Too little room in any table: the step grows it, says so, and its result is that of a world with room for all.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kSteps = 40;
constexpr int kAmple = 100'000;
const std::vector<std::string> kKinds = {"pairs", "nearPairs", "manifolds", "entries", "colors", "groups", "chunks", "externals"};

std::vector<std::uint64_t> hashesOf(World& world, std::vector<std::string>& grown) {
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < kSteps; ++i) {
    for (const Growth& growth : world.step().grown) {
      EXPECT_GT(growth.needed, 1) << growth.what;
      if (std::find(grown.begin(), grown.end(), growth.what) == grown.end()) grown.push_back(growth.what);
    }
    hashes.push_back(world.hash());
  }
  std::sort(grown.begin(), grown.end());
  return hashes;
}

class Overflow : public ::testing::TestWithParam<const char*> {
 protected:
  /// A world with room for everything but `scarce`, whose tables begin with one element.
  World worldBut(const std::string& scarce) const {
    World world(test::heap(6), test::options(4, GetParam(), 2));
    for (const std::string& kind : kKinds)
      if (kind != scarce && scarce != "all") world.reserve(kind, kAmple);
    return world;
  }
};

TEST_P(Overflow, OfEachTableIsReportedAndChangesNoResult) {
  World ample = worldBut("");
  std::vector<std::string> grown;
  const std::vector<std::uint64_t> wanted = hashesOf(ample, grown);
  EXPECT_TRUE(grown.empty());
  for (const std::string& kind : kKinds) {
    World scarce = worldBut(kind);
    grown.clear();
    EXPECT_EQ(hashesOf(scarce, grown), wanted) << kind;
    EXPECT_EQ(grown, std::vector<std::string>{kind});
  }
}

TEST_P(Overflow, OfAllTablesAtOnceIsReportedAndChangesNoResult) {
  World ample = worldBut(""), scarce = worldBut("all");
  std::vector<std::string> none, grown, all = kKinds;
  std::sort(all.begin(), all.end());
  EXPECT_EQ(hashesOf(scarce, grown), hashesOf(ample, none));
  EXPECT_EQ(grown, all);
}

INSTANTIATE_TEST_SUITE_P(Backends, Overflow, ::testing::Values("cpu", "reference", "lockstep"));

TEST(Reserve, RefusesKindsThatThereAreNot) {
  World world(test::tower(1), test::options());
  EXPECT_THROW(world.reserve("bricks", 5), Error);
  EXPECT_THROW(world.reserve("pairs", -1), Error);
}

}  // namespace
}  // namespace rubble
