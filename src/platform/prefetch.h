#pragma once
#include <cstddef>

namespace rubble {

/// Starts to load what a later step reads. It changes no result.
inline void prefetch([[maybe_unused]] const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#endif
}

/// The same for the first and the last byte of [begin, begin + bytes).
inline void fetch(const void* begin, std::size_t bytes) {
  prefetch(begin);
  prefetch(static_cast<const char*>(begin) + bytes - 1);
}

}  // namespace rubble
