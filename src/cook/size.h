#pragma once
/// Overflow-safe products and sums of untrusted counts.
#include <cstddef>
#include <limits>

namespace rubble {

/// A number of bytes or elements that saturates instead of overflowing. The saturated value exceeds every
/// limit and differs from every actual size, so one comparison at the end of an expression suffices.
class Size {
 public:
  static constexpr std::size_t kLargest = std::numeric_limits<std::size_t>::max();

  constexpr Size(std::size_t value) : value_(value) {}
  /// Negative counts become the saturated value.
  static constexpr Size of(long long count) { return count < 0 ? kLargest : static_cast<std::size_t>(count); }

  constexpr std::size_t value() const { return value_; }
  friend constexpr Size operator+(Size a, Size b) {
    return a.value_ > kLargest - b.value_ ? kLargest : a.value_ + b.value_;
  }
  friend constexpr Size operator*(Size a, Size b) {
    return b.value_ != 0 && a.value_ > kLargest / b.value_ ? kLargest : a.value_ * b.value_;
  }
  friend constexpr bool operator==(Size a, Size b) { return a.value_ == b.value_ && a.value_ != kLargest; }
  friend constexpr bool operator>(Size a, Size b) { return a.value_ > b.value_; }

 private:
  std::size_t value_;
};

}  // namespace rubble
