/// Claims about math/trig.h, for the precision that the including file defines.
#include <math/trig.h>

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/library.h"
#include "tests/support/random.h"

namespace rubble::RUBBLE_CORE {
namespace {

constexpr long double kUnit = std::numeric_limits<Real>::epsilon();

void expectSinCos(Real x, long double tolerance) {
  const SinCos got = sinCos(x);
  EXPECT_NEAR(static_cast<double>(got.sin - std::sin(static_cast<long double>(x))), 0,
              static_cast<double>(tolerance))
      << x;
  EXPECT_NEAR(static_cast<double>(got.cos - std::cos(static_cast<long double>(x))), 0,
              static_cast<double>(tolerance))
      << x;
}

TEST(RUBBLE_TRIG_SUITE, SineAndCosineAreWithinTwoUnitsInTheLastPlace) {
  if (!test::kReducesAngles) GTEST_SKIP() << "the C library is less exact";
  test::Random random(7);
  for (int i = 0; i < 20000; ++i) {
    expectSinCos(static_cast<Real>(random.uniform(-10, 10)), 2 * kUnit);
    expectSinCos(static_cast<Real>(random.uniform(-1e6, 1e6)), 2 * kUnit);
    expectSinCos(static_cast<Real>(random.uniform(-1e9, 1e9)), 1e-6L);
  }
  for (int k = -8; k <= 8; ++k) expectSinCos(static_cast<Real>(k * std::numbers::pi / 4), 2 * kUnit);
}

TEST(RUBBLE_TRIG_SUITE, SmallAnglesKeepTheirRelativePrecision) {
  for (double x = 1e-30; x < .5; x *= 3) {
    const Real a = static_cast<Real>(x);
    EXPECT_NEAR(static_cast<double>(sinCos(a).sin / std::sin(a)), 1, static_cast<double>(4 * kUnit)) << x;
  }
}

TEST(RUBBLE_TRIG_SUITE, HugeAnglesStayOnTheCircleAndOthersAreNoNumbers) {
  const Real largest = std::numeric_limits<Real>::max();
  EXPECT_EQ(sinCos(largest).sin, sinCos(Real(1e9)).sin);
  for (const Real x : {std::numeric_limits<Real>::infinity(), -std::numeric_limits<Real>::infinity(),
                       std::numeric_limits<Real>::quiet_NaN()}) {
    EXPECT_TRUE(std::isnan(sinCos(x).sin));
    EXPECT_TRUE(std::isnan(sinCos(x).cos));
  }
}

TEST(RUBBLE_TRIG_SUITE, AnglesOfVectorsAreWithinFourUnitsInTheLastPlace) {
  test::Random random(8);
  for (int i = 0; i < 20000; ++i) {
    const Real s = static_cast<Real>(random.uniform(0, 1)), c = static_cast<Real>(random.uniform(0, 1));
    const long double wanted = std::atan2(static_cast<long double>(s), static_cast<long double>(c));
    EXPECT_NEAR(static_cast<double>((angleOf(s, c) - wanted) / wanted), 0, static_cast<double>(4 * kUnit))
        << s << " " << c;
  }
  EXPECT_EQ(angleOf(Real(0), Real(1)), Real(0));
  EXPECT_NEAR(static_cast<double>(angleOf(Real(1), Real(0))), std::numbers::pi / 2,
              static_cast<double>(2 * kUnit));
}

TEST(RUBBLE_TRIG_SUITE, SignedAnglesAreThoseOfVectorsOfAnyLengthAndDirection) {
  test::Random random(9);
  for (int i = 0; i < 20000; ++i) {
    const double length = random.logUniform(1e-30, 1e30);
    const Real s = static_cast<Real>(random.uniform(-1, 1) * length),
               c = static_cast<Real>(random.uniform(-1, 1) * length);
    const long double wanted = std::atan2(static_cast<long double>(s), static_cast<long double>(c));
    EXPECT_NEAR(static_cast<double>((signedAngleOf(s, c) - wanted) / wanted), 0,
                static_cast<double>(6 * kUnit))
        << s << " " << c;
  }
  EXPECT_EQ(signedAngleOf(0, 0), Real(0));
  EXPECT_EQ(signedAngleOf(0, 1), Real(0));
  EXPECT_NEAR(static_cast<double>(signedAngleOf(0, -1)), std::numbers::pi, static_cast<double>(4 * kUnit));
  EXPECT_NEAR(static_cast<double>(signedAngleOf(-1, 0)), -std::numbers::pi / 2,
              static_cast<double>(2 * kUnit));
  const Real none = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_TRUE(std::isnan(signedAngleOf(none, 1)) && std::isnan(signedAngleOf(1, none)) &&
              std::isnan(signedAngleOf(none, none)));
}

TEST(RUBBLE_TRIG_SUITE, DecayAgreesWithTheExponential) {
  test::Random random(10);
  const long double units = sizeof(Real) == sizeof(float) ? 1 : 500;
  for (int i = 0; i < 20000; ++i) {
    const Real x = static_cast<Real>(random.logUniform(1e-30, 80));
    const Decay got = decayOver(x);
    const long double wide = x, left = std::exp(-wide), mean = -std::expm1(-wide) / wide;
    EXPECT_NEAR(static_cast<double>((got.left - left) / left), 0, static_cast<double>(units * kUnit)) << x;
    EXPECT_NEAR(static_cast<double>((got.mean - mean) / mean), 0, static_cast<double>(units * kUnit)) << x;
  }
  EXPECT_EQ(decayOver(Real(0)).left, Real(1));
  EXPECT_EQ(decayOver(Real(0)).mean, Real(1));
  const Decay none = decayOver(std::numeric_limits<Real>::max());
  EXPECT_EQ(none.left, Real(0));
  EXPECT_TRUE(none.mean >= Real(0) && none.mean < Real(1e-30));
}
}  // namespace
}  // namespace rubble::RUBBLE_CORE
