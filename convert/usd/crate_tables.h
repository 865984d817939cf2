#pragma once
/// The tables of a crate file: tokens, strings, fields and paths, and its bytes with a place to read at.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <rubble/error.h>

#include "convert/usd/layer.h"
#include "convert/usd/packed.h"

namespace rubble::usd {

class CrateTables {
 public:
  CrateTables(const std::string& bytes, const std::string& file) : bytes_(bytes), file_(file) {}

 protected:
  static constexpr std::size_t kMostNumbers = std::size_t{1} << 28, kSparePaths = 1024, kLongestPath = 4096;

  /// Throws Error for crates of an unknown version or with tables that are not well-formed.
  void readTables() {
    version_ = read<std::uint8_t>(8) * 10000 + read<std::uint8_t>(9) * 100 + read<std::uint8_t>(10);
    if (version_ < 400 || version_ >= 10000)
      throw Error(file_, "a crate file of version 0.4 or later", "another version");
    readSections();
    readTokens(), readStrings(), readFields(), readFieldSets(), readPaths();
  }
  struct Path {
    std::string text;
    bool isProperty = false, isKnown = false;
    std::size_t parent = 0;
    std::string name;
  };
  struct Field {
    std::size_t token;
    std::uint64_t value;
  };

  [[noreturn]] void fail(const std::string& expected) const { throw Error(where(), expected, "other data"); }
  std::string where() const { return file_ + ": byte " + std::to_string(at_); }

  template <class T> T read(std::size_t at) const {
    if (bytes_.size() < sizeof(T) || at > bytes_.size() - sizeof(T)) fail("more data");
    T out;
    std::memcpy(&out, bytes_.data() + at, sizeof(T));
    return out;
  }
  template <class T> T next() {
    const T out = read<T>(at_);
    at_ += sizeof(T);
    return out;
  }
  /// A number of elements of at least `each` bytes, of which so many can be there.
  std::size_t count(std::size_t each) {
    const auto n = next<std::uint64_t>();
    if (n > (bytes_.size() - at_) / std::max<std::size_t>(each, 1))
      fail("a number of elements that are there");
    return static_cast<std::size_t>(n);
  }
  std::string_view span(std::size_t size) {
    if (size > bytes_.size() - at_) fail("more data");
    const std::string_view out(bytes_.data() + at_, size);
    at_ += size;
    return out;
  }
  std::string_view packed() { return span(static_cast<std::size_t>(next<std::uint64_t>())); }
  std::vector<std::int64_t> integers(std::size_t n) { return unpackIntegers(packed(), n, false, where()); }
  /// The number of elements of a compressed table; it is checked where they are unpacked.
  std::size_t tableSize() {
    const auto n = next<std::uint64_t>();
    if (n > bytes_.size() * 255) fail("a number of elements that are there");
    return static_cast<std::size_t>(n);
  }

  void readSections() {
    at_ = static_cast<std::size_t>(read<std::int64_t>(16));
    const std::size_t n = count(32);
    for (std::size_t i = 0; i < n; ++i) {
      const std::string_view name = span(16);
      const auto start = next<std::int64_t>();
      next<std::int64_t>();
      sections_[std::string(name.substr(0, name.find('\0')))] = static_cast<std::size_t>(start);
    }
  }
  void section(const char* name) {
    const auto found = sections_.find(name);
    if (found == sections_.end() || found->second > bytes_.size())
      throw Error(file_, std::string("a section ") + name, "none");
    at_ = found->second;
  }

  void readTokens() {
    section("TOKENS");
    const std::size_t n = tableSize();
    const auto size = static_cast<std::size_t>(next<std::uint64_t>());
    if (size > kMostNumbers) fail("less text");
    const std::string text = unpackBytes(packed(), size, where());
    for (std::size_t begin = 0; begin < text.size() && tokens_.size() < n;) {
      const std::size_t end = std::min(text.find('\0', begin), text.size());
      tokens_.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
    if (tokens_.size() != n) fail(std::to_string(n) + " tokens");
  }
  void readStrings() {
    section("STRINGS");
    const std::size_t n = count(4);
    for (std::size_t i = 0; i < n; ++i) strings_.push_back(next<std::uint32_t>());
  }
  void readFields() {
    section("FIELDS");
    const std::size_t n = tableSize();
    const auto names = integers(n);
    const std::string values = unpackBytes(packed(), n * 8, where());
    if (values.size() != n * 8) fail("a value for each field");
    for (std::size_t i = 0; i < n; ++i) {
      Field field{static_cast<std::size_t>(names[i]), 0};
      std::memcpy(&field.value, values.data() + 8 * i, 8);
      fields_.push_back(field);
    }
  }
  void readFieldSets() {
    section("FIELDSETS");
    fieldSets_ = integers(tableSize());
  }

  const std::string& token(std::uint64_t i) const {
    if (i >= tokens_.size()) fail("the number of a token");
    return tokens_[static_cast<std::size_t>(i)];
  }
  const std::string& string(std::uint64_t i) const {
    if (i >= strings_.size()) fail("the number of a string");
    return token(strings_[static_cast<std::size_t>(i)]);
  }
  const std::string& path(std::uint64_t i) const {
    if (i >= paths_.size()) fail("the number of a path");
    return paths_[static_cast<std::size_t>(i)].text;
  }

  /// Depth first: a path, its children, its next sibling.
  void readPaths() {
    section("PATHS");
    const std::size_t all = tableSize(), n = tableSize();
    if (n > all || all > n + kSparePaths) fail("a path for each number");
    const auto numbers = integers(n), names = integers(n), jumps = integers(n);
    paths_.resize(all);
    std::vector<std::pair<std::size_t, std::size_t>> open;  // index of the next sibling, parent
    std::size_t at = 0, parent = 0;
    bool isRoot = true;
    std::vector<bool> seen(n, false);
    while (at < n) {
      if (seen[at]) fail("paths without a cycle");
      seen[at] = true;
      const auto number = static_cast<std::size_t>(numbers[at]);
      if (number >= all) fail("the number of a path");
      Path& own = paths_[number];
      own.isKnown = true;
      if (isRoot) {
        own.text = "/";
        isRoot = false;
      } else {
        own.isProperty = names[at] < 0;
        own.name = token(static_cast<std::uint64_t>(std::llabs(names[at])));
        own.parent = parent;
        const std::string& above = paths_[parent].text;
        if (above.size() > kLongestPath) fail("shorter paths");
        own.text = own.isProperty              ? above + "." + own.name
                   : own.name.starts_with("{") ? above + own.name
                   : above.ends_with("}")      ? above + own.name
                                               : joined(above, own.name);
      }
      const std::int64_t jump = jumps[at];
      const bool hasChild = jump > 0 || jump == -1, hasSibling = jump >= 0;
      if (hasSibling && hasChild) open.emplace_back(at + static_cast<std::size_t>(jump), parent);
      if (hasChild)
        parent = number, ++at;
      else if (hasSibling)
        ++at;
      else if (!open.empty())
        at = open.back().first, parent = open.back().second, open.pop_back();
      else
        break;
    }
  }

  const std::string& bytes_;
  const std::string& file_;
  std::size_t at_ = 0;
  int version_ = 0;
  std::map<std::string, std::size_t> sections_;
  std::vector<std::string> tokens_;
  std::vector<std::uint32_t> strings_;
  std::vector<Field> fields_;
  std::vector<std::int64_t> fieldSets_;
  std::vector<Path> paths_;
};

}  // namespace rubble::usd
