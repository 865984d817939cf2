#pragma once
#include <cstddef>
#include <functional>

namespace rubble {

/// An allocator of the host for the tables of a world, in place of that of the library. Results do not depend
/// on it. Its functions may be called on any thread of the world; for `Worlds`, on several at once.
struct MemorySystem {
  /// Returns a block of that many bytes, aligned as those of malloc(), or null where memory ends. Its content
  /// does not matter. Empty: the library allocates.
  std::function<void*(std::size_t bytes)> allocate = {};
  /// Takes back a block, with the size that was asked for. Does not throw.
  std::function<void(void* block, std::size_t bytes)> release = {};
};

}  // namespace rubble
