#include "convert/source.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>

#include <rubble/error.h>

namespace rubble::convert {
namespace {

/// Largest size of an XML file [bytes].
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 26;
/// Largest depth of elements. Readers recurse over them.
constexpr int kMostDepth = 200;

/// Line and column, from 1, of a byte.
std::string lineAndColumn(const std::vector<std::ptrdiff_t>& lines, std::ptrdiff_t byte) {
  const auto after = std::upper_bound(lines.begin(), lines.end(), byte);
  const auto line = after - lines.begin();
  return std::to_string(line) + ":" + std::to_string(byte - *(after - 1) + 1);
}

/// First byte that is not part of a character in UTF-8, or npos.
std::size_t firstInvalid(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned lead = byte(i);
    const std::size_t more = lead < 0x80 ? 0 : lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : 3;
    if ((lead >= 0x80 && lead < 0xc2) || lead > 0xf4) return i;
    // no overlong forms, no surrogates, nothing beyond U+10FFFF
    const unsigned least = lead == 0xe0 ? 0xa0 : lead == 0xf0 ? 0x90 : 0x80;
    const unsigned most = lead == 0xed ? 0x9f : lead == 0xf4 ? 0x8f : 0xbf;
    if (more > 0 && (byte(i + 1) < least || byte(i + 1) > most)) return i;
    for (std::size_t k = 2; k <= more; ++k)
      if (byte(i + k) < 0x80 || byte(i + k) > 0xbf) return i;
    i += more + 1;
  }
  return std::string_view::npos;
}

}  // namespace

pugi::xml_node Source::parse(const std::string& text, const std::string& name) {
  File& file = files_.emplace_back();
  file.name = name;
  file.lines.push_back(0);
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') file.lines.push_back(static_cast<std::ptrdiff_t>(i) + 1);
  if (const std::size_t at = firstInvalid(text); at != std::string_view::npos)
    throw Error(name + ":" + lineAndColumn(file.lines, static_cast<std::ptrdiff_t>(at)), "text in UTF-8",
                "a byte that is none");
  const pugi::xml_parse_result result = file.document.load_buffer(
      text.data(), text.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result)
    throw Error(name + ":" + lineAndColumn(file.lines, result.offset), "well-formed XML",
                result.description());
  pugi::xml_node root = file.document.document_element();
  for (const pugi::xml_node& node : file.document.children())
    if (node.type() == pugi::node_doctype)
      throw Error(name, "no document type: entities are not expanded", "<!DOCTYPE>");
  if (!root) throw Error(name, "an element", "none");
  fileOfRoot_[file.document.internal_object()] = files_.size() - 1;
  int depth = 0;
  for (pugi::xml_node node = root; node;) {
    if (node.first_child() && depth < kMostDepth) {
      node = node.first_child(), ++depth;
      continue;
    }
    if (node.first_child())
      throw Error(path(node), "at most " + std::to_string(kMostDepth) + " levels of elements", "more");
    while (node && node != root && !node.next_sibling()) node = node.parent(), --depth;
    if (!node || node == root) break;
    node = node.next_sibling();
  }
  return root;
}

pugi::xml_node Source::load(const std::filesystem::path& file, const std::string& who) {
  std::error_code failed;
  const std::filesystem::path full = std::filesystem::weakly_canonical(file, failed);
  if (failed || !std::filesystem::is_regular_file(full, failed))
    throw Error(who, "a file that exists", "\"" + file.string() + "\"");
  const std::uintmax_t size = std::filesystem::file_size(full, failed);
  if (failed || size > kMostBytes)
    throw Error(who, "a file of at most " + std::to_string(kMostBytes) + " bytes", std::to_string(size));
  std::ifstream in(full, std::ios::binary);
  std::ostringstream text;
  if (!in || (size > 0 && !(text << in.rdbuf()))) throw Error(who, "a file that can be read", file.string());
  if (files_.empty()) home_ = full.parent_path();
  loaded_.insert(full);
  return parse(text.str(), file.filename().string());
}

pugi::xml_node Source::loadText(const std::string& text, const std::string& file) {
  if (home_.empty()) home_ = std::filesystem::current_path();
  return parse(text, file);
}

pugi::xml_node Source::included(pugi::xml_node include) {
  const auto known = rootOfInclude_.find(include.internal_object());
  if (known != rootOfInclude_.end()) return known->second;
  use(include);
  const pugi::xml_attribute name = include.attribute("file");
  const std::string who = path(include) + ".file";
  if (!name) throw Error(who, "the name of a file", "none");
  use(name);
  const std::filesystem::path file = folders_.find(home_, name.value(), who);
  if (loaded_.contains(file))
    throw Error(who, "a file that is included once (no cycle)", "\"" + std::string(name.value()) + "\"");
  const pugi::xml_node root = load(file, who);
  use(root);
  rootOfInclude_[include.internal_object()] = root;
  return root;
}

std::vector<pugi::xml_node> Source::children(pugi::xml_node parent) {
  std::vector<pugi::xml_node> out;
  // a file is included once, so the recursion ends
  const auto add = [&](const auto& self, pugi::xml_node node) -> void {
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      if (std::string_view(child.name()) == "include")
        self(self, included(child));
      else
        out.push_back(child);
    }
  };
  add(add, parent);
  return out;
}

std::vector<pugi::xml_node> Source::children(pugi::xml_node parent, const std::string& name) {
  std::vector<pugi::xml_node> out = children(parent);
  std::erase_if(out, [&](const pugi::xml_node& node) { return name != node.name(); });
  return out;
}

Place Source::place(pugi::xml_node node) const {
  const auto found = fileOfRoot_.find(node.root().internal_object());
  if (found == fileOfRoot_.end()) return {};
  const File& file = files_[found->second];
  while (node.offset_debug() < 0 && node.parent())
    node = node.parent();  // an element that the import has made
  const auto after = std::upper_bound(file.lines.begin(), file.lines.end(), node.offset_debug());
  return {file.name, static_cast<int>(after - file.lines.begin())};
}

std::vector<pugi::xml_node> Source::roots() const {
  std::vector<pugi::xml_node> out;
  for (const File& file : files_) out.push_back(file.document.document_element());
  return out;
}

}  // namespace rubble::convert
