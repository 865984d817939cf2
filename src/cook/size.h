#pragma once
/// Products and sums of counts that come from outside.
#include <cstddef>
#include <limits>

namespace rubble {

/// A number of bytes or elements that stays at the largest one instead of wrapping round. That is above every
/// limit and equal to no size of anything that is there, so one comparison at the end is all that an
/// expression of sizes needs.
class Size {
 public:
  static constexpr std::size_t kLargest = std::numeric_limits<std::size_t>::max();

  constexpr Size(std::size_t value) : value_(value) {}
  /// Of a count that may be negative: nothing has that size.
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
