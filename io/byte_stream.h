#pragma once
/// Numbers to bytes and back, low byte first on every machine.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace rubble::io {

class ByteWriter {
 public:
  template <class T>
  requires std::is_integral_v<T>
  void put(T value) {
    const auto bits = static_cast<std::make_unsigned_t<T>>(value);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_[at + i] = static_cast<std::uint8_t>(bits >> (8 * i));
  }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    const std::size_t at = bytes_.size();
    bytes_.resize(at + text.size());
    std::ranges::copy(text, bytes_.begin() + static_cast<std::ptrdiff_t>(at));
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Never reads beyond the end: missing bytes read as zero and clear ok().
class ByteReader {
 public:
  explicit ByteReader(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  template <class T>
  requires std::is_integral_v<T> T get() {
    std::make_unsigned_t<T> bits = 0;
    if (!has(sizeof(T))) return 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bits = static_cast<std::make_unsigned_t<T>>(bits | static_cast<std::make_unsigned_t<T>>(bytes_[at_ + i])
                                                             << (8 * i));
    at_ += sizeof(T);
    return static_cast<T>(bits);
  }
  double getDouble() { return std::bit_cast<double>(get<std::uint64_t>()); }
  std::string getText() {
    const auto size = get<std::uint32_t>();
    if (!has(size)) return "";
    const std::string text(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                           bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + size));
    at_ += size;
    return text;
  }
  std::size_t left() const { return bytes_.size() - at_; }
  /// False after a read beyond the end.
  bool ok() const { return ok_; }
  bool atEnd() const { return ok_ && left() == 0; }

 private:
  bool has(std::size_t count) {
    ok_ = ok_ && count <= left();
    return ok_;
  }

  const std::vector<std::uint8_t>& bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace rubble::io
