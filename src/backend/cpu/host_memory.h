#pragma once
#include <cstdlib>
#include <cstring>
#include <new>

namespace rubble {

/// Zeroed memory on cache lines.
struct HostMemory {
  static void* allocate(std::size_t bytes) {
    constexpr std::size_t kLine = 64;
    const std::size_t rounded = (bytes + kLine - 1) / kLine * kLine;
    void* const p = std::aligned_alloc(kLine, rounded ? rounded : kLine);
    if (!p) throw std::bad_alloc();
    std::memset(p, 0, rounded);
    return p;
  }
  static void release(void* p) { std::free(p); }
  static void copy(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }
};

}  // namespace rubble
