#pragma once
/// Arrays of a SolverData: plain pointers, which kernels take by value. Checked builds (RUBBLE_CHECKED) test
/// every index, every RUBBLE_ASSERT, and the invariants of tables/table_check.h after each step.
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#if defined(RUBBLE_CHECKED)
#define RUBBLE_ASSERT(condition) \
  ((condition) ? void() : ::rubble::assertionFailed(#condition, __FILE__, __LINE__))
/// Asserts that `fault`, an expression of a string, is empty.
#define RUBBLE_ASSERT_NONE(fault) ::rubble::assertNone(fault, __FILE__, __LINE__)
#else
#define RUBBLE_ASSERT(condition) static_cast<void>(0)
#define RUBBLE_ASSERT_NONE(fault) static_cast<void>(0)
#endif

namespace rubble {

#if defined(RUBBLE_CHECKED)
[[noreturn]] inline void assertionFailed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
  std::abort();
}

inline void assertNone(const std::string& fault, const char* file, int line) {
  if (!fault.empty()) assertionFailed(fault.c_str(), file, line);
}
[[noreturn]] inline void indexFailed(std::ptrdiff_t index, std::ptrdiff_t length) {
  std::fprintf(stderr, "index %td of an array of %td elements\n", index, length);
  std::abort();
}

/// A pointer and the length of its array. The length of a pointer that is set alone is unknown.
template <class T> class CheckedArray {
 public:
  CheckedArray(T* data = nullptr, std::ptrdiff_t length = kUnknown) : data_{data}, length_{length} {}
  operator T*() const { return data_; }
  T* operator->() const { return data_; }
  template <class I>
  requires std::is_integral_v<I> T& operator[](I i) const {
    const auto index = static_cast<std::ptrdiff_t>(i);
    if (index < 0 || index >= length_) indexFailed(index, length_);
    return data_[i];
  }

 private:
  static constexpr std::ptrdiff_t kUnknown = std::numeric_limits<std::ptrdiff_t>::max();
  T* data_;
  std::ptrdiff_t length_;
};
template <class T> using Array = CheckedArray<T>;
template <class T> Array<T> arrayOf(T* data, std::size_t length) {
  return {data, static_cast<std::ptrdiff_t>(length)};
}
#else
template <class T> using Array = T*;
template <class T> T* arrayOf(T* data, std::size_t) { return data; }
#endif

/// The first elements of an array.
template <class T> std::span<T> firstOf(const Array<T>& array, int count) {
  return {static_cast<T*>(array), static_cast<std::size_t>(count)};
}

template <class T> std::vector<T> copyOf(const Array<T>& array, int count) {
  const std::span<T> elements = firstOf(array, count);
  return {elements.begin(), elements.end()};
}

}  // namespace rubble
