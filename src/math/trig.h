#pragma once
/// Trigonometric functions and exponential decay in plain arithmetic: bitwise equal on host and device and
/// with every C library.
#include "math/hd.h"

namespace rubble::RUBBLE_CORE {

template <class R> struct SinCosOf { R sin, cos; };
using SinCos = SinCosOf<Real>;

/// Sine and cosine of x [rad]: within 2 ulp of 1 for |x| up to 1e6, within 1e-6 up to 1e9, and those of 1e9
/// beyond. NaN and infinity give NaN.
template <class R> RUBBLE_HD SinCosOf<R> sinCos(R x) {
  // x = n pi/2 + r with |r| <= pi/4. pi/2 is split in two: n times the first part is exact for n below 2^20.
  constexpr double kHalfPiHigh = 1.57079632673412561417e+00, kHalfPiLow = 6.07710050650619224932e-11;
  constexpr double kTurns = .636619772367581343076, kLargest = 1e9;
  const double wide = static_cast<double>(clamp(x, R(-kLargest), R(kLargest)));
  const double n = floor(wide * kTurns + .5);
  const R r = static_cast<R>((wide - n * kHalfPiHigh) - n * kHalfPiLow) + (x - x);
  // nested Taylor series; the first omitted term is below 1e-9 (float) and 1e-18 (double)
  constexpr int kTerms = sizeof(R) == sizeof(float) ? 6 : 10;
  const R r2 = r * r;
  R sine = 1, cosine = 1;
  for (int k = kTerms - 1; k > 0; --k) {
    sine = R(1) - r2 * (sine * (R(1) / static_cast<R>(2 * k * (2 * k + 1))));
    cosine = R(1) - r2 * (cosine * (R(1) / static_cast<R>(2 * k * (2 * k - 1))));
  }
  sine *= r;
  const double quarter = n - 4 * floor(n * .25);
  if (quarter == 1) return {cosine, -sine};
  if (quarter == 2) return {-sine, -cosine};
  if (quarter == 3) return {-cosine, sine};
  return {sine, cosine};
}

/// Angle in [0, pi/2] of the vector (c, s) with c, s >= 0, not both zero [rad]: atan2(s, c) within 4 ulp.
RUBBLE_HD inline Real angleOf(Real s, Real c) {
  // tangents of its half and its quarter, at most 0.4143
  const Real half = s / (std::sqrt(s * s + c * c) + c);
  const Real t = half / (std::sqrt(Real(1) + half * half) + Real(1));
  // atan t = t - t^3/3 + t^5/5 - ..., up to the term below 1e-9 (float) and 1e-18 (double)
  constexpr int kTerms = sizeof(Real) == sizeof(float) ? 11 : 23;
  const Real t2 = t * t;
  Real sum = 0;
  for (int k = kTerms - 1; k >= 0; --k) sum = Real(1) / static_cast<Real>(2 * k + 1) - t2 * sum;
  return Real(4) * (t * sum);
}

/// Angle in [-pi, pi] of any vector (c, s) [rad]: atan2(s, c) within 6 ulp; 0 for the null vector.
RUBBLE_HD inline Real signedAngleOf(Real s, Real c) {
  constexpr Real kPi = Real(3.14159265358979323846);
  const Real up = std::fabs(s), along = std::fabs(c), longest = up < along ? along : up;
  if (longest == Real(0)) return 0;
  const Real acute = angleOf(up / longest, along / longest), angle = c < Real(0) ? kPi - acute : acute;
  return s < Real(0) ? -angle : angle;
}

/// Decay over x time constants.
struct Decay {
  Real left;  ///< exp(-x)
  Real mean;  ///< (1 - exp(-x)) / x, 1 at x = 0
};
/// For x >= 0, within 1 ulp (float) and 500 ulp (double) of both.
RUBBLE_HD inline Decay decayOver(Real x) {
  constexpr double kLargest = 1e3;  // exp(-x) is zero long before
  double part = min(static_cast<double>(x), kLargest);
  int doublings = 0;
  for (; part > .5; part *= .5) ++doublings;
  // nested Taylor series of exp(-part) - 1; the first omitted term is below 1e-18
  double change = 0;
  for (int k = 16; k > 0; --k) change = (1 + change) * (-part / k);
  double left = 1 + change;
  for (; doublings > 0; --doublings) change *= change + 2, left *= left;
  return {static_cast<Real>(left),
          x > Real(0) ? static_cast<Real>(-change / static_cast<double>(x)) : Real(1)};
}

}  // namespace rubble::RUBBLE_CORE
