#pragma once
/// RUBBLE_HAS_SANITIZER: built with the sanitizer of addresses or of threads.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RUBBLE_HAS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RUBBLE_HAS_SANITIZER 1
#endif
#endif
