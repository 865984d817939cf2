#include "convert/tag.h"

#include <charconv>
#include <cmath>
#include <string_view>

namespace rubble::convert {
namespace {

constexpr std::string_view kSpaces = " \t\r\n";

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> out;
  for (std::size_t at = 0;;) {
    at = text.find_first_not_of(kSpaces, at);
    if (at == std::string_view::npos) return out;
    const std::size_t end = std::min(text.find_first_of(kSpaces, at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end;
  }
}

std::string listOf(const std::vector<std::string>& names) {
  std::string out = "one of ";
  for (std::size_t i = 0; i < names.size(); ++i) out += (i > 0 ? ", " : "") + names[i];
  return out;
}

/// A value in an error, cut to a readable length.
std::string shown(const std::string& value) {
  constexpr std::size_t kMost = 60;
  return "\"" + (value.size() > kMost ? value.substr(0, kMost) + "..." : value) + "\"";
}

}  // namespace

Tag::Tag(Source& source, pugi::xml_node node, std::vector<pugi::xml_node> defaults)
    : source_(&source), node_(node), defaults_(std::move(defaults)) {
  source.use(node);
}

std::string Tag::path(const std::string& key) const { return source_->path(node_) + "." + key; }

void Tag::fail(const std::string& key, const std::string& expected, const std::string& got) const {
  throw Error(path(key), expected, got);
}

pugi::xml_attribute Tag::find(const char* key) const {
  source_->know(type() + "." + key);
  pugi::xml_attribute found = node_.attribute(key);
  for (std::size_t i = 0; !found && i < defaults_.size(); ++i) found = defaults_[i].attribute(key);
  if (found) source_->use(found);
  return found;
}

bool Tag::hasOwn(const char* key) const { return static_cast<bool>(node_.attribute(key)); }

std::optional<std::string> Tag::text(const char* key) const {
  const pugi::xml_attribute found = find(key);
  return found ? std::optional<std::string>(found.value()) : std::nullopt;
}

std::string Tag::need(const char* key) const {
  const std::optional<std::string> found = text(key);
  if (!found || found->empty()) fail(key, "a value", "none");
  return *found;
}

std::optional<std::vector<double>> Tag::numbers(const char* key, std::size_t least, std::size_t most) const {
  const std::optional<std::string> found = text(key);
  if (!found) return std::nullopt;
  std::vector<double> out;
  for (std::string_view word : words(*found)) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size())
      fail(key, error == std::errc::result_out_of_range ? "a number in range" : "a number",
           shown(std::string(word)));
    if (!std::isfinite(value) || std::fabs(value) > kLargest)
      fail(key, "finite numbers of at most 1e15", shown(std::string(word)));
    out.push_back(value);
  }
  if (out.size() < least || out.size() > most)
    fail(key,
         least == most ? std::to_string(least) + (least == 1 ? " number" : " numbers")
                       : std::to_string(least) + " to " + std::to_string(most) + " numbers",
         std::to_string(out.size()));
  return out;
}

std::optional<double> Tag::number(const char* key) const {
  const auto list = numbers(key, 1, 1);
  return list ? std::optional(list->front()) : std::nullopt;
}

double Tag::needNumber(const char* key) const {
  const std::optional<double> found = number(key);
  if (!found) fail(key, "a number", "none");
  return *found;
}

std::optional<int> Tag::whole(const char* key, int least, int most) const {
  const std::optional<double> found = number(key);
  if (!found) return std::nullopt;
  if (*found != std::floor(*found) || *found < least || *found > most)
    fail(key, "a whole number from " + std::to_string(least) + " to " + std::to_string(most),
         shown(*text(key)));
  return static_cast<int>(*found);
}

std::optional<Vec3> Tag::vector(const char* key) const {
  const auto list = numbers(key, 3, 3);
  return list ? std::optional(Vec3{(*list)[0], (*list)[1], (*list)[2]}) : std::nullopt;
}

std::optional<std::array<double, 2>> Tag::range(const char* key) const {
  const auto list = numbers(key, 2, 2);
  return list ? std::optional(std::array<double, 2>{(*list)[0], (*list)[1]}) : std::nullopt;
}

std::optional<bool> Tag::flag(const char* key) const {
  const std::optional<std::string> found = text(key);
  if (!found) return std::nullopt;
  if (*found == "true" || *found == "1") return true;
  if (*found == "false" || *found == "0") return false;
  fail(key, "true or false", shown(*found));
}

std::size_t Tag::choice(const char* key, const std::vector<std::string>& names, std::size_t otherwise) const {
  const std::optional<std::string> found = text(key);
  if (!found) return otherwise;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == *found) return i;
  fail(key, listOf(names), shown(*found));
}

}  // namespace rubble::convert
