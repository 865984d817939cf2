#pragma once
/// The bytes of a mesh file, as lines of words or as numbers of a byte order, with faults that say where.
#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include <rubble/error.h>

namespace rubble::io {

class MeshBytes {
 public:
  /// Throws Error if the file cannot be read.
  explicit MeshBytes(const std::string& file);
  /// The content of a file of that name.
  MeshBytes(std::string file, std::string content) : file_(std::move(file)), bytes_(std::move(content)) {}

  const std::string& file() const { return file_; }
  bool atEnd() const { return left() == 0; }
  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  std::string_view all() const { return bytes_; }
  /// Sets the position of the next read, at most the end of the file.
  void seek(std::size_t at) { at_ = std::min(at, bytes_.size()); }

  /// The next line without its end and without spaces around it. Throws Error at the end of the file.
  std::string_view line();
  /// The next line that is not empty, or nothing.
  std::optional<std::string_view> nextLine();
  /// The next word, over ends of lines. Throws Error at the end of the file.
  std::string_view word(const char* what);
  /// Behind the end of the line that the last word was in.
  void endLine();

  double number(const char* what) { return toNumber(word(what), what); }
  long long whole(const char* what) { return toWhole(word(what), what); }
  double toNumber(std::string_view text, const char* what) const;
  long long toWhole(std::string_view text, const char* what) const;

  /// A number of the machine's size, with its bytes turned around if `swap`.
  template <class T> T binary(bool swap, const char* what) {
    if (left() < sizeof(T)) failByte(what, "the end of the file");
    T value;
    if (swap) {
      char turned[sizeof(T)];
      for (std::size_t k = 0; k < sizeof(T); ++k) turned[k] = bytes_[at_ + sizeof(T) - 1 - k];
      std::memcpy(&value, turned, sizeof(T));
    } else {
      std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    }
    seek(at_ + sizeof(T));
    return value;
  }

  /// A count from the file: at least 0, and no more than its bytes can hold at `least` bytes each.
  std::size_t count(long long number, std::size_t least, const char* what) const;

  [[noreturn]] void fail(const std::string& expected, const std::string& got) const;      ///< names the line
  [[noreturn]] void failByte(const std::string& expected, const std::string& got) const;  ///< names the byte

 private:
  std::string file_, bytes_;
  std::size_t at_ = 0;  ///< at most the number of bytes: seek() alone changes it
};

/// Words of a line, one after the other.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}
  std::optional<std::string_view> next() {
    const auto begin = rest_.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return std::nullopt;
    const auto end = std::min(rest_.find_first_of(" \t\r", begin), rest_.size());
    const std::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return word;
  }

 private:
  std::string_view rest_;
};

}  // namespace rubble::io
