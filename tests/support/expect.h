#pragma once
/// Comparisons of vectors and rotations.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <rubble/math.h>

namespace rubble::test {

/// |a - b| <= tolerance
template <class R>::testing::AssertionResult near(const Vec3T<R>& a, const Vec3T<R>& b, double tolerance) {
  const double distance = static_cast<double>(length(a - b));
  if (distance <= tolerance) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << "(" << a.x << ", " << a.y << ", " << a.z << ") and (" << b.x << ", " << b.y << ", " << b.z
         << ") are " << distance << " apart, more than " << tolerance;
}

/// Angle between two rotations [rad]; the sign of a quaternion does not matter.
template <class R> double angleBetween(const QuatT<R>& a, const QuatT<R>& b) {
  const QuatT<double> d = QuatT<double>(a) * conjugate(QuatT<double>(b));
  return 2 * std::atan2(length(d.v), std::fabs(d.s));
}

template <class R>
::testing::AssertionResult sameRotation(const QuatT<R>& a, const QuatT<R>& b, double tolerance) {
  const double angle = angleBetween(a, b);
  if (angle <= tolerance) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "rotations " << angle << " rad apart, more than " << tolerance;
}

}  // namespace rubble::test
