#include "world/value_path.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <rubble/error.h>

#include "cook/body_fields.h"
#include "cook/shape_traits.h"
#include "cook/soft_fields.h"
#include "forces/joint_kind.h"
#include "world/actuator_fields.h"

namespace rubble {

namespace {

constexpr const char*
    kPathForm = "a list, a name and keys, such as bodies.pole.mass or joints[\"a.b\"].length";

bool isDigits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

PathPart partOfText(std::string_view text) {
  PathPart part{std::string(text)};
  if (isDigits(text) && std::from_chars(text.data(), text.data() + text.size(), part.index).ec != std::errc{})
    part.index = -1;
  return part;
}

/// Finds a key, and knows which it has seen for the error.
class KeySearch {
 public:
  explicit KeySearch(std::string_view key) : key_(key) {}

  bool is(const FieldInfo& field) {
    if (field.is(key_)) return true;
    known_.push_back(field.key);
    return false;
  }
  [[noreturn]] void fail() const {
    std::string all;
    for (const char* each : known_) all += (all.empty() ? "one of " : ", ") + std::string(each);
    throw Error("path", all.empty() ? "a value" : all,
                key_.empty() ? "none" : "\"" + std::string(key_) + "\"");
  }

  /// The value of a field of the list, if one has the key and numbers.
  template <class Fields, class Object> std::optional<ValuePlace> in(const Fields& fields, Object& object) {
    std::optional<ValuePlace> found;
    forEachField(fields, object, [&]<class T>(const FieldInfo& field, T& value) {
      if constexpr (requires { ValuePlace{field, &value}; })
        if (!found && is(field)) found = ValuePlace{field, &value};
    });
    return found;
  }
  template <class Object>
  std::optional<ValuePlace> in(const std::vector<AnyField<Object>>& fields, Object& object) {
    for (const AnyField<Object>& field : fields)
      if (is(field))
        return std::visit([&](auto* value) { return ValuePlace{field, value}; }, field.edit(object));
    return {};
  }

 private:
  std::string_view key_;
  std::vector<const char*> known_;
};

std::string_view firstKey(std::span<const PathPart> keys) {
  return keys.empty() ? std::string_view() : std::string_view(keys.front().text);
}

/// There are no keys after these.
void endsAfter(std::span<const PathPart> keys, std::size_t count) {
  if (keys.size() > count) throw Error("path", "no key after " + keys[count - 1].text, keys[count].text);
}

template <class Def, class... Lists>
ValuePlace placeInLists(Def& def, std::span<const PathPart> keys, const Lists&... lists) {
  KeySearch search(firstKey(keys));
  std::optional<ValuePlace> found;
  ((found = found ? found : search.in(lists, def)), ...);
  if (!found) search.fail();
  endsAfter(keys, 1);
  return *found;
}

constexpr FieldInfo kBothFrictions{"friction", "1", "static and dynamic", kAtLeast0};

}  // namespace

ValuePath::ValuePath(const std::string& text) : text_(text) {
  const auto fail = [&] { throw Error("path", kPathForm, "\"" + text + "\""); };
  for (std::size_t at = 0;;) {
    const bool isBracket = at < text.size() && text[at] == '[' && !parts_.empty();
    if (isBracket && at + 1 < text.size() && text[at + 1] == '"') {
      PathPart& part = parts_.emplace_back();
      for (at += 2; at < text.size() && text[at] != '"'; ++at) {
        if (text[at] == '\\') ++at;
        if (at < text.size()) part.text += text[at];
      }
      if (text.compare(at, 2, "\"]") != 0) fail();
      at += 2;
    } else if (isBracket) {
      const std::size_t end = std::min(text.find(']', at), text.size());
      parts_.push_back(partOfText(std::string_view(text).substr(at + 1, end - at - 1)));
      if (end == text.size() || parts_.back().index < 0) fail();
      parts_.back().isPlace = true;
      at = end + 1;
    } else {
      const std::size_t end = std::min(text.find_first_of(".[", at), text.size());
      if (end == at) fail();
      parts_.push_back(partOfText(std::string_view(text).substr(at, end - at)));
      at = end;
    }
    if (at == text.size()) return;
    if (text[at] == '.')
      ++at;
    else if (text[at] != '[')
      fail();
  }
}

void ValuePlace::set(std::span<const double> numbers) const {
  const auto need = [&](std::size_t count) {
    if (numbers.size() != count)
      throw Error("values", std::to_string(count) + " for " + field.key + " in each world",
                  std::to_string(numbers.size()));
  };
  const double scale = 1 / field.rules.factor;
  const auto vector = [&] { return Vec3{numbers[0], numbers[1], numbers[2]} * scale; };
  std::visit(
      [&]<class T>(const T& to) {
        if constexpr (std::is_same_v<T, std::vector<double>*>) {
          need(to->size());
          to->assign(numbers.begin(), numbers.end());
        } else if constexpr (std::is_same_v<T, Vec3*> || std::is_same_v<T, std::optional<Vec3>*>) {
          need(3);
          *to = vector();
        } else if constexpr (std::is_same_v<T, Quat*>) {
          need(4);
          *to = Quat{numbers[0], numbers[1], numbers[2], numbers[3]};
        } else if constexpr (std::is_same_v<T, bool*>) {
          need(1);
          if (numbers[0] != 0 && numbers[0] != 1)
            throw Error(field.key, "0 or 1", std::to_string(numbers[0]));
          *to = numbers[0] != 0;
        } else if constexpr (std::is_same_v<T, BothFrictions> || std::is_same_v<T, BothPairFrictions>) {
          need(1);
          *to.first = *to.second = numbers[0];
        } else {
          need(1);
          *to = numbers[0] * scale;
        }
      },
      at);
}

void ValuePlace::get(std::vector<double>& to) const {
  const double factor = field.rules.factor;
  const auto given = [&](const auto& value) {
    if (!value) throw Error(field.key, "a value of the definition", "none");
    return *value;
  };
  const auto vector = [&](const Vec3& v) { to.insert(to.end(), {v.x * factor, v.y * factor, v.z * factor}); };
  std::visit(
      [&]<class T>(const T& from) {
        if constexpr (std::is_same_v<T, std::vector<double>*>)
          to.insert(to.end(), from->begin(), from->end());
        else if constexpr (std::is_same_v<T, Vec3*>)
          vector(*from);
        else if constexpr (std::is_same_v<T, std::optional<Vec3>*>)
          vector(given(*from));
        else if constexpr (std::is_same_v<T, Quat*>)
          to.insert(to.end(), {from->s, from->v.x, from->v.y, from->v.z});
        else if constexpr (std::is_same_v<T, bool*>)
          to.push_back(*from ? 1 : 0);
        else if constexpr (std::is_same_v<T, BothFrictions>)
          to.push_back(*from.first);
        else if constexpr (std::is_same_v<T, BothPairFrictions>)
          to.push_back(given(*from.first));
        else if constexpr (std::is_same_v<T, std::optional<double>*>)
          to.push_back(given(*from) * factor);
        else
          to.push_back(*from * factor);
      },
      at);
}

bool isBodyState(std::span<const PathPart> keys) {
  BodyDef any;
  return KeySearch(firstKey(keys)).in(kBodyStateFields, any).has_value();
}

ValuePlace placeIn(Material& material, std::span<const PathPart> keys) {
  if (keys.size() == 1 && kBothFrictions.is(keys[0].text))
    return {kBothFrictions, BothFrictions{&material.staticFriction, &material.dynamicFriction}};
  return placeInLists(material, keys, kFrictionFields, kRestitutionField, kSurfaceFields);
}

ValuePlace placeIn(MaterialPair& pair, std::span<const PathPart> keys) {
  if (keys.size() == 1 && kBothFrictions.is(keys[0].text))
    return {kBothFrictions, BothPairFrictions{&pair.staticFriction, &pair.dynamicFriction}};
  return placeInLists(pair, keys, kMaterialPairFields);
}

ValuePlace placeIn(BodyDef& body, std::span<const PathPart> keys) {
  const std::string_view first = firstKey(keys);
  if (first == "material") return placeIn(body.material, keys.subspan(1));
  if (first == "shape") return placeInLists(body.shape, keys.subspan(1), traitsOf(body.shape.type).fields);
  ValuePlace found = placeInLists(body, keys, kMassFields, kBodyStateFields, kBodyFields);
  if (found.field.is("density")) body.mass.reset();
  return found;
}

ValuePlace placeIn(JointDef& joint, std::span<const PathPart> keys) {
  const JointKind& kind = kindOf(joint.type);
  if (firstKey(keys) == "axes") {
    if (keys.size() < 2 || keys[1].index < 0 || keys[1].index >= kind.axes)
      throw Error("path", "one of " + std::to_string(kind.axes) + " axes, from 0",
                  keys.size() < 2 ? "none" : keys[1].text);
    return placeInLists(joint.axes[static_cast<std::size_t>(keys[1].index)], keys.subspan(2), kAxisFields);
  }
  return placeInLists(joint, keys, kind.fields);
}

ValuePlace placeIn(Deformable& object, std::span<const PathPart> keys) {
  const std::string_view first = firstKey(keys);
  if (first == "material") return placeIn(common(object).material, keys.subspan(1));
  if (first == "velocity" || first == "angular_velocity")
    throw Error("path", "a value that lasts: World::setVertices() sets velocities", std::string(first));
  return std::visit(
      [&]<class D>(D& own) {
        // a kind has no fields, or fields of its own
        return placeInLists(own, keys, kDeformableFields, kOwnFields<D>);
      },
      object);
}

ValuePlace placeIn(AttachmentDef& attachment, std::span<const PathPart> keys) {
  // weights are shares of one whole
  const std::string_view first = firstKey(keys);
  if (first == "weights" || first == "other_weights")
    throw Error("path", "anchor, stiffness or break_force", std::string(first));
  return placeInLists(attachment, keys, kAttachmentFields);
}

ValuePlace placeIn(ActuatorDef& actuator, std::span<const PathPart> keys) {
  if (firstKey(keys) == "muscle") return placeInLists(actuator.muscle, keys.subspan(1), kMuscleFields);
  return placeInLists(actuator, keys, kActuatorFields);
}

}  // namespace rubble
