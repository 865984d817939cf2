#pragma once
#include <cstddef>
#include <cstring>

namespace rubble {

/// In a union GCC 12 finds the padding of a type. Elsewhere it takes members behind an array of more than 64
/// bytes for padding.
template <class T> union Alone { T value; };

/// Copies elements with zeroed padding, where the compiler supports it. Padding carries no state but is
/// hashed.
template <class T> void copyClean(std::byte* to, const T* from, std::size_t bytes) {
#if defined(__has_builtin)
#if __has_builtin(__builtin_clear_padding)
  for (std::size_t i = 0; i < bytes / sizeof(T); ++i) {
    alignas(T) std::byte element[sizeof(T)];
    std::memcpy(element, from + i, sizeof(T));
    __builtin_clear_padding(reinterpret_cast<Alone<T>*>(element));
    std::memcpy(to + i * sizeof(T), element, sizeof(T));
  }
  return;
#endif
#endif
  if (bytes > 0) std::memcpy(to, from, bytes);
}

}  // namespace rubble
