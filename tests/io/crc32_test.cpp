/// The checksum of recordings and of ZIP files.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/crc32.h"
#include "tests/support/random.h"

namespace rubble::io {
namespace {

TEST(Crc32, IsThatOfTheStandard) {
  const std::string digits = "123456789";
  EXPECT_EQ(crc32(digits.data(), digits.size()), 0xcbf43926u);
  EXPECT_EQ(crc32(nullptr, 0), 0u);
}

/// Against division bit by bit, and in any two parts.
TEST(Crc32, OfPartsIsThatOfTheWhole) {
  test::Random random(1);
  for (std::size_t size = 0; size < 100; ++size) {
    std::vector<std::uint8_t> bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    std::uint32_t rest = 0xffffffffu;
    for (const std::uint8_t byte : bytes) {
      rest ^= byte;
      for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ ((rest & 1) != 0 ? 0xedb88320u : 0u);
    }
    EXPECT_EQ(crc32(bytes.data(), size), ~rest);
    const auto cut = static_cast<std::size_t>(random.below(static_cast<int>(size) + 1));
    EXPECT_EQ(crc32(bytes.data() + cut, size - cut, crc32(bytes.data(), cut)), ~rest);
  }
}

}  // namespace
}  // namespace rubble::io
