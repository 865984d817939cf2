#include "io/mesh_bytes.h"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace rubble::io {

namespace {

constexpr const char* kSpace = " \t\r\n";

std::string quoted(std::string_view text) {
  constexpr std::size_t kMost = 40;
  return "\"" + std::string(text.substr(0, kMost)) + (text.size() > kMost ? "...\"" : "\"");
}

}  // namespace

MeshBytes::MeshBytes(const std::string& file) : file_(file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error(file, "a mesh file that can be read", "none");
  bytes_.assign(std::istreambuf_iterator<char>(in), {});
}

std::string_view MeshBytes::line() {
  if (atEnd()) fail("another line", "the end of the file");
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  std::string_view text(bytes_.data() + at_, end - at_);
  seek(end + 1);
  const auto from = text.find_first_not_of(kSpace);
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(kSpace) - from + 1);
}

std::optional<std::string_view> MeshBytes::nextLine() {
  while (!atEnd())
    if (const std::string_view text = line(); !text.empty()) return text;
  return std::nullopt;
}

std::string_view MeshBytes::word(const char* what) {
  const std::size_t from = bytes_.find_first_not_of(kSpace, at_);
  if (from == std::string::npos) {
    seek(bytes_.size());
    fail(what, "the end of the file");
  }
  seek(bytes_.find_first_of(kSpace, from));
  return std::string_view(bytes_).substr(from, at_ - from);
}

void MeshBytes::endLine() { seek(std::min(bytes_.find('\n', at_), bytes_.size()) + 1); }

double MeshBytes::toNumber(std::string_view text, const char* what) const {
  double value = 0;
  const auto plain = !text.empty() && text[0] == '+' ? text.substr(1) : text;
  const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  if (error != std::errc{} || end != plain.data() + plain.size() || !(value - value == 0))
    fail(what, quoted(text));
  return value;
}

long long MeshBytes::toWhole(std::string_view text, const char* what) const {
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) fail(what, quoted(text));
  return value;
}

std::size_t MeshBytes::count(long long number, std::size_t least, const char* what) const {
  if (number < 0 || static_cast<unsigned long long>(number) > bytes_.size() / least)
    fail(std::string(what) + " that the file has room for", std::to_string(number));
  return static_cast<std::size_t>(number);
}

void MeshBytes::fail(const std::string& expected, const std::string& got) const {
  // the line of the last byte that was read
  const auto read = bytes_.begin() + static_cast<std::ptrdiff_t>(at_ > 0 ? at_ - 1 : 0);
  throw Error(file_ + " line " + std::to_string(1 + std::count(bytes_.begin(), read, '\n')), expected, got);
}

void MeshBytes::failByte(const std::string& expected, const std::string& got) const {
  throw Error(file_ + " byte " + std::to_string(at_), expected, got);
}

}  // namespace rubble::io
