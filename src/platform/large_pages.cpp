#include "platform/large_pages.h"

#if defined(__linux__)
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#endif

namespace rubble::platform {

#if defined(__linux__)
void preferLargePages(void* memory, std::size_t bytes) {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t begin = (reinterpret_cast<std::uintptr_t>(memory) + page - 1) / page * page,
                       end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / page * page;
  // a refusal leaves the pages as they are
  if (begin < end) static_cast<void>(madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE));
}
#else
void preferLargePages(void*, std::size_t) {}
#endif

}  // namespace rubble::platform
