#pragma once
/// RUBBLE_HAS_SANITIZER: built with the sanitizer of addresses or of threads.
/// RUBBLE_HAS_THREAD_SANITIZER: built with that of threads.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define RUBBLE_HAS_SANITIZER 1
#elif __has_feature(thread_sanitizer)
#define RUBBLE_HAS_THREAD_SANITIZER 1
#endif
#endif
#if defined(__SANITIZE_THREAD__)
#define RUBBLE_HAS_THREAD_SANITIZER 1
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(RUBBLE_HAS_THREAD_SANITIZER)
#define RUBBLE_HAS_SANITIZER 1
#endif
