/// Privatized counting: each thread counts its share.
#include <numeric>

#include "tests/support/core_world.h"

namespace rubble::RUBBLE_CORE {
namespace {

TEST(PrivatizedCount, ListsEachElementOnceBehindTheOffsetOfItsColor) {
  // more colors than are counted together, and elements of none
  constexpr int kColors = 2 * kCountedColors + 10, kElements = 5000;
  const auto colorOf = [](int i) {
    return static_cast<int>(hash32(static_cast<std::uint32_t>(i)) % (kColors + 1)) - 1;
  };
  const auto inParts = [&](auto&& part) {
    for (int begin = 0; begin < kElements; begin += 700) part(begin, std::min(begin + 700, kElements));
  };
  std::vector<int> count(kColors), offset(kColors + 1), list(kElements, -1);
  inParts([&](int begin, int end) { addColors(begin, end, colorOf, count.data()); });
  std::vector<int> expected(kColors);
  for (int i = 0; i < kElements; ++i)
    if (colorOf(i) >= 0) ++expected[static_cast<std::size_t>(colorOf(i))];
  EXPECT_EQ(count, expected);
  std::partial_sum(count.begin(), count.end(), offset.begin() + 1);
  inParts(
      [&](int begin, int end) { listColors(begin, end, colorOf, offset.data(), count.data(), list.data()); });
  EXPECT_EQ(count, std::vector<int>(kColors));
  std::vector<int> found(kElements);
  for (int c = 0; c < kColors; ++c)
    for (int k = offset[static_cast<std::size_t>(c)]; k < offset[static_cast<std::size_t>(c) + 1]; ++k) {
      const int i = list[static_cast<std::size_t>(k)];
      ASSERT_GE(i, 0);
      EXPECT_EQ(colorOf(i), c);
      ++found[static_cast<std::size_t>(i)];
    }
  for (int i = 0; i < kElements; ++i)
    EXPECT_EQ(found[static_cast<std::size_t>(i)], colorOf(i) >= 0 ? 1 : 0) << i;
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
