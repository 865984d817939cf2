/// Functions of the C library in our own arithmetic, and the vectors of compilers without any.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "math/lanes.h"
#include "math/portable.h"
#include "tests/support/library.h"
#include "tests/support/random.h"

namespace rubble {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Difference in units of the last place of the expected value.
double ulps(double value, double expected) {
  if (value == expected || (std::isnan(value) && std::isnan(expected))) return 0;
  return std::fabs(value - expected) / (std::nextafter(std::fabs(expected), kInfinity) - std::fabs(expected));
}

struct Function {
  const char* name;
  double (*own)(double);
  double (*wanted)(double);
  double low, high;
};
#define BOTH(f, low, high)                                         \
  Function {                                                       \
#f, portable::f, [](double x) { return std::f(x); }, low, high \
  }

/// Libraries err by less than one ulp in what follows, and ours by half of one.
TEST(Portable, FunctionsAreThoseOfTheLibrary) {
  if (!test::kReducesAngles) GTEST_SKIP() << "the C library is less exact";
  test::Random random(1);
  for (const Function& f :
       {BOTH(sin, -10, 10), BOTH(sin, -1e6, 1e6), BOTH(cos, -10, 10), BOTH(cos, -1e6, 1e6),
        BOTH(tan, -1.5, 1.5), BOTH(atan, -5, 5), BOTH(atan, -1e6, 1e6), BOTH(acos, -1, 1), BOTH(exp, -20, 20),
        BOTH(exp, -700, 700), BOTH(expm1, -1, 1), BOTH(log, 0, 10), BOTH(log, 0, 1e300),
        BOTH(cbrt, -100, 100), BOTH(sinh, -1, 1), BOTH(sinh, -50, 50), BOTH(cosh, -50, 50)})
    for (int k = 0; k < 1000; ++k) {
      const double x = random.uniform(f.low, f.high);
      ASSERT_LE(ulps(f.own(x), f.wanted(x)), 2) << f.name << " of " << x;
    }
  for (int k = 0; k < 1000; ++k) {
    const double x = random.uniform(-3, 3), y = random.uniform(-3, 3);
    const double scale = std::exp(random.uniform(-600, 600));
    ASSERT_LE(ulps(portable::atan2(y, x), std::atan2(y, x)), 2) << y << ", " << x;
    ASSERT_LE(ulps(portable::hypot(x * scale, y * scale), std::hypot(x * scale, y * scale)), 2);
    ASSERT_LE(ulps(portable::hypot(x, y, 1), std::sqrt(x * x + y * y + 1)), 2);
    ASSERT_LE(ulps(portable::pow(std::fabs(x), 5 * y), std::pow(std::fabs(x), 5 * y)), 2) << x << ", " << y;
    ASSERT_LE(ulps(portable::pow(x, 5), std::pow(x, 5)), 2) << x;
  }
}

/// Numerators of the best fractions for pi: nearly all digits cancel. The last value is from 60 digits of pi,
/// since libraries err there.
TEST(Portable, AnglesNextToMultiplesOfPiLoseNoDigits) {
  if (!test::kReducesAngles) GTEST_SKIP() << "the C library is less exact";
  for (const double x : {355., 5419351., 21053343141., 8958937768937.}) {
    EXPECT_LE(ulps(portable::sin(x), std::sin(x)), 2) << x;
    EXPECT_LE(ulps(portable::cos(x / 2), std::cos(x / 2)), 2) << x;
  }
  EXPECT_LE(ulps(portable::sin(428224593349304.), 5.1871370415710018e-16), 2);
}

TEST(Portable, ExactResultsAreExact) {
  for (int k = 1; k < 60; ++k) {
    EXPECT_EQ(portable::pow(2, k), std::ldexp(1, k));
    EXPECT_EQ(portable::pow(-3, k % 30), std::pow(-3, k % 30));
    EXPECT_EQ(portable::cbrt(1. * k * k * k), k);
    EXPECT_EQ(portable::hypot(3 * k, 4 * k), 5 * k);
  }
  EXPECT_EQ(portable::acos(-1), std::numbers::pi);
}

TEST(Portable, SpecialValuesAreThoseOfTheLibrary) {
  const double values[] = {0,         -0.,        1,     -1,     0.5,    2,      -3,
                           kInfinity, -kInfinity, 1e308, -1e308, 5e-324, 1e-310, std::nan("")};
  const auto isSame = [](double a, double b) {
    return (std::isnan(a) && std::isnan(b)) || (ulps(a, b) <= 2 && std::signbit(a) == std::signbit(b));
  };
  for (const double x : values) {
    for (const Function& f : {BOTH(atan, 0, 0), BOTH(acos, 0, 0), BOTH(exp, 0, 0), BOTH(expm1, 0, 0),
                              BOTH(log, 0, 0), BOTH(cbrt, 0, 0), BOTH(sinh, 0, 0), BOTH(cosh, 0, 0)})
      EXPECT_TRUE(isSame(f.own(x), f.wanted(x))) << f.name << " of " << x << ": " << f.own(x);
    // larger angles are not accepted
    if (!(std::fabs(x) > 1e15) || std::isinf(x)) {
      for (const Function& f : {BOTH(sin, 0, 0), BOTH(cos, 0, 0), BOTH(tan, 0, 0)})
        EXPECT_TRUE(isSame(f.own(x), f.wanted(x))) << f.name << " of " << x;
    }
    for (const double y : values) {
      EXPECT_TRUE(isSame(portable::atan2(x, y), std::atan2(x, y))) << x << ", " << y;
      EXPECT_TRUE(isSame(portable::pow(x, y), std::pow(x, y)))
          << x << ", " << y << ": " << portable::pow(x, y);
      if (!std::isnan(x) && !std::isnan(y)) {
        EXPECT_TRUE(isSame(portable::hypot(x, y), std::hypot(x, y))) << x << ", " << y;
      }
    }
  }
}

/// All that lanes.h does with four numbers, in plain C++ and with the vectors of the compiler.
TEST(Portable, FourNumbersAreThoseOfAVector) {
  using RUBBLE_CORE::Real;
  using RUBBLE_CORE::Real4;
  using Plain4 = Portable4<Real>;
  test::Random random(1);
  for (int k = 0; k < 1000; ++k) {
    Plain4 a, b;
    Real4 va, vb;
    for (std::size_t i = 0; i < 4; ++i) {
      // few values, so that some are equal
      const auto draw = [&] { return static_cast<Real>(random.below(7) - 3) / Real(3); };
      va[i] = a[i] = draw(), vb[i] = b[i] = draw();
    }
    const auto expectSame = [&](const Plain4& plain, const Real4& vector) {
      for (std::size_t i = 0; i < 4; ++i) {
        const bool isNan = std::isnan(plain[i]) && std::isnan(vector[i]);
        EXPECT_TRUE(isNan || (plain[i] == vector[i] && std::signbit(plain[i]) == std::signbit(vector[i])));
      }
    };
    expectSame(a + b, va + vb), expectSame(a - b, va - vb), expectSame(a * b, va * vb);
    expectSame(a / b, va / vb), expectSame(-a, -va),
        expectSame(Real(2) * a + Real(1), Real(2) * va + Real(1));
    Plain4 sum = a;
    Real4 vsum = va;
    sum += b, vsum += vb, expectSame(sum, vsum);
    sum *= a, vsum *= va, expectSame(sum, vsum);
    sum -= b, vsum -= vb, expectSame(sum, vsum);
    const auto expectSameMask = [&](const Mask4& plain, const auto& vector) {
      expectSame(select(plain, a, b), RUBBLE_CORE::select(vector, va, vb));
      EXPECT_EQ(allOf(plain), RUBBLE_CORE::allOf(vector));
    };
    expectSameMask(a < b, va < vb), expectSameMask(a <= b, va <= vb), expectSameMask(a > b, va > vb);
    expectSameMask(a >= b, va >= vb), expectSameMask(a == b, va == vb), expectSameMask(a != b, va != vb);
    expectSameMask((a < b) | (b == a), (va < vb) | (vb == va));
    expectSameMask(~(a < b) & (b != a), ~(va < vb) & (vb != va));
    expectSame(firstOfBoth(a, b), RUBBLE_CORE::firstOfBoth(va, vb));
    expectSame(lastOfBoth(a, b), RUBBLE_CORE::lastOfBoth(va, vb));
    expectSame(firstHalves(a, b), RUBBLE_CORE::firstHalves(va, vb));
    expectSame(lastHalves(a, b), RUBBLE_CORE::lastHalves(va, vb));
  }
}

}  // namespace
}  // namespace rubble
