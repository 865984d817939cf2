/// The entry of libFuzzer, and how it watches memory.
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" const char* __asan_default_options();

bool rubble::fuzz::isReplay() { return false; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rubble::fuzz::testInput({data, size});
  return 0;
}

/// An input frees far less than 16 MB, so all of it stays poisoned. Stacks of allocations have four frames.
extern "C" const char* __asan_default_options() { return "quarantine_size_mb=16:malloc_context_size=4"; }
