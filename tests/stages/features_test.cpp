/// Surface features in their grid.
#include <gtest/gtest.h>

#include "stages/soft/features.h"

namespace rubble::RUBBLE_CORE {
namespace {

TEST(Features, StayWhereTheyAreIfTheirMotionHasNoFiniteLength) {
  Vec3 moved[] = {{Real(1e300), 0, 0}, {0, Real(0.5), 0}};
  ASSERT_TRUE(isFinite(moved[0]));
  SolverData s{};
  s.vertexMoved = moved;
  EXPECT_EQ(length(foundWay(s, 0)), 0);
  EXPECT_EQ(length(foundWay(s, 1)), 0.5);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
