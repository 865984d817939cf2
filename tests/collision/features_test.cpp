/// Nearest points of parts of surfaces against brute force, and times of impact against dense sampling in
/// time.
#include <collision/features.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/random.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// The least distance over a fine grid of points of both sides.
Real sampledDistance(const Vec3 (&x)[4], int sideA) {
  constexpr int kSteps = 60;
  Real best = 1e30;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j) {
      const Real u = Real(i) / kSteps, v = Real(j) / kSteps;
      if (sideA == 2)
        best = std::min(best, length(x[0] + u * (x[1] - x[0]) - x[2] - v * (x[3] - x[2])));
      else if (i + j <= kSteps)
        best = std::min(best, length(x[0] - x[1] - u * (x[2] - x[1]) - v * (x[3] - x[1])));
    }
  return best;
}

void randomCorners(Random& random, Vec3 (&x)[4]) {
  for (Vec3& corner : x) corner = random.vector();
  // some long and thin, some that are nearly parallel
  if (random.below(4) == 0) x[3] = x[2] + (x[1] - x[0]) + random.vector(1e-4);
  if (random.below(4) == 0) x[2] = x[1] + random.vector(.05);
}

TEST(Features, NearestPointsAreThoseOfAFineSampling) {
  Random random(3);
  for (int sideA : {1, 2})
    for (int i = 0; i < 300; ++i) {
      Vec3 x[4];
      randomCorners(random, x);
      Real c[4];
      const Vec3 gap = nearestOfFeatures(x, sideA, c);
      const Real sampled = sampledDistance(x, sideA), size = Real(4) / 60;
      EXPECT_LE(length(gap), sampled + 1e-9);
      EXPECT_GE(length(gap), sampled - size);
      Vec3 sum{0, 0, 0};
      Real a = 0, b = 0;
      for (int k = 0; k < 4; ++k) {
        sum += c[k] * x[k];
        (k < sideA ? a : b) += c[k];
        EXPECT_GE(k < sideA ? c[k] : -c[k], 0);
      }
      EXPECT_LT(length(sum - gap), 1e-12);
      EXPECT_NEAR(a, 1, 1e-12);
      EXPECT_NEAR(b, -1, 1e-12);
    }
}

/// Exactly parallel edges have no single nearest points: an end of one of them serves.
TEST(Features, NearestPointsOfParallelEdgesAreAtAnEnd) {
  Random random(13);
  for (const Real shift : {-3., -.4, 0., .3, 2.})
    for (const Real times : {.25, 1., -2.}) {
      const Vec3 at = random.vector(), along = random.direction(), off = cross(along, random.direction());
      const Vec3 start = at + off + shift * along;
      const Vec3 x[4] = {at, at + along, start, start + times * along};
      Real c[4];
      const Vec3 gap = nearestOfFeatures(x, 2, c);
      const Real first = std::min(shift, shift + times), last = std::max(shift, shift + times);
      const Real apart = std::max({Real(0), first - 1, -last});
      EXPECT_NEAR(length(gap), std::hypot(length(off), apart), 1e-12) << shift << " " << times;
      EXPECT_LT(length(c[0] * x[0] + c[1] * x[1] + c[2] * x[2] + c[3] * x[3] - gap), 1e-12);
    }
}

TEST(Features, NearestPointsScaleWithTheEdges) {
  for (const Real size : {1e-9, 1., 1e6}) {
    const Vec3 x[4] = {{-size, 0, 0}, {3 * size, 0, 0}, {0, -size, size}, {0, size, size}};
    Real c[4];
    EXPECT_NEAR(length(nearestOfFeatures(x, 2, c)) / size, 1, 1e-12) << size;
    EXPECT_NEAR(c[1], .25, 1e-12) << size;
    EXPECT_NEAR(c[3], -.5, 1e-12) << size;
  }
}

TEST(Features, NearestPointOfATriangleWithoutAreaIsThatOfItsSides) {
  const Vec3 corner[3] = {{5, 5, 5}, {7, 5, 5}, {6, 5, 5}};
  for (const Real along : {-1., .25, 1.5, 3.}) {
    const Vec3 x[4] = {{5 + along, 5, 6}, corner[0], corner[1], corner[2]};
    Real c[4];
    const Real beyond = std::max({Real(0), -along, along - 2});
    EXPECT_NEAR(length(nearestOfFeatures(x, 1, c)), std::hypot(Real(1), beyond), 1e-12) << along;
  }
}

TEST(Features, MeetingIsNeverMissedAndNeverInvented) {
  Random random(5);
  int impacts = 0, misses = 0;
  for (int sideA : {1, 2})
    for (int i = 0; i < 2000; ++i) {
      Vec3 x[4], move[4];
      for (Vec3& corner : x) corner = random.vector();
      const Vec3 common = random.vector(20);
      for (Vec3& m : move) m = common + random.vector(1.5);
      Real c[4];
      const Real distance = length(nearestOfFeatures(x, sideA, c)), keep = Real(.2) * distance;
      const FeatureImpact m = firstImpact(x, move, sideA, keep);
      Real least = distance, atImpact = distance;
      constexpr int kSamples = 400;
      for (int k = 0; k <= kSamples; ++k) {
        const Real t = Real(k) / kSamples;
        Vec3 at[4];
        for (int j = 0; j < 4; ++j) at[j] = x[j] + t * move[j];
        const Real d = length(nearestOfFeatures(at, sideA, c));
        least = std::min(least, d);
        // before the impact nothing comes closer than the reported distance
        if (t <= m.time) {
          EXPECT_GT(d, keep * (1 - 1e-9));
        }
      }
      {
        Vec3 at[4];
        for (int j = 0; j < 4; ++j) at[j] = x[j] + m.time * move[j];
        atImpact = length(nearestOfFeatures(at, sideA, c));
      }
      if (m.meets) {
        ++impacts;
        EXPECT_LT(atImpact, keep + Real(.11) * (distance - keep));
      } else {
        ++misses;
        EXPECT_GT(least, keep * (1 - 1e-9));
      }
    }
  EXPECT_GT(impacts, 200);
  EXPECT_GT(misses, 200);
}

TEST(Features, ThatFlyTogetherNeverMeetHoweverFastTheyAre) {
  const Vec3 x[4] = {{.3, .3, 1e-4}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Vec3 move[4] = {{100, 50, -80}, {100, 50, -80}, {100, 50, -80}, {100, 50, -80}};
  EXPECT_FALSE(firstImpact(x, move, 1, Real(2.5e-5)).meets);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
