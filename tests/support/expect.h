#pragma once
/// Comparisons of vectors and rotations, and errors.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <rubble/error.h>
#include <rubble/math.h>

namespace rubble::test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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

/// The call must throw an Error with this path, and with a text that begins with it.
template <class F> void expectError(const std::string& path, F&& call) {
  try {
    call();
    ADD_FAILURE() << "no error for " << path;
  } catch (const Error& error) {
    EXPECT_EQ(error.path(), path) << error.what();
    EXPECT_EQ(std::string(error.what()).rfind(path + ": expected ", 0), 0u) << error.what();
  }
}

}  // namespace rubble::test
