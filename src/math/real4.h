#pragma once
/// Real4: four numbers that a processor handles at once; Real8: two Real4 where there are vectors of eight.
/// GCC and Clang have vectors; elsewhere, and with RUBBLE_PORTABLE_LANES, it is an array with the same
/// operations, of the same bits.
#include <bit>
#include <cstddef>

#include "math/hd.h"

#if !defined(__CUDACC__)

namespace rubble {

/// The results of four comparisons.
struct Mask4 {
  bool v[4];
  friend Mask4 operator~(const Mask4& a) { return {{!a.v[0], !a.v[1], !a.v[2], !a.v[3]}}; }
  friend Mask4 operator&(const Mask4& a, const Mask4& b) {
    return {{a.v[0] && b.v[0], a.v[1] && b.v[1], a.v[2] && b.v[2], a.v[3] && b.v[3]}};
  }
  friend Mask4 operator|(const Mask4& a, const Mask4& b) { return ~(~a & ~b); }
};
inline bool allOf(const Mask4& mask) { return mask.v[0] && mask.v[1] && mask.v[2] && mask.v[3]; }

/// Four numbers in plain C++. One number stands for four equal ones.
template <class R> struct alignas(4 * sizeof(R)) Portable4 {
  R v[4];
  Portable4() = default;
  Portable4(R a) : v{a, a, a, a} {}
  Portable4(R a, R b, R c, R d) : v{a, b, c, d} {}
  R& operator[](std::size_t i) { return v[i]; }
  R operator[](std::size_t i) const { return v[i]; }

  friend Portable4 operator+(const Portable4& a, const Portable4& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]};
  }
  friend Portable4 operator-(const Portable4& a, const Portable4& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]};
  }
  friend Portable4 operator*(const Portable4& a, const Portable4& b) {
    return {a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]};
  }
  friend Portable4 operator/(const Portable4& a, const Portable4& b) {
    return {a[0] / b[0], a[1] / b[1], a[2] / b[2], a[3] / b[3]};
  }
  friend Portable4 operator-(const Portable4& a) { return {-a[0], -a[1], -a[2], -a[3]}; }
  Portable4& operator+=(const Portable4& b) { return *this = *this + b; }
  Portable4& operator-=(const Portable4& b) { return *this = *this - b; }
  Portable4& operator*=(const Portable4& b) { return *this = *this * b; }

  friend Mask4 operator<(const Portable4& a, const Portable4& b) {
    return {{a[0] < b[0], a[1] < b[1], a[2] < b[2], a[3] < b[3]}};
  }
  friend Mask4 operator<=(const Portable4& a, const Portable4& b) {
    return {{a[0] <= b[0], a[1] <= b[1], a[2] <= b[2], a[3] <= b[3]}};
  }
  friend Mask4 operator>(const Portable4& a, const Portable4& b) { return b < a; }
  friend Mask4 operator>=(const Portable4& a, const Portable4& b) { return b <= a; }
  friend Mask4 operator==(const Portable4& a, const Portable4& b) {
    return {{a[0] == b[0], a[1] == b[1], a[2] == b[2], a[3] == b[3]}};
  }
  friend Mask4 operator!=(const Portable4& a, const Portable4& b) { return ~(a == b); }
};

/// mask ? a : b for each of the four
template <class R> Portable4<R> select(const Mask4& mask, const Portable4<R>& a, const Portable4<R>& b) {
  return {mask.v[0] ? a[0] : b[0], mask.v[1] ? a[1] : b[1], mask.v[2] ? a[2] : b[2], mask.v[3] ? a[3] : b[3]};
}

// Steps of a transposition.
template <class R> Portable4<R> firstOfBoth(const Portable4<R>& a, const Portable4<R>& b) {
  return {a[0], b[0], a[1], b[1]};
}
template <class R> Portable4<R> lastOfBoth(const Portable4<R>& a, const Portable4<R>& b) {
  return {a[2], b[2], a[3], b[3]};
}
template <class R> Portable4<R> firstHalves(const Portable4<R>& a, const Portable4<R>& b) {
  return {a[0], a[1], b[0], b[1]};
}
template <class R> Portable4<R> lastHalves(const Portable4<R>& a, const Portable4<R>& b) {
  return {a[2], a[3], b[2], b[3]};
}

namespace RUBBLE_CORE {

#if defined(__GNUC__) && !defined(RUBBLE_PORTABLE_LANES)

using Real4 = Real __attribute__((vector_size(4 * sizeof(Real))));
using Real4Aliased = Real __attribute__((vector_size(4 * sizeof(Real)), may_alias));

template <class Mask> inline Real4 select(Mask mask, Real4 a, Real4 b) { return mask ? a : b; }
template <class Mask>
requires(sizeof(Mask) == sizeof(Real4)) inline bool allOf(Mask mask) {
  using Words = long long __attribute__((vector_size(4 * sizeof(Real))));
  const Words w = std::bit_cast<Words>(mask);
  long long common = w[0];
  for (std::size_t k = 1; k < sizeof(Mask) / sizeof(long long); ++k) common &= w[k];
  return common == -1;
}
inline Real4 firstOfBoth(Real4 a, Real4 b) { return __builtin_shufflevector(a, b, 0, 4, 1, 5); }
inline Real4 lastOfBoth(Real4 a, Real4 b) { return __builtin_shufflevector(a, b, 2, 6, 3, 7); }
inline Real4 firstHalves(Real4 a, Real4 b) { return __builtin_shufflevector(a, b, 0, 1, 4, 5); }
inline Real4 lastHalves(Real4 a, Real4 b) { return __builtin_shufflevector(a, b, 2, 3, 6, 7); }

#define RUBBLE_HAS_REAL8
using Real8 = Real __attribute__((vector_size(8 * sizeof(Real))));

/// A Real8 in place of a Real4 of the same name does the same with each half.
template <class Mask> inline Real8 select(Mask mask, Real8 a, Real8 b) { return mask ? a : b; }
inline Real8 firstOfBoth(Real8 a, Real8 b) { return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13); }
inline Real8 lastOfBoth(Real8 a, Real8 b) {
  return __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
}
inline Real8 firstHalves(Real8 a, Real8 b) { return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13); }
inline Real8 lastHalves(Real8 a, Real8 b) {
  return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
}
inline Real8 joined(Real4 low, Real4 high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
inline Real4 lowOf(Real8 a) { return __builtin_shufflevector(a, a, 0, 1, 2, 3); }
inline Real4 highOf(Real8 a) { return __builtin_shufflevector(a, a, 4, 5, 6, 7); }
/// Element k of each half, four times.
template <int k> inline Real8 repeated(Real8 a) {
  return __builtin_shufflevector(a, a, k, k, k, k, 4 + k, 4 + k, 4 + k, 4 + k);
}

#else

using Real4 = Portable4<Real>;
using Real4Aliased = Real4;
using rubble::allOf;

#endif

}  // namespace RUBBLE_CORE

}  // namespace rubble

#endif
