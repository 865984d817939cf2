#include "io/json_reader.h"

#include <algorithm>
#include <cmath>

#include "cook/names.h"

namespace rubble::io {

std::string Fault::text() const {
  if (line > 0) return "line " + std::to_string(line) + ", column " + std::to_string(column) + ": " + message;
  return path.empty() ? message : path + ": " + message;
}

std::string hint(std::string_view name, const std::vector<std::string>& names) {
  const std::string* best = nullptr;
  std::size_t bestDistance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : names) {
    const std::size_t distance = editDistance(name, candidate, bestDistance);
    if (distance < bestDistance) best = &candidate, bestDistance = distance;
  }
  return best ? " (did you mean " + describe(*best) + "?)" : "";
}

std::string Node::path() const {
  if (!parent_) return std::string(name_);
  const std::string outer = parent_->path();
  if (index_ != kNoIndex) return outer + "[" + std::to_string(index_) + "]";
  return (outer.empty() ? "" : outer + ".") + std::string(value_->key());
}

void Node::fault(const std::string& expected) const {
  faultText("expected " + expected + ", got " + describe(*value_));
}

void Node::faultText(const std::string& message) const { faults_->push_back({path(), 0, 0, message}); }

Nodes Node::elements(const char* what) const {
  if (!value_->isList()) fault(what);
  return {*this, value_->isList() ? value_->size() : 0};
}

std::optional<double> Node::numberWithin(const Want& want) const {
  if (!value_->isNumber()) return std::nullopt;
  const double number = value_->number();
  const bool aboveMin = want.minIncluded ? number >= want.min : number > want.min;
  return std::isfinite(number) && aboveMin && number <= want.max ? std::optional(number) : std::nullopt;
}

std::optional<double> Node::number(const Want& want) const {
  const std::optional<double> number = numberWithin(want);
  if (!number) fault(want.text);
  return number;
}

std::optional<int> Node::whole(int min, const char* text) const {
  if (value_->isInteger()) {
    const double number = value_->number();
    if (number >= min && number <= std::numeric_limits<int>::max()) return static_cast<int>(number);
  }
  fault(text);
  return std::nullopt;
}

std::optional<std::string> Node::text() const {
  if (value_->isText()) return std::string(value_->text());
  fault("a text");
  return std::nullopt;
}

std::optional<bool> Node::boolean() const {
  if (value_->isBoolean()) return value_->boolean();
  fault("true or false");
  return std::nullopt;
}

std::optional<Vec3> Node::vectorWithin(const Want& each) const {
  if (!value_->isList() || value_->size() != 3) return std::nullopt;
  Vec3 out;
  int i = 0;
  for (const Node& part : Nodes(*this, 3)) {
    const std::optional<double> number = part.numberWithin(each);
    if (!number) return std::nullopt;
    out[i++] = *number;
  }
  return out;
}

std::optional<Vec3> Node::vector(const Want& each, const char* text) const {
  const std::optional<Vec3> out = vectorWithin(each);
  if (out) return out;
  if (!value_->isList() || value_->size() != 3)
    fault(text);
  else
    for (const Node& part : Nodes(*this, 3)) part.number(each);
  return std::nullopt;
}

std::optional<std::size_t> Node::choice(const std::vector<std::string>& names) const {
  if (value_->isText()) {
    const auto found = std::ranges::find(names, value_->text());
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  }
  std::string wanted;
  for (const std::string& name : names) wanted += (wanted.empty() ? "" : ", ") + describe(name);
  faultText("expected one of " + wanted + ", got " + describe(*value_) +
            (value_->isText() ? hint(value_->text(), names) : ""));
  return std::nullopt;
}

ObjectReader::ObjectReader(const Node& node, const char* what)
    : node_(node), isObject_(node.value().isObject()) {
  constexpr std::size_t kUsual = 32;
  known_.reserve(kUsual);
  if (!isObject_) node_.fault(what);
}

std::optional<Node> ObjectReader::get(std::string_view key) {
  known_.push_back(key);
  const JsonValue* const found = isObject_ ? node_.value().find(key) : nullptr;
  return found ? std::optional(node_.member(*found)) : std::nullopt;
}

std::optional<Node> ObjectReader::need(std::string_view key, std::string_view what) {
  std::optional<Node> found = get(key);
  if (!found && isObject_)
    node_.faultText("expected \"" + std::string(key) + "\", " + std::string(what) + ", got none");
  return found;
}

void ObjectReader::finish() {
  if (!isObject_) return;
  const auto isKnown = [&](const JsonValue* member) {
    return std::ranges::find(known_, member->key()) != known_.end();
  };
  std::vector<const JsonValue*> unknown;
  for (const JsonValue& member : node_.value())
    if (!isKnown(&member)) unknown = node_.value().members();
  if (unknown.empty()) return;
  std::erase_if(unknown, isKnown);
  std::vector<std::string> known(known_.begin(), known_.end());
  std::ranges::sort(known);
  known.erase(std::unique(known.begin(), known.end()), known.end());
  std::string all;
  for (const std::string& key : known) all += (all.empty() ? "" : ", ") + key;
  for (const JsonValue* const member : unknown) {
    const std::string near = hint(member->key(), known);
    node_.member(*member).faultText("unknown key" + (near.empty() ? "; known here: " + all : near));
  }
}

void ObjectReader::read(std::string_view key, double& out, const Want& want) {
  if (const auto node = get(key)) out = node->number(want).value_or(out);
}
void ObjectReader::read(std::string_view key, std::string& out) {
  if (const auto node = get(key)) out = node->text().value_or(out);
}
void ObjectReader::read(std::string_view key, bool& out) {
  if (const auto node = get(key)) out = node->boolean().value_or(out);
}
void ObjectReader::read(std::string_view key, std::uint64_t& out) {
  const auto node = get(key);
  if (!node) return;
  if (node->value().type() == JsonValue::Type::Whole)
    out = node->value().whole();
  else
    node->fault("a whole number from 0 to 2^64 - 1");
}
void ObjectReader::read(std::string_view key, Vec3& out) {
  if (const auto node = get(key)) out = node->vector().value_or(out);
}

}  // namespace rubble::io
