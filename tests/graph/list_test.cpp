/// Lists of the parts of islands.
#include <stages/island_momentum.h>

#include <algorithm>
#include <vector>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

TEST(SortList, PutsAnyListInOrder) {
  test::Random random(1);
  for (const int size : {1, 2, 3, 7, 64, 100}) {
    std::vector<int> order(static_cast<std::size_t>(size)), next(1000);
    std::vector<bool> used(next.size());
    for (int& i : order) {
      do i = random.below(1000);
      while (used[static_cast<std::size_t>(i)]);
      used[static_cast<std::size_t>(i)] = true;
    }
    int first = -1;
    for (const int i : order) pushOnList(&first, next.data(), i);
    std::vector<int> out;
    for (int i = sortList(next.data(), first); i >= 0; i = next[static_cast<std::size_t>(i)]) out.push_back(i);
    std::sort(order.begin(), order.end());
    EXPECT_EQ(out, order);
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
