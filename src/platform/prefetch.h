#pragma once

namespace rubble {

/// Starts to load what a later step reads. It changes no result.
inline void prefetch([[maybe_unused]] const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#endif
}

}  // namespace rubble
