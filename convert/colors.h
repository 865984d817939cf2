#pragma once
#include <algorithm>
#include <cmath>

#include <rubble/math.h>

namespace rubble::convert {

/// A linear color, red, green and blue, as sRGB within 0 to 1.
inline Vec3 srgbOf(const Vec3& linear) {
  const auto channel = [](double c) {
    c = std::clamp(c, 0., 1.);
    return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
  };
  return {channel(linear.x), channel(linear.y), channel(linear.z)};
}

}  // namespace rubble::convert
