#include "math/portable.h"

#include <rubble/math.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rubble::portable {
namespace {

/// A sum of two numbers, the second below half an ulp of the first: 106 bits (Dekker 1971).
struct Wide {
  double high = 0, low = 0;
  constexpr Wide() = default;
  constexpr Wide(double a) : high(a) {}
  constexpr Wide(double a, double b) : high(a), low(b) {}
};

/// a + b where |a| >= |b|
constexpr Wide orderedSum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}
constexpr Wide sum(double a, double b) {
  const double total = a + b, other = total - a;
  return {total, (a - (total - other)) + (b - other)};
}
constexpr Wide product(double a, double b) {
  const auto upper = [](double x) {
    const double scaled = 134217729 * x;
    return scaled - (scaled - x);
  };
  const double whole = a * b, a1 = upper(a), b1 = upper(b), a2 = a - a1, b2 = b - b1;
  return {whole, ((a1 * b1 - whole) + a1 * b2 + a2 * b1) + a2 * b2};
}
constexpr Wide operator+(const Wide& a, const Wide& b) {
  const Wide s = sum(a.high, b.high), t = sum(a.low, b.low);
  const Wide u = orderedSum(s.high, s.low + t.high);
  return orderedSum(u.high, u.low + t.low);
}
constexpr Wide operator-(const Wide& a) { return {-a.high, -a.low}; }
constexpr Wide operator-(const Wide& a, const Wide& b) { return a + -b; }
constexpr Wide operator*(const Wide& a, const Wide& b) {
  const Wide p = product(a.high, b.high);
  return orderedSum(p.high, p.low + (a.high * b.low + a.low * b.high));
}
constexpr Wide operator/(const Wide& a, const Wide& b) {
  const double q1 = a.high / b.high;
  Wide rest = a - b * q1;
  const double q2 = rest.high / b.high;
  rest = rest - b * q2;
  return orderedSum(q1, q2) + rest.high / b.high;
}
Wide root(const Wide& a) {
  if (!(a.high > 0)) return a.high;
  const double first = std::sqrt(a.high);
  return orderedSum(first, (a - product(first, first)).high / (2 * first));
}
Wide scaled(const Wide& a, int exponent) {
  return {std::ldexp(a.high, exponent), std::ldexp(a.low, exponent)};
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr Wide kHalfPi{1.5707963267948966, 6.123233995736766e-17},
    kLog2{0.6931471805599453, 2.3190468138462996e-17};
/// pi/2 beyond kHalfPi
constexpr double kHalfPiRest = -1.4973849048591698e-33;

/// factor(0), factor(1), ...: at compile time, since a quotient takes longer than the rest of a term.
template <int kTerms, class Factor>
constexpr std::array<Wide, kTerms> kFactors = [] {
  std::array<Wide, kTerms> out;
  for (int k = 0; k < kTerms; ++k) out[static_cast<std::size_t>(k)] = Factor{}(k);
  return out;
}();
/// 1 + a z (1 + b z (1 + ...)), where factor(0), factor(1), ... are a, b, ...
template <int kTerms, class Factor> Wide nested(const Wide& z, Factor) {
  Wide value = 1;
  for (std::size_t k = kTerms; k-- > 0;) value = Wide(1) + z * value * kFactors<kTerms, Factor>[k];
  return value;
}
/// 1 + z/3 + z^2/5 + ...
template <int kTerms> Wide oddReciprocals(const Wide& z) {
  constexpr auto factor = [](int k) { return Wide(1) / (2.0 * k + 1); };
  Wide value = 0;
  for (std::size_t k = kTerms; k-- > 0;) value = kFactors<kTerms, decltype(factor)>[k] + z * value;
  return value;
}

/// x - n pi/2, at most pi/4; n modulo 4
Wide quarterTurns(double x, int& quarter) {
  const double n = std::floor(x / kHalfPi.high + 0.5);
  quarter = static_cast<int>(n - 4 * std::floor(n / 4));
  return ((Wide(x) - product(n, kHalfPi.high)) - product(n, kHalfPi.low)) - n * kHalfPiRest;
}
constexpr int kTrigTerms = 14;
/// sin(r) / r, where z = -r^2
Wide sineOverAngle(const Wide& z) {
  return nested<kTrigTerms>(z, [](int k) { return Wide(1) / ((2.0 * k + 2) * (2 * k + 3)); });
}
/// sin(x + n pi/2) for n = 0 and 1
Wide sine(double x, int n) {
  // larger ones lose all digits
  if (!(std::fabs(x) <= 1e15)) return kNotANumber;
  int quarter = 0;
  const Wide r = quarterTurns(x, quarter), z = -(r * r);
  quarter += n;
  const Wide value = quarter % 2 == 0 ? r * sineOverAngle(z) : nested<kTrigTerms>(z, [](int k) {
    return Wide(1) / ((2.0 * k + 2) * (2 * k + 1));
  });
  return quarter % 4 < 2 ? value : -value;
}

/// exp(r) - 1 for |r| below 0.36
Wide smallExponential(const Wide& r) {
  return r * nested<24>(r, [](int k) { return Wide(1) / (k + 2.0); });
}
Wide exponential(const Wide& x) {
  if (x.high > 710) return kInfinity;
  if (x.high < -746) return 0.0;
  const double n = std::floor(x.high / kLog2.high + 0.5);
  return scaled(Wide(1) + smallExponential(x - kLog2 * n), static_cast<int>(n));
}
/// x above zero
Wide logarithm(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.7071) m *= 2, --exponent;
  // log m = 2 atanh((m - 1) / (m + 1))
  const Wide t = (Wide(m) - 1.0) / (Wide(m) + 1.0);
  return kLog2 * static_cast<double>(exponent) + scaled(t * oddReciprocals<23>(t * t), 1);
}

/// Angle of (c, s), both at least zero and one above.
Wide quarterAngle(const Wide& s, const Wide& c) {
  if (c.high < s.high) return kHalfPi - quarterAngle(c, s);
  const auto half = [](const Wide& t) { return t / (Wide(1) + root(Wide(1) + t * t)); };
  const Wide t = half(half(s / c));
  return scaled(t * oddReciprocals<25>(-(t * t)), 2);
}

double withSign(double magnitude, double sign) { return std::copysign(magnitude, sign); }

}  // namespace

double sin(double x) { return x == 0 ? x : sine(x, 0).high; }
double cos(double x) { return sine(x, 1).high; }
double tan(double x) { return x == 0 ? x : (sine(x, 0) / sine(x, 1)).high; }

double atan(double x) { return atan2(x, 1); }
double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNotANumber;
  double s = std::fabs(y), c = std::fabs(x);
  if (std::isinf(s) || std::isinf(c)) s = std::isinf(s), c = std::isinf(c);
  const bool back = std::signbit(x);
  if (s == 0) return withSign(back ? 2 * kHalfPi.high : 0, y);
  if (c == 0) return withSign(kHalfPi.high, y);
  int a = 0, b = 0;
  std::frexp(s, &a), std::frexp(c, &b);
  // tangents that no angle tells from these
  if (a - b > 1000) return withSign(kHalfPi.high, y);
  if (a - b < -1000 && back) return withSign(2 * kHalfPi.high, y);
  if (a - b < -1000) return withSign(s / c, y);
  const Wide angle = quarterAngle(std::ldexp(s, -std::max(a, b)), std::ldexp(c, -std::max(a, b)));
  return withSign((back ? scaled(kHalfPi, 1) - angle : angle).high, y);
}
double acos(double x) {
  if (!(std::fabs(x) <= 1)) return kNotANumber;
  if (x == 1) return 0;
  const Wide angle = quarterAngle(root((Wide(1) - x) * (Wide(1) + x)), std::fabs(x));
  return (x < 0 ? scaled(kHalfPi, 1) - angle : angle).high;
}

double exp(double x) { return std::isnan(x) ? x : exponential(x).high; }
double expm1(double x) {
  if (std::fabs(x) < 0.3) return x == 0 ? x : smallExponential(x).high;
  return std::isfinite(x) && x < 710 ? (exponential(x) - 1.0).high : exp(x) - 1;
}
double log(double x) {
  if (x == 0) return -kInfinity;
  if (!(x > 0)) return kNotANumber;
  return std::isinf(x) ? x : logarithm(x).high;
}
double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (std::isnan(x) || std::isnan(y)) return kNotANumber;
  const bool isWhole = y == std::floor(y), isOdd = isWhole && std::isfinite(y) && std::fmod(y, 2) != 0;
  const double sign = std::signbit(x) && isOdd ? -1 : 1, size = std::fabs(x);
  if (x < 0 && !isWhole && !std::isinf(x)) return kNotANumber;
  if (size == 0 || std::isinf(size)) return sign * ((size == 0) == (y > 0) ? 0 : kInfinity);
  if (size == 1) return sign;
  if (std::isinf(y)) return (size > 1) == (y > 0) ? kInfinity : 0;
  return sign * exponential(std::fabs(y) < 1e15 ? logarithm(size) * y : Wide(logarithm(size).high * y)).high;
}
double cbrt(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  return withSign(exponential(logarithm(std::fabs(x)) / 3.0).high, x);
}

double sinh(double x) {
  const double size = std::fabs(x);
  if (!(size < 700)) return withSign(exp(size - 1) * (exp(1) / 2), x);
  if (x == 0) return x;
  if (size < 0.3) return (sineOverAngle(Wide(x) * x) * x).high;
  const Wide e = exponential(size);
  return withSign(scaled(e - Wide(1) / e, -1).high, x);
}
double cosh(double x) {
  const double size = std::fabs(x);
  if (!(size < 700)) return exp(size - 1) * (exp(1) / 2);
  const Wide e = exponential(size);
  return scaled(e + Wide(1) / e, -1).high;
}
double hypot(double x, double y, double z) {
  const double largest = std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
  if (std::isinf(x) || std::isinf(y) || std::isinf(z)) return kInfinity;
  if (!(largest > 0)) return x + y + z + largest;
  int exponent = 0;
  std::frexp(largest, &exponent);
  const auto square = [&](double a) {
    const double s = std::ldexp(a, -exponent);
    return product(s, s);
  };
  return std::ldexp(root(square(x) + square(y) + square(z)).high, exponent);
}

}  // namespace rubble::portable

namespace rubble {

Quat fromAxisAngle(const Vec3& axis, double angle) {
  return {portable::cos(angle / 2), axis * portable::sin(angle / 2)};
}

}  // namespace rubble
