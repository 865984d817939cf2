#pragma once
/// Compression of crate files: LZ4 blocks in chunks, and integers as differences (OpenUSD,
/// fastCompression.cpp and integerCoding.cpp).
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rubble::usd {

/// Bytes of a block. Throws Error at `who` unless it is well-formed and has at most `most` bytes.
std::string unpackBytes(std::string_view packed, std::size_t most, const std::string& who);
/// `count` integers of 4 or 8 bytes. Throws Error at `who`.
std::vector<std::int64_t> unpackIntegers(std::string_view packed, std::size_t count, bool wide,
                                         const std::string& who);

}  // namespace rubble::usd
