/// Lists of the elements of a rank are those of one thread, in the same order.
#include <backend/distributed/rank_part.h>
#include <gtest/gtest.h>

#include <random>

namespace rubble::RUBBLE_CORE {
namespace {

using Take = RankLister::Take;
/// Several ranges, and a number that threads do not divide.
constexpr int kMany = 3 * kLeastOfRange + 7;

TEST(RankLister, ListsInTheOrderOfTheElementsTheCountedOnesFirst) {
  std::mt19937 random(3);
  for (const int n : {0, 5, kMany}) {
    std::vector<Take> takes;
    for (int i = 0; i < n; ++i) takes.push_back(static_cast<Take>(random() % 3));
    std::vector<int> expected, others;
    for (int i = 0; i < n; ++i) {
      if (takes[std::size_t(i)] == Take::Counted) expected.push_back(2 * i);
      if (takes[std::size_t(i)] == Take::Other) others.push_back(2 * i);
    }
    const int counted = static_cast<int>(expected.size());
    expected.insert(expected.end(), others.begin(), others.end());
    for (const int threads : {1, 3}) {
      RankLister lister(threads);
      RankPart list;
      lister.list(
          list, n, [&](int i) { return takes[std::size_t(i)]; }, [](int i) { return 2 * i; });
      EXPECT_EQ(list.index == expected, true) << n << " elements, " << threads << " threads";
      EXPECT_EQ(list.counted, counted);
    }
  }
}

TEST(RankLister, GroupsKeepTheOrderOfTheList) {
  constexpr int kGroups = 5;
  const auto keyOf = [](int element) { return element * 7 % (kGroups + 1) - 1; };
  for (const int threads : {1, 3}) {
    RankLister lister(threads);
    RankPart list;
    lister.list(list, kMany, [](int i) { return i % 3 == 0 ? Take::Other : Take::Counted; });
    RankGroups groups;
    lister.group(groups, list, kGroups, keyOf);
    for (int g = 0; g < kGroups; ++g) {
      std::vector<int> expected;
      int counted = 0;
      for (int k = 0; k < list.size(); ++k)
        if (keyOf(list.index[std::size_t(k)]) == g) {
          expected.push_back(list.index[std::size_t(k)]);
          counted += k < list.counted;
        }
      const Division::Part part = groups.part(g);
      EXPECT_EQ(std::vector<int>(part.index, part.index + part.count) == expected, true) << g;
      EXPECT_EQ(part.counted, counted) << g;
    }
  }
}

TEST(RankPart, OfTwoOthersHasTheCountedElementsOfBothFirst) {
  RankPart both;
  both.join({{1, 2, 3}, 2}, {{4, 5}, 1});
  EXPECT_EQ(both.index, (std::vector{1, 2, 4, 3, 5}));
  EXPECT_EQ(both.counted, 3);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
