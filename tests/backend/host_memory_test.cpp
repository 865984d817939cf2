#include "tables/host_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace rubble {
namespace {

TEST(HostMemory, IsZeroAndOnALineAlsoWhereItWasUsedBefore) {
  for (const std::size_t bytes :
       {std::size_t{0}, std::size_t{1}, std::size_t{100}, std::size_t{4096}, std::size_t{10} << 20})
    for (int again = 0; again < 3; ++again) {
      auto* const p = static_cast<unsigned char*>(HostMemory::allocate(bytes));
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p) % HostMemory::kLine, 0u) << bytes;
      EXPECT_EQ(std::count(p, p + bytes, 0), static_cast<std::ptrdiff_t>(bytes));
      std::fill_n(p, bytes, static_cast<unsigned char>(0xff));
      HostMemory::release(p);
    }
  HostMemory::release(nullptr);
}

}  // namespace
}  // namespace rubble
