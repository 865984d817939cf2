#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

#include "platform/large_pages.h"

namespace rubble {

/// Zeroed memory, aligned to cache lines. Large blocks are zero pages of the operating system. Untouched
/// pages cost neither time nor memory, such as host copies of work arrays of the device.
struct HostMemory {
  static constexpr std::size_t kLine = 64;
  static void* allocate(std::size_t bytes) {
    void* const own = std::calloc(bytes + 2 * kLine, 1);
    if (!own) throw std::bad_alloc();
    platform::preferLargePages(own, bytes);
    // the pointer of calloc is stored before the first cache line that leaves room for it
    auto* const line = static_cast<std::byte*>(own) +
                       (2 * kLine - reinterpret_cast<std::uintptr_t>(own) % kLine);
    std::memcpy(line - sizeof own, &own, sizeof own);
    return line;
  }
  static void release(void* p) {
    if (!p) return;
    void* own;
    std::memcpy(&own, static_cast<std::byte*>(p) - sizeof own, sizeof own);
    std::free(own);
  }
  static void copy(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }
};

}  // namespace rubble
