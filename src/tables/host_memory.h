#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

#include <rubble/memory.h>

#include "platform/large_pages.h"

namespace rubble {

/// Zeroed memory, aligned to cache lines, of the host or of the library. Large blocks of the library are zero
/// pages of the operating system. Untouched pages cost neither time nor memory, such as host copies of work
/// arrays of the device.
class HostMemory {
 public:
  static constexpr std::size_t kLine = 64;

  HostMemory() = default;
  explicit HostMemory(const MemorySystem& host)
      : host_(host.allocate ? std::make_shared<const MemorySystem>(host) : nullptr) {}

  void* allocate(std::size_t bytes) const {
    const Block block{host_ ? host_->allocate(bytes + kRoom) : std::calloc(bytes + kRoom, 1), bytes + kRoom};
    if (!block.begin) throw std::bad_alloc();
    if (host_)
      std::memset(block.begin, 0, block.bytes);
    else
      platform::preferLargePages(block.begin, bytes);
    // the block is stored before the first cache line that leaves room for it
    auto* const line = static_cast<std::byte*>(block.begin) +
                       (kRoom - reinterpret_cast<std::uintptr_t>(block.begin) % kLine);
    std::memcpy(line - sizeof block, &block, sizeof block);
    return line;
  }
  void release(void* p) const {
    if (!p) return;
    Block block;
    std::memcpy(&block, static_cast<std::byte*>(p) - sizeof block, sizeof block);
    if (host_)
      host_->release(block.begin, block.bytes);
    else
      std::free(block.begin);
  }
  static void copy(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }

 private:
  struct Block {
    void* begin;
    std::size_t bytes;
  };
  static constexpr std::size_t kRoom = 2 * kLine;
  static_assert(sizeof(Block) <= kLine);

  std::shared_ptr<const MemorySystem> host_;  ///< null: of the library
};

}  // namespace rubble
