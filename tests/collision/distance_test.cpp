/// Distances of spheres and capsules in closed form against those over many points, and times of impact
/// against dense sampling in time.
#include <collision/distance.h>
#include <collision/ray.h>

#include "tests/collision/shapes_for_tests.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

Placed somewhere(Random& random, const ShapeData& shape, double spread) {
  return placed(shape, Vec3d(random.vector(1)) * spread, Quatd(random.rotation()));
}
SweptMotion someWay(Random& random, double move, double turn) {
  return {Vec3d(random.vector(1)) * move, Vec3d(random.vector(1)) * turn};
}

/// Least distance of points along the two axes, less both radii.
double sampledDistance(const Placed& a, const Placed& b) {
  constexpr int kSamples = 400;
  const Vec3d u = rotate(a.q, Vec3d(a.shape.half)), v = rotate(b.q, Vec3d(b.shape.half));
  double least = 1e30;
  for (int i = 0; i <= kSamples; ++i)
    for (int j = 0; j <= kSamples; ++j)
      least = std::min(least, length(a.p + u * (2. * i / kSamples - 1) - b.p - v * (2. * j / kSamples - 1)));
  return least - a.radius() - b.radius();
}

TEST(Distance, OfRoundBodiesIsTheLeastOverTheirAxes) {
  Random random(7);
  const ShapeData shapes[] = {sphere(Real(.2)), capsule(Real(.1), Real(.5)), capsule(Real(.15), Real(.3))};
  for (int k = 0; k < 60; ++k) {
    const Placed a = somewhere(random, shapes[k % 3], 1.);
    Placed b = somewhere(random, shapes[k / 3 % 3], 1.);
    // every fifth pair is parallel
    if (k % 5 == 0) b.q = a.q;
    const Separation s = separation(a, b);
    EXPECT_NEAR(s.distance, sampledDistance(a, b), 3e-5) << k;
    EXPECT_NEAR(length(s.n), 1, 1e-12);
    EXPECT_NEAR(length(s.onB - s.onA - s.n * s.distance), 0, 1e-12);
  }
}

TEST(Distance, OfRoundBodiesIsThatOfTheGeneralSearch) {
  Random random(8);
  const ShapeData shapes[] = {sphere(Real(.2)), capsule(Real(.1), Real(.5)), capsule(Real(.15), Real(.3))};
  for (int k = 0; k < 300; ++k) {
    const Placed a = somewhere(random, shapes[k % 3], 1.), b = somewhere(random, shapes[k / 3 % 3], 1.);
    EXPECT_NEAR(gjk::lines(a, b).distance, gjk::cores(a, b).distance, 1e-9) << k;
  }
}

TEST(Ray, OfNoLengthHitsOnlyWhatHoldsIt) {
  EXPECT_EQ(rays::sphere({2, 0, 0}, {0, 0, 0}, 1).fraction, rays::kNever);
  EXPECT_EQ(rays::sphere({.5, 0, 0}, {0, 0, 0}, 1).fraction, 0);
}

TEST(Distance, OfCrossingAxesIsThatOfTheirRadii) {
  const ShapeData rod = capsule(Real(.1), Real(.5));
  const Placed a = placed(rod, {0, 0, 0}, Quatd{}),
               b = placed(rod, {0, 0, .2}, Quatd(fromAxisAngle(Vec3{1, 0, 0}, Real(1))));
  EXPECT_NEAR(separation(a, b).distance, -.2, 1e-7);
}

/// Spheres in contact go as deep as they may and no deeper, however fast they spin.
TEST(TimeOfImpact, OfSpheresInContactDoesNotDependOnTheirSpin) {
  Random random(9);
  const ShapeData ball = sphere(Real(.1));
  constexpr double kApart = .2, kAllowed = .01, kMore = .002;
  int deeper = 0;
  for (int k = 0; k < 200; ++k) {
    const Vec3d n = normalize(Vec3d(random.vector(1)));
    const Placed a = placed(ball, {0, 0, 0}, Quatd{}), b = placed(ball, n * kApart, Quatd{});
    const SweptMotion still = someWay(random, .1, 0), way = someWay(random, .1, 0);
    const SweptMotion spins{still.move, Vec3d(random.vector(20))}, also{way.move, Vec3d(random.vector(20))};
    const TimeOfImpact m = timeOfImpactBeyond(a, still, b, way, n, false, kAllowed, kMore),
                       turned = timeOfImpactBeyond(a, spins, b, also, n, k % 2 == 0, kAllowed, kMore);
    EXPECT_NEAR(turned.fraction, m.fraction, 1e-12) << k;
    if (m.fraction > 1) continue;
    ++deeper;
    const double distance = length(b.p - a.p + (way.move - still.move) * m.fraction) - kApart;
    EXPECT_NEAR(distance, -kAllowed, kMore) << k;
  }
  EXPECT_GT(deeper, 20);
}

/// For fast-spinning bodies the time of impact is neither missed nor invented, also where motions end early
/// or go on another way.
TEST(TimeOfImpact, IsNeverMissedAndNeverInventedWhereBodiesSpin) {
  constexpr int kSamples = 2000;
  constexpr double kTolerance = 1e-3;
  Random random(9);
  const ShapeData shapes[] = {sphere(Real(.2)), capsule(Real(.1), Real(.5)),
                              box({Real(.3), Real(.05), Real(.2)}), box({Real(.1), Real(.1), Real(.1)})};
  int impacts = 0, misses = 0;
  for (int k = 0; k < 320; ++k) {
    const Placed a = somewhere(random, shapes[k % 4], .6), b = somewhere(random, shapes[k / 4 % 4], .6);
    SweptMotion motionA = someWay(random, .6, 3.), motionB = someWay(random, .6, 3.);
    if (k % 3 == 0) motionA.until = .2 + .1 * (k % 5);
    if (k % 5 == 0) motionB.until = .1 + .2 * (k % 4);
    if (k % 6 == 0) motionA.after = Vec3d(random.vector(.6));
    if (separation(a, b).distance <= kTolerance) continue;
    const TimeOfImpact m = timeOfImpact(a, motionA, b, motionB, kTolerance);
    const bool meets = m.fraction <= 1;
    ++(meets ? impacts : misses);
    if (meets) {
      EXPECT_LE(separation(movedBy(a, motionA, m.fraction), movedBy(b, motionB, m.fraction)).distance,
                kTolerance)
          << k;
    }
    for (int i = 0; i <= kSamples; ++i) {
      const double t = (meets ? m.fraction : 1) * i / kSamples;
      ASSERT_GT(separation(movedBy(a, motionA, t), movedBy(b, motionB, t)).distance, .49 * kTolerance)
          << k << " at " << t;
    }
  }
  EXPECT_GT(impacts, 30);
  EXPECT_GT(misses, 30);
}

/// Two spheres of radius 0.1 on the x axis, 1.2 apart. The first one moves by 4 and may end before the step.
TEST(TimeOfImpact, HeedsThatAMotionEndsWithinTheStep) {
  constexpr double kTolerance = 1e-6;
  const Placed a = placed(sphere(.1), {0, 0, 0}, Quatd{}), b = placed(sphere(.1), {1.2, 0, 0}, Quatd{});
  const auto fraction = [&](double untilA, double moveB, double untilB) {
    return timeOfImpact(a, {{4, 0, 0}, {}, untilA}, b, {{moveB, 0, 0}, {}, untilB}, kTolerance).fraction;
  };
  // B stands still after a quarter of the step, 0.75 further, and A reaches it there
  EXPECT_NEAR(fraction(1, 3, .25), (1 + .75) / 4, 1e-5);
  // A ends before B, and B does not come closer
  EXPECT_GT(fraction(.1, 3, .25), 1);
  // A ends short of B, and B comes to it
  EXPECT_NEAR(fraction(.125, -1, 1), .5, 1e-5);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
