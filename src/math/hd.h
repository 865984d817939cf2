#pragma once
/// Host and device differences. Outside the CUDA backend no other header depends on the compiler's target.
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstring>

#include <rubble/math.h>

// The core is compiled once per precision, which defines RUBBLE_CORE (f32 or f64) and RUBBLE_REAL (float or
// double). Other host code sees its types in double, in a namespace of its own.
#if !defined(RUBBLE_CORE)
#define RUBBLE_CORE host
#define RUBBLE_REAL double
#endif

/// Keeps a large function out of line. Its registers then do not count in the calling kernels, and a kernel
/// that calls it from several places loads its instructions once.
#if defined(__CUDACC__)
#define RUBBLE_OUT_OF_LINE __noinline__
#elif defined(_MSC_VER)
#define RUBBLE_OUT_OF_LINE __declspec(noinline)
#elif defined(__GNUC__)
#define RUBBLE_OUT_OF_LINE __attribute__((noinline))
#else
#define RUBBLE_OUT_OF_LINE
#endif

/// 1 in device code.
#if defined(__CUDA_ARCH__)
#define RUBBLE_DEVICE_CODE 1
#else
#define RUBBLE_DEVICE_CODE 0
#endif

/// Unrolls a short loop over an array that must stay in registers.
#if defined(__CUDACC__)
#define RUBBLE_UNROLL _Pragma("unroll")
#elif defined(__clang__)
#define RUBBLE_UNROLL _Pragma("unroll")
#elif defined(__GNUC__)
#define RUBBLE_UNROLL _Pragma("GCC unroll 8")
#else
#define RUBBLE_UNROLL
#endif

/// Keeps the code of a loop once on a device, where long code costs more time than what it computes.
#if defined(__CUDACC__)
#define RUBBLE_ROLLED _Pragma("unroll 1")
#else
#define RUBBLE_ROLLED
#endif

namespace rubble::RUBBLE_CORE {

/// Scalar type of the solver.
using Real = RUBBLE_REAL;
using Vec3 = Vec3T<Real>;
using Quat = QuatT<Real>;
using Mat3 = Mat3T<Real>;
/// World positions are double; the solver works with displacements from them.
using Vec3d = Vec3T<double>;

/// A vector in a randomly accessed table, padded so that a device loads it at once.
struct alignas(4 * sizeof(Real)) PaddedVec3 : Vec3 {
  Real padding{};
  PaddedVec3() = default;
  RUBBLE_HD PaddedVec3(const Vec3& a) : Vec3(a) {}
};
RUBBLE_HD inline Vec3 load(const PaddedVec3& a) {
#if defined(__CUDA_ARCH__)
  static_assert(sizeof(PaddedVec3) == sizeof(float4));
  const float4 quad = reinterpret_cast<const float4&>(a);
  return {quad.x, quad.y, quad.z};
#else
  return a;
#endif
}

/// Access to an object in a table by one thread. On a device a plain reference loads members one by one and
/// stalls after each branch. loadVectorized copies the whole object with independent 16-byte loads instead.
#if defined(__CUDA_ARCH__)
template <class T> using Quads = int4[sizeof(T) / sizeof(int4)];
template <class T> RUBBLE_HD RUBBLE_NEAR T loadVectorized(const T& from) {
  static_assert(alignof(T) % sizeof(int4) == 0);
  Quads<T> quads;
  RUBBLE_UNROLL
  for (std::size_t k = 0; k < sizeof(T) / sizeof(int4); ++k)
    quads[k] = reinterpret_cast<const int4*>(&from)[k];
  T to;
  memcpy(static_cast<void*>(&to), quads, sizeof to);
  return to;
}
/// fill(object) fills it and returns how many of its first bytes to write.
template <class T, class Fill> RUBBLE_HD RUBBLE_NEAR void storeFirstBytes(T& to, Fill&& fill) {
  static_assert(sizeof(T) % sizeof(int4) == 0);
  T own;
  const std::size_t bytes = fill(own);
  Quads<T> quads;
  memcpy(quads, static_cast<const void*>(&own), sizeof own);
  RUBBLE_UNROLL
  for (std::size_t k = 0; k < sizeof(T) / sizeof(int4); ++k)
    if (k * sizeof(int4) < bytes) reinterpret_cast<int4*>(&to)[k] = quads[k];
}
/// fill(object) fills it and returns whether to write it.
template <class T, class Fill> RUBBLE_HD RUBBLE_NEAR void storeVectorized(T& to, Fill&& fill) {
  storeFirstBytes(to, [&](T& own) { return fill(own) ? sizeof own : 0; });
}
/// change(object) changes it and returns whether to write it.
template <class T, class Change> RUBBLE_HD RUBBLE_NEAR void updateVectorized(T& object, Change&& change) {
  storeVectorized(object, [&](T& own) {
    own = loadVectorized(object);
    return change(own);
  });
}
/// The same for an object that no thread writes while the kernel runs, also with members that are not used: a
/// compiler splits a load of which it needs a part. Objects of 16 n bytes in a table are aligned to 16.
template <class T> RUBBLE_HD RUBBLE_NEAR T loadUnchanging(const T& from) {
  static_assert(sizeof(T) % sizeof(int4) == 0);
  Quads<T> quads;
  RUBBLE_UNROLL
  for (std::size_t k = 0; k < sizeof(T) / sizeof(int4); ++k)
    quads[k] = __ldca(reinterpret_cast<const int4*>(&from) + k);
  T to;
  memcpy(static_cast<void*>(&to), quads, sizeof to);
  return to;
}
/// The same for a number that may not be needed: a compiler would first wait to know.
RUBBLE_HD inline float loadUnchanging(const float& from) { return __ldca(&from); }
#else
template <class T> RUBBLE_HD RUBBLE_NEAR const T& loadVectorized(const T& from) { return from; }
template <class T> RUBBLE_HD RUBBLE_NEAR const T& loadUnchanging(const T& from) { return from; }
template <class T, class Fill> RUBBLE_HD RUBBLE_NEAR void storeFirstBytes(T& to, Fill&& fill) { fill(to); }
template <class T, class Fill> RUBBLE_HD RUBBLE_NEAR void storeVectorized(T& to, Fill&& fill) { fill(to); }
template <class T, class Change> RUBBLE_HD RUBBLE_NEAR void updateVectorized(T& object, Change&& change) {
  change(object);
}
#endif
/// Stores an object of a table as a whole.
template <class T> RUBBLE_HD RUBBLE_NEAR void storeWhole(T& to, const T& from) {
  storeVectorized(to, [&](T& own) {
    own = from;
    return true;
  });
}

/// Index of the lowest set bit of a non-zero number.
RUBBLE_HD inline int lowestBit(unsigned a) {
#if RUBBLE_DEVICE_CODE
  return __ffs(static_cast<int>(a)) - 1;
#else
  return std::countr_zero(a);
#endif
}

/// *p, which other threads may change meanwhile: the old value or a new one.
RUBBLE_HD inline int atomicLoad(const int* p) {
#if defined(__CUDA_ARCH__)
  return *p;
#else
  return std::atomic_ref<int>(*const_cast<int*>(p)).load(std::memory_order_relaxed);
#endif
}

/// *p += a; returns the old value. For counters only: the order of the additions is not fixed.
RUBBLE_HD inline int atomicCount(int* p, int a) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(p, a);
#else
  return std::atomic_ref<int>(*p).fetch_add(a, std::memory_order_relaxed);
#endif
}

/// *p += a for integers; the sum does not depend on the order.
RUBBLE_HD inline void atomicSum(std::int64_t* p, std::int64_t a) {
#if defined(__CUDA_ARCH__)
  atomicAdd(reinterpret_cast<unsigned long long*>(p), static_cast<unsigned long long>(a));
#else
  std::atomic_ref<std::int64_t>(*p).fetch_add(a, std::memory_order_relaxed);
#endif
}

/// *p = max(*p, a)
RUBBLE_HD inline void atomicRaise(int* p, int a) {
#if defined(__CUDA_ARCH__)
  atomicMax(p, a);
#else
  std::atomic_ref<int> ref(*p);
  int old = ref.load(std::memory_order_relaxed);
  while (old < a && !ref.compare_exchange_weak(old, a, std::memory_order_relaxed)) {
  }
#endif
}

/// *p = a; returns the old value. For lists whose order is not fixed.
RUBBLE_HD inline int atomicExchange(int* p, int a) {
#if defined(__CUDA_ARCH__)
  return atomicExch(p, a);
#else
  return std::atomic_ref<int>(*p).exchange(a, std::memory_order_relaxed);
#endif
}

/// *p |= bits
RUBBLE_HD inline void atomicSet(int* p, int bits) {
#if defined(__CUDA_ARCH__)
  atomicOr(p, bits);
#else
  std::atomic_ref<int>(*p).fetch_or(bits, std::memory_order_relaxed);
#endif
}

/// Compare and swap: *p = a if *p == empty; returns the old value.
RUBBLE_HD inline int atomicClaim(int* p, int empty, int a) {
#if defined(__CUDA_ARCH__)
  return atomicCAS(p, empty, a);
#else
  std::atomic_ref<int>(*p).compare_exchange_strong(empty, a, std::memory_order_relaxed);
  return empty;
#endif
}

template <class T> RUBBLE_HD constexpr T min(T a, T b) { return b < a ? b : a; }
template <class T> RUBBLE_HD constexpr T max(T a, T b) { return a < b ? b : a; }
template <class T> RUBBLE_HD constexpr T clamp(T a, T lo, T hi) { return a < lo ? lo : hi < a ? hi : a; }

RUBBLE_HD inline bool isFinite(Real a) { return a - a == Real(0); }
RUBBLE_HD inline bool isFinite(const Vec3& a) { return isFinite(a.x + a.y + a.z); }

/// A well-mixed 32-bit hash (finalizer of MurmurHash3).
RUBBLE_HD constexpr std::uint32_t hash32(std::uint32_t h) {
  h ^= h >> 16;
  h *= 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  return h ^ (h >> 16);
}

}  // namespace rubble::RUBBLE_CORE
