#pragma once
/// What compilers spell differently. No other public C++ header depends on the compiler.

/// RUBBLE_HD: host and device function. RUBBLE_NEAR: forced inlining of small hot functions. The step is one
/// large translation unit, in which inlining heuristics give up.
#if defined(__CUDACC__)
#define RUBBLE_HD __host__ __device__
#define RUBBLE_NEAR __forceinline__
#elif defined(_MSC_VER)
#define RUBBLE_HD
#define RUBBLE_NEAR __forceinline
#elif defined(__GNUC__)
#define RUBBLE_HD
#define RUBBLE_NEAR inline __attribute__((always_inline))
#else
#define RUBBLE_HD
#define RUBBLE_NEAR inline
#endif

/// A result that must not outlive the object it is asked of.
#if defined(__clang__)
#define RUBBLE_REFERS_TO_THIS [[clang::lifetimebound]]
#else
#define RUBBLE_REFERS_TO_THIS
#endif
