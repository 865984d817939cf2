#include "tests/backend/counted_memory.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>

#include "tests/support/sanitizer.h"

namespace {

std::atomic<long> count{0};
constexpr long kNever = std::numeric_limits<long>::max();
thread_local long failsAfter = kNever;
thread_local bool lasts = false, failed = false;
/// Of all threads but the one that asked for it.
std::atomic<long> othersFailAfter{kNever};
std::atomic<bool> othersLast{false}, othersFailed{false};
thread_local bool isSpared = false;

}  // namespace

// The sanitizer of threads has operators of its own in every program.
#if !defined(RUBBLE_HAS_THREAD_SANITIZER)
namespace {

/// Counts an allocation. Does it fail?
bool fails() noexcept {
  ++count;
  if (!isSpared && othersFailAfter != kNever) {
    const long left = othersFailAfter.fetch_sub(1);
    if (left > 0 || (left < 0 && !othersLast)) return false;
    return othersFailed = true;
  }
  if (failsAfter == kNever) return false;
  if (failsAfter > 0) return --failsAfter, false;
  if (!lasts) failsAfter = kNever;
  failed = true;
  return true;
}

void* countedOrNull(std::size_t bytes, std::size_t alignment) noexcept {
  if (fails()) return nullptr;
  const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
  return std::aligned_alloc(alignment, rounded ? rounded : alignment);
}
void* counted(std::size_t bytes, std::size_t alignment) {
  if (void* p = countedOrNull(bytes, alignment)) return p;
  throw std::bad_alloc();
}
}  // namespace

// Not inlined: a compiler that saw both sides would take free() for a mismatch of the new above it.
#define RUBBLE_NOINLINE __attribute__((noinline))
RUBBLE_NOINLINE void* operator new(std::size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
RUBBLE_NOINLINE void* operator new[](std::size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
RUBBLE_NOINLINE void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return countedOrNull(bytes, alignof(std::max_align_t));
}
RUBBLE_NOINLINE void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return countedOrNull(bytes, alignof(std::max_align_t));
}
RUBBLE_NOINLINE void* operator new(std::size_t bytes, std::align_val_t a) {
  return counted(bytes, static_cast<std::size_t>(a));
}
RUBBLE_NOINLINE void* operator new[](std::size_t bytes, std::align_val_t a) {
  return counted(bytes, static_cast<std::size_t>(a));
}
RUBBLE_NOINLINE void operator delete(void* p) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete[](void* p) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete(void* p, std::size_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
RUBBLE_NOINLINE void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

// A sanitizer gives and takes memory of its own only.
#if defined(__GLIBC__) && !defined(RUBBLE_HAS_SANITIZER)
// Tables come from calloc.
extern "C" void* __libc_calloc(std::size_t, std::size_t);
extern "C" __attribute__((visibility("default"))) void* calloc(std::size_t number,
                                                               std::size_t size) noexcept {
  return fails() ? nullptr : __libc_calloc(number, size);
}
#endif
#endif

namespace rubble::test {

#if defined(RUBBLE_HAS_THREAD_SANITIZER)
bool countsAllocations() { return false; }
#else
bool countsAllocations() { return true; }
#endif
long allocations() { return count; }

FailingMemory::FailingMemory(long first, bool lasting) {
  failsAfter = first, lasts = lasting, failed = false;
}
FailingMemory::~FailingMemory() { failsAfter = kNever; }
bool FailingMemory::hasFailed() const { return failed; }

FailingMemoryOfOthers::FailingMemoryOfOthers(long first, bool lasting) {
  isSpared = true;
  othersFailed = false, othersLast = lasting, othersFailAfter = first;
}
FailingMemoryOfOthers::~FailingMemoryOfOthers() { othersFailAfter = kNever, isSpared = false; }
bool FailingMemoryOfOthers::hasFailed() const { return othersFailed; }

}  // namespace rubble::test
