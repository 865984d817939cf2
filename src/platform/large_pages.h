#pragma once
#include <cstddef>

namespace rubble::platform {

/// Asks the system for large pages behind memory that is accessed at random. It changes no content, and
/// nothing where a system has none.
void preferLargePages(void* memory, std::size_t bytes);

}  // namespace rubble::platform
