#pragma once
/// Four contact points side by side. Formulas over points are written once, for a lane type L: `Real` (one point, a GPU thread) or
/// `Real4` (four points, a CPU vector register).
#include "math/hd.h"

namespace rubble::RUBBLE_CORE {

/// Points of a manifold.
inline constexpr int kLanes = 4;

/// A field of the four points, as it lies in memory.
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

/// Reads and writes the points that an L stands for: with L = Real that of `lane`.
template <class L>
struct LaneAccess {
  RUBBLE_HD static L load(const Lanes& lanes, int lane) { return lanes.v[lane]; }
  RUBBLE_HD static void store(Lanes& lanes, int lane, L a) { lanes.v[lane] = a; }
  RUBBLE_HD static L splat(Real a) { return a; }
};

#if !defined(__CUDACC__)

using Real4 = Real __attribute__((vector_size(kLanes * sizeof(Real))));
using Real4Aliased = Real __attribute__((vector_size(kLanes * sizeof(Real)), may_alias));

template <class Mask>
inline Real4 select(Mask mask, Real4 a, Real4 b) { return mask ? a : b; }
inline Real4 sqrtOf(Real4 a) { return Real4{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])}; }
inline Real4 absOf(Real4 a) { return a < 0 ? -a : a; }
inline Real4 minOf(Real4 a, Real4 b) { return b < a ? b : a; }
inline Real4 maxOf(Real4 a, Real4 b) { return a < b ? b : a; }
/// In a fixed order.
inline Real sumOf(Real4 a) { return (a[0] + a[1]) + (a[2] + a[3]); }

template <>
struct LaneAccess<Real4> {
  static Real4 load(const Lanes& lanes, int) { return *reinterpret_cast<const Real4Aliased*>(lanes.v); }
  static void store(Lanes& lanes, int, Real4 a) { *reinterpret_cast<Real4Aliased*>(lanes.v) = a; }
  static Real4 splat(Real a) { return Real4{a, a, a, a}; }
};

#endif

}  // namespace rubble::RUBBLE_CORE
