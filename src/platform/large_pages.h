#pragma once
/// Large pages for large blocks of memory.
#include <cstddef>
#include <new>

namespace rubble::platform {

/// Asks the system for large pages (2 MiB on many processors) in a block of 4 MiB and more, before it is used
/// for the first time: the first use of a page costs about as much whatever its size, and random accesses
/// miss the address cache less often. Has no effect where the system has none.
void preferLargePages(void* begin, std::size_t bytes) noexcept;

/// Allocator of lists that may be large.
template <class T> struct LargePageAllocator {
  using value_type = T;
  LargePageAllocator() = default;
  template <class U> LargePageAllocator(const LargePageAllocator<U>&) noexcept {}

  T* allocate(std::size_t count) {
    void* const block = ::operator new(count * sizeof(T), std::align_val_t(alignof(T)));
    preferLargePages(block, count * sizeof(T));
    return static_cast<T*>(block);
  }
  void deallocate(T* block, std::size_t) noexcept { ::operator delete(block, std::align_val_t(alignof(T))); }
  friend bool operator==(LargePageAllocator, LargePageAllocator) { return true; }
};

}  // namespace rubble::platform
