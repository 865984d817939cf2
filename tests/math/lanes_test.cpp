/// Lane4 points side by side give what four single points give.
#include <math/lanes.h>

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace rubble::RUBBLE_CORE {
namespace {

Lanes randomLanes(test::Random& random) {
  return {{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)}};
}

/// Runs f(a, b) lane by lane and side by side.
template <class F> void expectSame(F&& f, const Lanes& a, const Lanes& b) {
  Lanes single, together;
  for (int k = 0; k < kLanes; ++k)
    LaneAccess<Real>::store(single, k, f(LaneAccess<Real>::load(a, k), LaneAccess<Real>::load(b, k)));
  LaneAccess<Real4>::store(together, 0, f(LaneAccess<Real4>::load(a, 0), LaneAccess<Real4>::load(b, 0)));
  for (int k = 0; k < kLanes; ++k) EXPECT_EQ(single[k], together[k]) << k;
}

TEST(Lanes, OperationsEqualThoseOnSingleNumbers) {
  test::Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Lanes a = randomLanes(random), b = randomLanes(random);
    expectSame([](auto x, auto y) { return x * y + x / y; }, a, b);
    expectSame([](auto x, auto y) { return minOf(x, y); }, a, b);
    expectSame([](auto x, auto y) { return maxOf(x, y); }, a, b);
    expectSame([](auto x, auto y) { return absOf(x) - absOf(y); }, a, b);
    expectSame([](auto x, auto y) { return sqrtOf(x * x + y * y); }, a, b);
    expectSame([](auto x, auto y) { return select(x < y, x, y * y); }, a, b);
  }
}

TEST(Lanes, MinimumAndMaximumOfZerosKeepTheSignOfTheFirst) {
  const Lanes plus = splatLanes(0.), minus = splatLanes(-0.);
  expectSame([](auto x, auto y) { return minOf(x, y); }, plus, minus);
  expectSame([](auto x, auto y) { return maxOf(x, y); }, minus, plus);
  EXPECT_FALSE(std::signbit(minOf(Real(0.), Real(-0.))));
  EXPECT_TRUE(std::signbit(maxOf(Real(-0.), Real(0.))));
}

TEST(Lanes, SumsAddAllFourInAFixedOrder) {
  const Real4 a{1e16, 1, -1e16, 1};
  EXPECT_EQ(sumOf(a), (1e16 + 1) + (-1e16 + 1));
  EXPECT_EQ(sumOf(Real4{1, 2, 3, 4}), 10);
  EXPECT_EQ(sumOf(Real(7)), 7);
}

TEST(Lanes, SplatFillsEveryLane) {
  const Lanes lanes = splatLanes(3);
  const Real4 four = LaneAccess<Real4>::splat(3);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_EQ(lanes[k], 3);
    EXPECT_EQ(four[k], 3);
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
