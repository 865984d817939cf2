#include "io/json_text.h"

#include <algorithm>

namespace rubble::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLineLength = 140;

std::string dumped(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Appends a text in quotes. Most have nothing to escape, which dump() would take far longer to find.
void writeText(const std::string& text, std::string& out) {
  const bool plain = std::ranges::all_of(
      text, [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
  if (plain)
    out.append(1, '"').append(text).append(1, '"');
  else
    out += dumped(text);
}

void writeLeaf(const Json& value, std::string& out) {
  if (value.is_string())
    writeText(value.get_ref<const std::string&>(), out);
  else
    out += dumped(value);
}

/// All on one line; gives up (returns false) beyond `room` characters.
bool onOneLine(const Json& value, std::size_t room, std::string& out) {
  const std::size_t begin = out.size();
  if (!value.is_structured()) {
    writeLeaf(value, out);
    return out.size() - begin <= room;
  }
  out += value.is_array() ? "[" : "{";
  bool first = true;
  for (const auto& item : value.items()) {
    if (!first) out += ", ";
    first = false;
    if (value.is_object()) writeText(item.key(), out), out += ": ";
    if (out.size() - begin > room || !onOneLine(item.value(), room - (out.size() - begin), out)) return false;
  }
  out += value.is_array() ? "]" : "}";
  return out.size() - begin <= room;
}

void write(const Json& value, std::size_t indent, std::string& out) {
  const std::size_t begin = out.size();
  // A list of objects keeps one a line even if all would fit on one.
  const bool isTable = value.is_array() && !value.empty() && value.front().is_object();
  if (!isTable && onOneLine(value, kLineLength - indent, out)) return;
  out.resize(begin);
  if (!value.is_structured()) {
    writeLeaf(value, out);
    return;
  }
  out += value.is_array() ? "[" : "{";
  bool first = true;
  for (const auto& item : value.items()) {
    out += first ? "\n" : ",\n";
    first = false;
    out.append(indent + 2, ' ');
    if (value.is_object()) writeText(item.key(), out), out += ": ";
    write(item.value(), indent + 2, out);
  }
  out += "\n";
  out.append(indent, ' ');
  out += value.is_array() ? "]" : "}";
}

}  // namespace

std::string prettyJson(const Json& value) {
  std::string out;
  write(value, 0, out);
  return out + "\n";
}

}  // namespace rubble::io
