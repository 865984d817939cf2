#pragma once
/// Lists of types. Tables, loops and numbers of types are generated from them.
#include <type_traits>

#include <rubble/math.h>

namespace rubble {

template <class... T> struct TypeList { static constexpr int kSize = sizeof...(T); };

/// Calls f.template operator()<T>() for each type, in order.
template <class Function, class... T> RUBBLE_HD void forEachType(TypeList<T...>, Function&& f) {
  (f.template operator()<T>(), ...);
}

/// Index of G in the list, or -1.
template <class G, class... T> constexpr int typeIndex(TypeList<T...>) {
  int index = 0, found = -1;
  ((found = std::is_same_v<T, G> ? index : found, ++index), ...);
  return found;
}

template <class List, class... T> struct UniqueTypes { using Type = List; };
template <class... Found, class T, class... Rest>
struct UniqueTypes<TypeList<Found...>, T, Rest...>
    : UniqueTypes<
          std::conditional_t<(std::is_same_v<Found, T> || ...), TypeList<Found...>, TypeList<Found..., T>>,
          Rest...> {};
/// The list without repetitions, in the order of first appearance.
template <class... T> using Unique = typename UniqueTypes<TypeList<>, T...>::Type;

}  // namespace rubble
