#pragma once
/// Fields: what is said about a member of an authored definition. A definition lists its fields once.
/// Readers, writers, validation, listings, inspector rows and tests follow from the list.
#include <any>
#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <rubble/math.h>

namespace rubble {

/// Range of a number.
enum class FieldRange { Any, NotNegative, Positive };

struct FieldRules {
  FieldRange range = FieldRange::Any;
  const char* infinity = nullptr;  ///< word for an infinite number: "hard", "never"; null: it must be finite
  bool always = false;             ///< true: files have it even if it has its default
  const char* name = nullptr;      ///< of the member; null: the key in camel case
  double factor = 1;               ///< number in files over that of the member
};

/// A field without its types.
struct FieldInfo {
  const char* key;   ///< in files: "break_force"
  const char* unit;  ///< "1" for none
  const char* doc;
  FieldRules rules;

  bool is(std::string_view other) const { return other == key; }
  /// Name of the member, for paths in errors: "breakForce".
  std::string name() const {
    if (rules.name) return rules.name;
    std::string out;
    for (const char* c = key; *c; ++c) out += *c == '_' ? static_cast<char>(*++c - 'a' + 'A') : *c;
    return out;
  }
};

/// A member of type T of an Owner.
template <class Owner, class T> struct Field : FieldInfo {
  using Of = Owner;
  T Owner::*member;
};

template <class Owner, class T>
constexpr Field<Owner, T> field(const char* key, const char* unit, const char* doc, T Owner::*member,
                                FieldRules rules = {}) {
  return {{key, unit, doc, rules}, member};
}

/// Calls f(field, value) for each field of a list; `object` may be const.
template <class... F, class Object, class Function>
void forEachField(const std::tuple<F...>& fields, Object&& object, Function&& f) {
  std::apply([&](const F&... each) { (f(each, object.*each.member), ...); }, fields);
}

/// The struct of type Owner that a value carries: a default one if it has none.
template <class Owner> Owner& ownIn(std::any& own) {
  if (!std::any_cast<Owner>(&own)) own = Owner{};
  return *std::any_cast<Owner>(&own);
}
template <class Owner> const Owner& ownIn(const std::any& own) {
  static const Owner usual{};
  const Owner* const found = std::any_cast<Owner>(&own);
  return found ? *found : usual;
}

/// A field of an Object without the type of its value.
template <class Object> struct AnyField : FieldInfo {
  using Place = std::variant<double*, bool*, Vec3*, Quat*, std::vector<double>*>;
  using ConstPlace = std::variant<const double*, const bool*, const Vec3*, const Quat*,
                                  const std::vector<double>*>;
  Place (*edit)(Object&);
  ConstPlace (*read)(const Object&);

  /// Calls f(value).
  template <class F> void visit(Object& object, F&& f) const {
    std::visit([&](auto* value) { f(*value); }, edit(object));
  }
  template <class F> void visit(const Object& object, F&& f) const {
    std::visit([&](auto* value) { f(*value); }, read(object));
  }
  /// Calls f(value, value in `other`).
  template <class F> void visit(const Object& object, const Object& other, F&& f) const {
    visit(object, [&]<class T>(const T& value) { f(value, *std::get<const T*>(read(other))); });
  }
};

/// Is a field of that key in the list?
template <class Object> bool hasField(const std::vector<AnyField<Object>>& fields, std::string_view key) {
  for (const AnyField<Object>& field : fields)
    if (field.is(key)) return true;
  return false;
}

/// The fields of a kind K (K::kFields) in objects; `In` finds their owner: In::owner<Owner>(object).
template <class Object, class K, class In> std::vector<AnyField<Object>> anyFields() {
  std::vector<AnyField<Object>> fields;
  const auto add = [&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
    static constexpr auto kField = std::get<I>(K::kFields);
    using Owner = typename decltype(kField)::Of;
    fields.push_back({kField,
                      [](Object& o) -> typename AnyField<Object>::Place {
                        return &(In::template owner<Owner>(o).*kField.member);
                      },
                      [](const Object& o) -> typename AnyField<Object>::ConstPlace {
                        return &(In::template owner<Owner>(o).*kField.member);
                      }});
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) { (add(std::integral_constant<std::size_t, I>{}), ...); }
  (std::make_index_sequence<std::tuple_size_v<decltype(K::kFields)>>{});
  return fields;
}

}  // namespace rubble
