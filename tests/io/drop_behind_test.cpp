#include "platform/drop_behind.h"

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "tests/support/files.h"

namespace rubble::platform {
namespace {

/// Longer than what it leaves in the cache.
TEST(DropBehind, LeavesTheContentOfAFileAsItWasWritten) {
  constexpr std::size_t kBlocks = 160, kBlock = 1u << 20;
  const auto blockOf = [](std::size_t number) {
    return std::vector<char>(kBlock, static_cast<char>(number));
  };
  const test::TemporaryFile file(".bin");
  {
    std::ofstream out(file.path, std::ios::binary);
    DropBehind behind(file.path);
    for (std::size_t k = 0; k < kBlocks; ++k) {
      const std::vector<char> block = blockOf(k);
      out.write(block.data(), static_cast<std::streamsize>(kBlock));
      behind.written((k + 1) * kBlock);
    }
  }
  std::ifstream in(file.path, std::ios::binary);
  std::vector<char> block(kBlock);
  for (std::size_t k = 0; k < kBlocks; ++k) {
    in.read(block.data(), static_cast<std::streamsize>(kBlock));
    ASSERT_TRUE(in) << k;
    ASSERT_TRUE(block == blockOf(k)) << k;
  }
}

}  // namespace
}  // namespace rubble::platform
