/// The hash table of pairs of bodies that do not collide (tables/exclusions.h).
#include <gtest/gtest.h>

#include <set>

#include "stages/pairs/filter.h"
#include "tables/exclusions.h"
#include "tests/support/core_world.h"

namespace rubble::RUBBLE_CORE {
namespace {

TEST(Exclusions, AreThoseThatWereAddedAndNotRemoved) {
  test::Random random(3);
  CoreWorld world;
  HostTables& tables = world.executor().tables();
  std::set<std::pair<int, int>> wanted;
  constexpr int kIds = 40, kEdits = 4000;
  for (int edit = 0; edit < kEdits; ++edit) {
    const int a = random.below(kIds), b = (a + 1 + random.below(kIds - 1)) % kIds;
    // grows at first, then shrinks to nothing
    const bool excluded = random.below(kEdits) > edit;
    std::vector<int> changed;
    const std::vector<ExcludedPair> before = copyOf(tables.view().exclusion, tables.view().exclusions);
    setExcluded(tables, a, b, excluded, &changed);
    if (excluded)
      wanted.insert(std::minmax(a, b));
    else
      wanted.erase(std::minmax(a, b));
    const SolverData& s = tables.view();
    // what has changed is reported
    for (int k = 0; k < s.exclusions && static_cast<std::size_t>(s.exclusions) == before.size(); ++k) {
      const bool reported = std::find(changed.begin(), changed.end(), k) != changed.end();
      ASSERT_TRUE(reported || s.exclusion[k] == before[static_cast<std::size_t>(k)]);
    }
    if (edit % 50 != 0) continue;
    for (int i = 0; i < kIds; ++i)
      for (int j = i + 1; j < kIds; ++j) ASSERT_EQ(isExcluded(s, {i, j}), wanted.contains({i, j})) << edit;
    EXPECT_EQ(tables.excludedPairs, static_cast<int>(wanted.size()));
  }
  while (!wanted.empty()) {
    setExcluded(tables, wanted.begin()->first, wanted.begin()->second, false);
    wanted.erase(wanted.begin());
  }
  EXPECT_EQ(tables.view().exclusions, 0) << "nothing is looked up any more";
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
