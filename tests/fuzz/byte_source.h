#pragma once
/// Numbers, choices and text from the bytes of a fuzzer. Beyond the end everything is zero. Callers draw one
/// value in a full expression, so that all compilers draw them in the same order.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <string>

#include <rubble/math.h>

namespace rubble::fuzz {

/// From 0 to n - 1, by the sum of all bytes. What it chooses changes with every mutation, so that a fuzzer
/// does not prefer a choice that reaches more and takes longer.
inline unsigned lotOf(std::span<const std::uint8_t> bytes, unsigned n) {
  return std::accumulate(bytes.begin(), bytes.end(), 0u) % n;
}

class ByteSource {
 public:
  explicit ByteSource(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool atEnd() const { return bytes_.empty(); }
  std::uint8_t byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }
  /// From 0 to n - 1, for n up to 256.
  int below(int n) { return byte() % n; }
  bool flag() { return (byte() & 1) != 0; }
  /// True in one of 16 cases.
  bool seldom() { return byte() % 16 == 15; }

  /// Evenly from low to high, in 255 steps. Zero bytes give low.
  double between(double low, double high) { return low + (high - low) * byte() / 255; }
  /// From low to high in equal ratios.
  double ratio(double low, double high) { return low * std::pow(high / low, byte() / 255.0); }
  /// The bits of any double, and now and then of a number that is likely to be a limit.
  double bits() {
    static constexpr double kOdd[] = {0,     -0.0,   1,    -1,    1e-30, 1e-9,        1e6,
                                      1e9,   1e18,   1e30, 1e38,  1e300, -1e300,      INFINITY,
                                      -1e30, 1e-300, -1e9, 1e-45, NAN,   2147483648., -INFINITY};
    if (const int choice = byte(); choice < 128)
      return kOdd[static_cast<std::size_t>(choice) % std::size(kOdd)];
    std::uint8_t raw[8];
    for (std::uint8_t& one : raw) one = byte();
    double value;
    std::memcpy(&value, raw, sizeof value);
    return value;
  }

  Vec3 vector(double low, double high) {
    const double x = between(low, high), y = between(low, high);
    return {x, y, between(low, high)};
  }
  Vec3 bitsVector() {
    const double x = bits(), y = bits();
    return {x, y, bits()};
  }
  /// The identity for zero bytes.
  Quat rotation() {
    const double angle = between(0, 3.2);
    const Vec3 axis = vector(-1, 1);
    const double length = std::sqrt(dot(axis, axis));
    return length > 0 ? fromAxisAngle(axis * (1 / length), angle) : Quat{};
  }
  Quat bitsRotation() {
    const double s = bits();
    return {s, bitsVector()};
  }

  /// The next `count` bytes, or what is left.
  std::string text(std::size_t count) {
    count = std::min(count, bytes_.size());
    std::string out(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
    bytes_ = bytes_.subspan(count);
    return out;
  }
  std::string rest() { return text(bytes_.size()); }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace rubble::fuzz
