#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

namespace rubble {

/// In a union GCC 12 finds the padding of a type. Elsewhere it takes members behind an array of more than 64
/// bytes for padding.
template <class T> union Alone { T value; };

/// Whether byte I of a T belongs to a member. Padding has no value, so an expression with it is no constant.
template <class T, std::size_t I>
concept HasValueAt = requires {
  typename std::bool_constant<(std::bit_cast<std::array<std::byte, sizeof(T)>>(T{})[I] == std::byte{}, true)>;
};

/// For each byte of a T, which must be one without bit fields and with a constant default: 0xff, and 0 in
/// padding.
template <class T> constexpr std::array<std::byte, sizeof(T)> valueMask() {
  return []<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<std::byte, sizeof(T)>{(HasValueAt<T, I> ? std::byte{0xff} : std::byte{0})...};
  }
  (std::make_index_sequence<sizeof(T)>{});
}

#if defined(__has_builtin)
#if __has_builtin(__builtin_clear_padding)
#define RUBBLE_CLEARS_PADDING 1
#endif
#endif

/// Copies elements with zeroed padding, which carries no state but is hashed. Clang 14 cannot say where that
/// of some types is, and keeps it.
template <class T> void copyClean(std::byte* to, const T* from, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes / sizeof(T); ++i) {
    alignas(T) std::byte element[sizeof(T)];
    std::memcpy(element, from + i, sizeof(T));
#if defined(RUBBLE_CLEARS_PADDING)
    __builtin_clear_padding(reinterpret_cast<Alone<T>*>(element));
#else
    if constexpr (!std::has_unique_object_representations_v<T> && HasValueAt<T, 0>) {
      static constexpr std::array<std::byte, sizeof(T)> kMask = valueMask<T>();
      for (std::size_t k = 0; k < sizeof(T); ++k) element[k] &= kMask[k];
    }
#endif
    std::memcpy(to + i * sizeof(T), element, sizeof(T));
  }
}

}  // namespace rubble
