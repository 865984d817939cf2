#include "tables/host_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace rubble {
namespace {

void expectZeroLines(const HostMemory& memory) {
  for (const std::size_t bytes :
       {std::size_t{0}, std::size_t{1}, std::size_t{100}, std::size_t{4096}, std::size_t{10} << 20})
    for (int again = 0; again < 3; ++again) {
      auto* const p = static_cast<unsigned char*>(memory.allocate(bytes));
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p) % HostMemory::kLine, 0u) << bytes;
      EXPECT_EQ(std::count(p, p + bytes, 0), static_cast<std::ptrdiff_t>(bytes));
      std::fill_n(p, bytes, static_cast<unsigned char>(0xff));
      memory.release(p);
    }
  memory.release(nullptr);
}

TEST(HostMemory, IsZeroAndOnALineAlsoWhereItWasUsedBefore) { expectZeroLines(HostMemory()); }

TEST(HostMemory, OfAHostIsZeroAndOnALineAndGoesBackWithItsSize) {
  std::size_t held = 0;
  MemorySystem host;
  host.allocate = [&](std::size_t bytes) {
    held += bytes;
    void* const block = std::malloc(bytes);
    std::memset(block, 0xff, bytes);
    return block;
  };
  host.release = [&](void* block, std::size_t bytes) { held -= bytes, std::free(block); };
  expectZeroLines(HostMemory(host));
  EXPECT_EQ(held, 0u);

  host.allocate = [](std::size_t) -> void* { return nullptr; };
  EXPECT_THROW((void)HostMemory(host).allocate(1), std::bad_alloc);
}

}  // namespace
}  // namespace rubble
