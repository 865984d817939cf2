#include "io/field_json.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "io/shape_json.h"

namespace rubble::io {

using Ordered = nlohmann::ordered_json;

static constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What is expected of a number, in words: "a length above 0 [m]".
static std::string textOf(const FieldInfo& field) {
  const bool positive = field.rules.range == FieldRange::Positive;
  const std::string_view unit = field.unit;
  std::string text = "a number";
  if (positive && !field.rules.infinity) {
    if (unit == "m") text = "a length";
    if (unit == "kg") text = "a mass";
    if (unit == "kg/m3") text = "a density";
    if (unit == "kg m2") text = "a moment of inertia";
  }
  if (field.rules.range != FieldRange::Any) text += positive ? " above 0" : " of at least 0";
  text += std::string(" [") + field.unit + "]";
  return field.rules.infinity ? text + ", or \"" + field.rules.infinity + "\"" : text;
}
static Want wanted(const FieldInfo& field) {
  return {field.rules.range == FieldRange::Any ? -kInfinity : 0, field.rules.range != FieldRange::Positive};
}

void readField(ObjectReader& object, const FieldInfo& field, double& out) {
  const auto node = object.get(field.key);
  if (!node) return;
  const FieldRules& rules = field.rules;
  // the lower side of a limit stays below
  if (rules.infinity && node->value().isText(rules.infinity))
    out = std::isinf(out) && out < 0 ? -kInfinity : kInfinity;
  else if (const auto value = node->numberWithin(wanted(field)))
    out = *value / rules.factor;
  else
    node->fault(textOf(field));
}
void readField(ObjectReader& object, const FieldInfo& field, Vec3& out) {
  const auto node = object.get(field.key);
  if (!node) return;
  if (const auto value = node->vectorWithin(wanted(field))) {
    out = *value / field.rules.factor;
    return;
  }
  // which number it is
  Want want = wanted(field);
  const std::string text = textOf(field);
  if (field.rules.range != FieldRange::Any) want.text = text.c_str();
  node->vector(want);
}
void readField(ObjectReader& object, const FieldInfo& field, std::optional<double>& out) {
  if (object.get(field.key)) readField(object, field, out.emplace());
}
void readField(ObjectReader& object, const FieldInfo& field, std::optional<Vec3>& out) {
  if (object.get(field.key)) readField(object, field, out.emplace());
}
void readField(ObjectReader& object, const FieldInfo& field, bool& out) { object.read(field.key, out); }
void readField(ObjectReader& object, const FieldInfo& field, Quat& out) {
  if (const auto found = object.get(field.key)) out = readOrientation(*found);
}
void readField(ObjectReader& object, const FieldInfo& field, std::vector<double>& out) {
  const auto found = object.get(field.key);
  if (!found) return;
  out.clear();
  for (const Node& node : found->elements("a list of numbers")) out.push_back(node.number().value_or(0));
}

Ordered fieldJson(const FieldInfo& field, double value) {
  return std::isinf(value) && field.rules.infinity ? Ordered(field.rules.infinity)
                                                   : Ordered(value * field.rules.factor);
}
Ordered fieldJson(const FieldInfo&, bool value) { return value; }
Ordered fieldJson(const FieldInfo& field, const Vec3& value) {
  return vectorJson(value * field.rules.factor);
}
Ordered fieldJson(const FieldInfo&, const Quat& value) { return quaternionJson(value); }
Ordered fieldJson(const FieldInfo&, const std::vector<double>& value) { return value; }

Ordered vectorJson(const Vec3& v) { return {v.x, v.y, v.z}; }
Ordered quaternionJson(const Quat& q) { return {q.s, q.v.x, q.v.y, q.v.z}; }

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool sameBits(bool a, bool b) { return a == b; }
bool sameBits(const Vec3& a, const Vec3& b) {
  return sameBits(a.x, b.x) && sameBits(a.y, b.y) && sameBits(a.z, b.z);
}
bool sameBits(const Quat& a, const Quat& b) { return sameBits(a.s, b.s) && sameBits(a.v, b.v); }

bool sameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return sameBits(x, y); });
}

}  // namespace rubble::io
