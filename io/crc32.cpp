#include "io/crc32.h"

#include <array>

namespace rubble::io {
namespace {

constexpr std::size_t kSlices = 16;
using Table = std::array<std::uint32_t, 256>;

/// [k][byte]: remainder of a byte that k zeros follow, lowest bit first.
constexpr std::array<Table, kSlices> kRemainders = [] {
  std::array<Table, kSlices> out{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t rest = byte;
    for (int bit = 0; bit < 8; ++bit) rest = rest >> 1 ^ (rest & 1 ? 0xedb88320u : 0);
    out[0][byte] = rest;
  }
  for (std::size_t k = 1; k < kSlices; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      out[k][byte] = out[k - 1][byte] >> 8 ^ out[0][out[k - 1][byte] & 255];
  return out;
}();

}  // namespace

std::uint32_t crc32(const void* bytes, std::size_t count, std::uint32_t before) {
  const auto* at = static_cast<const std::uint8_t*>(bytes);
  std::uint32_t rest = ~before;
  for (; count >= kSlices; at += kSlices, count -= kSlices) {
    std::uint32_t next = 0;
    for (std::size_t k = 0; k < kSlices; ++k) {
      const std::uint32_t byte = k < 4 ? at[k] ^ (rest >> (8 * k) & 255) : at[k];
      next ^= kRemainders[kSlices - 1 - k][byte];
    }
    rest = next;
  }
  for (; count > 0; ++at, --count) rest = rest >> 8 ^ kRemainders[0][(rest ^ *at) & 255];
  return ~rest;
}

}  // namespace rubble::io
