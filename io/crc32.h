#pragma once
#include <cstddef>
#include <cstdint>

namespace rubble::io {

/// Checksum of ISO 3309, as in PNG and ZIP, of bytes that follow those with checksum `before`.
std::uint32_t crc32(const void* bytes, std::size_t count, std::uint32_t before = 0);

}  // namespace rubble::io
