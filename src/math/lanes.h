#pragma once
/// SIMD lanes over contact points, bodies or joints. Formulas are written once for a lane type L: `Real` (one
/// item, a GPU thread) or `Real4` (four items, a CPU vector register). Each lane of Real4 is bitwise equal to
/// Real.
#include <cstring>

#include "math/hd.h"
#include "math/real4.h"

namespace rubble::RUBBLE_CORE {

/// Points of a manifold.
inline constexpr int kLanes = 4;

/// One field of the four points, as stored in memory.
struct alignas(kLanes * sizeof(Real)) Lanes {
  Real v[kLanes];
  RUBBLE_HD Real& operator[](int i) { return v[i]; }
  RUBBLE_HD Real operator[](int i) const { return v[i]; }
};

RUBBLE_HD inline Lanes splatLanes(Real a) { return {{a, a, a, a}}; }

RUBBLE_HD inline Real select(bool mask, Real a, Real b) { return mask ? a : b; }
RUBBLE_HD inline Real sqrtOf(Real a) { return std::sqrt(a); }
RUBBLE_HD inline Real absOf(Real a) { return std::fabs(a); }
RUBBLE_HD inline Real minOf(Real a, Real b) { return b < a ? b : a; }
RUBBLE_HD inline Real maxOf(Real a, Real b) { return a < b ? b : a; }
RUBBLE_HD inline Real sumOf(Real a) { return a; }
RUBBLE_HD inline bool allOf(bool mask) { return mask; }
RUBBLE_HD inline bool anyOf(bool mask) { return mask; }

/// Four fields of the points of an L.
template <class L> struct Quad { L x, y, z, w; };

/// Type of a number that the points of one contact share. Lanes of several contacts hold one of each.
template <class L> struct PerContactOf { using type = Real; };
template <class L> using PerContact = typename PerContactOf<L>::type;

#if defined(RUBBLE_HAS_REAL8)
template <> struct PerContactOf<Real8> { using type = Real8; };
inline Real8 sqrtOf(Real8 a) {
  return Real8{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3]),
               std::sqrt(a[4]), std::sqrt(a[5]), std::sqrt(a[6]), std::sqrt(a[7])};
}
inline Real8 absOf(Real8 a) { return select(a < Real8{}, -a, a); }
inline Real8 minOf(Real8 a, Real8 b) { return select(b < a, b, a); }
inline Real8 maxOf(Real8 a, Real8 b) { return select(a < b, b, a); }
#endif

/// Loads and stores the points of an L; with L = Real that of `lane`. Quads are stored point by point, so
/// that a GPU thread needs one access each; T holds four numbers.
template <class L> struct LaneAccess {
  RUBBLE_HD static L load(const Lanes& lanes, int lane) { return lanes.v[lane]; }
  RUBBLE_HD static void store(Lanes& lanes, int lane, L a) { lanes.v[lane] = a; }
  RUBBLE_HD static L splat(Real a) { return a; }
  /// 1 where a bit is set, else 0; bit k for point k.
  RUBBLE_HD static L flags(unsigned bits, int lane) { return static_cast<Real>(bits >> lane & 1); }
  template <class T> RUBBLE_HD static Quad<L> loadQuad(const T* points, int lane) {
    static_assert(sizeof(T) == sizeof(Quad<Real>) && alignof(T) == sizeof(T));
    const T own = points[lane];
    Quad<L> q;
    memcpy(&q, &own, sizeof q);
    return q;
  }
  template <class T> RUBBLE_HD static void storeQuad(T* points, int lane, const Quad<L>& q) {
    T own;
    memcpy(static_cast<void*>(&own), &q, sizeof own);
    points[lane] = own;
  }
};

#if !defined(__CUDACC__)

inline Real4 sqrtOf(Real4 a) {
  return Real4{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
inline Real4 absOf(Real4 a) { return select(a < Real4{}, -a, a); }
inline Real4 minOf(Real4 a, Real4 b) { return select(b < a, b, a); }
inline Real4 maxOf(Real4 a, Real4 b) { return select(a < b, b, a); }
template <class Mask> inline bool anyOf(Mask mask) { return !allOf(~mask); }
/// Sums in a fixed order.
inline Real sumOf(Real4 a) { return (a[0] + a[1]) + (a[2] + a[3]); }

/// rotate of rubble/math.h, where the factor 2 is a scalar.
RUBBLE_NEAR Vec3T<Real4> rotate(const QuatT<Real4>& q, const Vec3T<Real4>& r) {
  const Vec3T<Real4> half = cross(q.v, r), t = half + half;
  return r + q.s * t + cross(q.v, t);
}

template <> struct LaneAccess<Real4> {
  static Real4 load(const Lanes& lanes, int) { return *reinterpret_cast<const Real4Aliased*>(lanes.v); }
  static void store(Lanes& lanes, int, Real4 a) { *reinterpret_cast<Real4Aliased*>(lanes.v) = a; }
  static Real4 splat(Real a) { return Real4{a, a, a, a}; }
  static Real4 flags(unsigned bits, int) {
    const auto at = [&](int k) { return static_cast<Real>(bits >> k & 1); };
    return Real4{at(0), at(1), at(2), at(3)};
  }
  template <class T> static Quad<Real4> loadQuad(const T* points, int) {
    static_assert(sizeof(T) == sizeof(Real4));
    const auto* const p = reinterpret_cast<const Real4Aliased*>(points);
    return transposed({p[0], p[1], p[2], p[3]});
  }
  template <class T> static void storeQuad(T* points, int, const Quad<Real4>& q) {
    const Quad<Real4> v = transposed(q);
    auto* const p = reinterpret_cast<Real4Aliased*>(points);
    p[0] = v.x, p[1] = v.y, p[2] = v.z, p[3] = v.w;
  }
  /// Loads four numbers from each of four addresses.
  static Quad<Real4> gatherQuad(const Real* a, const Real* b, const Real* c, const Real* d) {
    // copied, because not every compiler accepts an alignment below that of a vector
    const auto at = [](const Real* p) {
      Real4 numbers;
      std::memcpy(&numbers, p, sizeof numbers);
      return numbers;
    };
    return transposed({at(a), at(b), at(c), at(d)});
  }
  static void scatterQuad(Real* a, Real* b, Real* c, Real* d, const Quad<Real4>& q) {
    const Quad<Real4> v = transposed(q);
    const auto put = [](Real* p, const Real4& numbers) { std::memcpy(p, &numbers, sizeof numbers); };
    put(a, v.x), put(b, v.y), put(c, v.z), put(d, v.w);
  }

 private:
  static Quad<Real4> transposed(const Quad<Real4>& q) {
    const Real4 a = firstOfBoth(q.x, q.y), b = firstOfBoth(q.z, q.w);
    const Real4 c = lastOfBoth(q.x, q.y), d = lastOfBoth(q.z, q.w);
    return {firstHalves(a, b), lastHalves(a, b), firstHalves(c, d), lastHalves(c, d)};
  }
};

#endif

template <class L> RUBBLE_HD RUBBLE_NEAR Vec3T<L> splatVector(const Vec3& a) {
  return {LaneAccess<L>::splat(a.x), LaneAccess<L>::splat(a.y), LaneAccess<L>::splat(a.z)};
}
template <class L> RUBBLE_HD RUBBLE_NEAR QuatT<L> splatQuat(const Quat& q) {
  return {LaneAccess<L>::splat(q.s), splatVector<L>(q.v)};
}
template <class Mask, class L>
RUBBLE_HD RUBBLE_NEAR Vec3T<L> select(Mask mask, const Vec3T<L>& a, const Vec3T<L>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
template <class L> RUBBLE_HD bool areFinite(const Vec3T<L>& a) {
  const L sum = a.x + a.y + a.z;
  return allOf(sum - sum == LaneAccess<L>::splat(0));
}

}  // namespace rubble::RUBBLE_CORE
