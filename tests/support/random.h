#pragma once
/// Random numbers that are the same with every standard library and compiler: the distributions of <random>
/// are not, and neither is the order in which arguments of a call are evaluated.
#include <cmath>
#include <cstdint>
#include <numbers>

#include <rubble/math.h>

namespace rubble::test {

/// SplitMix64.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  /// In [0, n).
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }
  /// In [lo, hi).
  double uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(bits() >> 11) * 0x1p-53;
  }
  /// Spread evenly over the orders of magnitude from lo to hi.
  double logUniform(double lo, double hi) { return std::exp(uniform(std::log(lo), std::log(hi))); }
  /// Each component in [-size, size).
  Vec3 vector(double size = 1) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  /// Uniform on the unit sphere.
  Vec3 direction() {
    const double z = uniform(-1, 1), angle = uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }
  /// Any rotation, either sign of the scalar part.
  Quat rotation() { return rotationUpTo(4 * std::numbers::pi); }
  /// A rotation by up to `angle` [rad].
  Quat rotationUpTo(double angle) {
    const double turn = uniform(0, angle);
    return fromAxisAngle(direction(), turn);
  }

 private:
  std::uint64_t state_;
};

}  // namespace rubble::test
