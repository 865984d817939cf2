#pragma once
/// Values to bytes and back, by one list of members for both directions: fields(archive, value) names them.
#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include <rubble/error.h>

namespace rubble {

/// The failure of a reader: more was named than there is.
inline Error cutShort() { return Error("snapshot", "as many bytes as it names", "fewer"); }

/// Appends values to bytes.
class ArchiveWriter {
 public:
  static constexpr bool kReads = false;
  std::vector<std::byte> bytes;

  void raw(const void* from, std::size_t size) {
    const auto* const at = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), at, at + size);
  }
  /// Number of a shared object, and whether it is a new one, whose content follows.
  std::pair<std::uint32_t, bool> number(const void* object) {
    const auto [place, isNew] = numbers_.try_emplace(object, static_cast<std::uint32_t>(numbers_.size()));
    return {place->second, isNew};
  }

 private:
  std::unordered_map<const void*, std::uint32_t> numbers_;
};

/// Reads values in the order in which they were written. Throws Error at the end of the bytes.
class ArchiveReader {
 public:
  static constexpr bool kReads = true;
  explicit ArchiveReader(std::span<const std::byte> bytes) : left_(bytes) {}

  void raw(void* to, std::size_t size) {
    if (size > left_.size()) throw cutShort();
    if (size > 0) std::memcpy(to, left_.data(), size);
    left_ = left_.subspan(size);
  }
  /// A count of elements, none of which takes less than a byte.
  std::size_t count() {
    std::uint64_t n;
    raw(&n, sizeof n);
    if (n > left_.size()) throw cutShort();
    return static_cast<std::size_t>(n);
  }
  std::vector<std::shared_ptr<const void>> shared;
  bool atEnd() const { return left_.empty(); }

 private:
  std::span<const std::byte> left_;
};

/// Numbers, and structs without pointers and padding, as their bytes.
template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <class A, Plain T> void fields(A& a, T& value) { a.raw(&value, sizeof value); }

template <class A> std::size_t countOf(A& a, std::size_t own) {
  if constexpr (A::kReads) {
    return a.count();
  } else {
    const std::uint64_t n = own;
    a.raw(&n, sizeof n);
    return own;
  }
}

template <class A> void fields(A& a, std::string& text) {
  text.resize(countOf(a, text.size()));
  a.raw(text.data(), text.size());
}

template <class A, class... T> void all(A& a, T&... values) { (fields(a, values), ...); }

template <class A, class T> void fields(A& a, std::vector<T>& list) {
  list.resize(countOf(a, list.size()));
  if constexpr (Plain<T>)
    a.raw(list.data(), sizeof(T) * list.size());
  else
    for (T& element : list) fields(a, element);
}
template <class A, class T, std::size_t n> void fields(A& a, std::array<T, n>& list) {
  for (T& element : list) fields(a, element);
}
template <class A, class T, class U> void fields(A& a, std::pair<T, U>& pair) {
  all(a, pair.first, pair.second);
}
template <class A, class T> void fields(A& a, std::optional<T>& value) {
  bool has = value.has_value();
  fields(a, has);
  if constexpr (A::kReads)
    if (has) value.emplace();
  if (has) fields(a, *value);
}

/// Sets and maps as sorted lists.
template <class A, class T> void fields(A& a, std::set<T>& set) {
  std::vector<T> list(set.begin(), set.end());
  fields(a, list);
  if constexpr (A::kReads) set = std::set<T>(list.begin(), list.end());
}
template <class A, class K, class V> void fields(A& a, std::unordered_map<K, V>& map) {
  std::vector<std::pair<K, V>> list(map.begin(), map.end());
  std::ranges::sort(list, {}, [](const auto& entry) { return entry.first; });
  fields(a, list);
  if constexpr (A::kReads) map = std::unordered_map<K, V>(list.begin(), list.end());
}

/// Objects that several places share are stored once.
template <class A, class T> void fields(A& a, std::shared_ptr<const T>& pointer) {
  bool has = pointer != nullptr;
  fields(a, has);
  if (!has) return;
  std::uint32_t number = 0;
  if constexpr (A::kReads) {
    fields(a, number);
    if (number > a.shared.size()) throw cutShort();
    if (number == a.shared.size()) {
      // its number comes before those of what it refers to
      const auto own = std::make_shared<T>();
      a.shared.push_back(own);
      fields(a, *own);
    }
    pointer = std::static_pointer_cast<const T>(a.shared[number]);
  } else {
    const auto [own, isNew] = a.number(pointer.get());
    number = own;
    fields(a, number);
    if (isNew) fields(a, const_cast<T&>(*pointer));  // a writer changes nothing
  }
}

template <class A, class... T> void fields(A& a, std::variant<T...>& value) {
  std::uint32_t index = static_cast<std::uint32_t>(value.index());
  fields(a, index);
  if constexpr (A::kReads) {
    std::uint32_t k = 0;
    ((k++ == index ? void(value.template emplace<T>()) : void()), ...);
    if (index >= sizeof...(T)) throw cutShort();
  }
  std::visit([&](auto& own) { fields(a, own); }, value);
}

}  // namespace rubble
