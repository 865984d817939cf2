#pragma once
#include <cstddef>
#include <cstring>

namespace rubble {

/// Copies elements with zeroed padding, where the compiler supports it. Padding carries no state but is
/// hashed.
template <class T> void copyClean(std::byte* to, const T* from, std::size_t bytes) {
#if defined(__has_builtin)
#if __has_builtin(__builtin_clear_padding)
  for (std::size_t i = 0; i < bytes / sizeof(T); ++i) {
    T element = from[i];
    __builtin_clear_padding(&element);
    std::memcpy(to + i * sizeof(T), &element, sizeof(T));
  }
  return;
#endif
#endif
  if (bytes > 0) std::memcpy(to, from, bytes);
}

}  // namespace rubble
