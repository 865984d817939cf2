#pragma once
/// A file as a sequence of named chunks, each compressed and with checksums of its head and its content.
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "io/output_file.h"

namespace rubble::io {

using Bytes = std::vector<std::uint8_t>;

/// Four letters as a number, in the order of the file.
constexpr std::uint32_t chunkName(const char (&letters)[5]) {
  std::uint32_t name = 0;
  for (int i = 3; i >= 0; --i) name = name << 8 | static_cast<std::uint8_t>(letters[i]);
  return name;
}

struct Chunk {
  std::uint64_t offset = 0;  ///< of its head in the file
  std::uint32_t name = 0;
  Bytes content;  ///< decompressed
};

/// The content of a chunk is compressed in pieces of this size, each for itself, so that several threads or
/// processes may do it. What is stored is one piece after the other.
inline constexpr std::size_t kPieceBytes = 1u << 20;
constexpr std::size_t piecesOf(std::size_t contentSize) {
  return (contentSize + kPieceBytes - 1) / kPieceBytes;
}
/// Compresses pieces `begin` to `end` - 1 of a content, on the threads of the caller. Without zstd: nothing.
Bytes packPieces(const Bytes& content, std::size_t begin, std::size_t end);

/// Appends chunks. Each write reaches the file at once and survives a crash. Every call throws
/// Error if the file cannot be written; one that another ChunkWriter writes cannot be.
class ChunkWriter {
 public:
  explicit ChunkWriter(const std::string& file);

  /// Compresses and writes a chunk through to the system; returns its offset.
  std::uint64_t write(std::uint32_t name, const Bytes& content) {
    return write(name, content, packPieces(content, 0, piecesOf(content.size())));
  }
  /// The same of a content whose pieces have been packed. Where mayStore(content.size(), packed) the content
  /// itself does not matter.
  std::uint64_t write(std::uint32_t name, const Bytes& content, const Bytes& packed);
  static bool mayStore(std::size_t contentSize, const Bytes& packed) {
    return !packed.empty() && packed.size() < contentSize;
  }
  /// Writes bytes as they are.
  void writeRaw(const Bytes& bytes);

 private:
  void check();

  std::string file_;
  FileLock lock_;
  std::ofstream out_;
  std::uint64_t offset_ = 0;
};

/// Reads chunks. Every call throws Error, with the file and the byte, on data that were not written by a
/// ChunkWriter.
class ChunkReader {
 public:
  explicit ChunkReader(const std::string& file);

  std::uint64_t size() const { return size_; }
  /// The chunk at an offset; nothing if the file ends before the chunk does. `memory`: of a content that is
  /// not needed any more.
  std::optional<Chunk> read(std::uint64_t offset, Bytes memory = {});
  /// Name and end of the chunk at an offset, without its content; nothing if the file ends before the chunk
  /// does.
  struct Head {
    std::uint32_t name = 0;
    std::uint64_t end = 0;
  };
  std::optional<Head> head(std::uint64_t offset);
  /// `count` bytes at an offset, or fewer at the end of the file. `memory` as in read().
  Bytes readRaw(std::uint64_t offset, std::size_t count, Bytes memory = {});
  /// Throws Error about the byte at `offset`.
  [[noreturn]] void fail(std::uint64_t offset, const std::string& expected, const std::string& got) const;

 private:
  struct FullHead;
  std::optional<FullHead> fullHead(std::uint64_t offset);

  std::string file_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
  Bytes stored_;  ///< of the chunk that was read last; only its memory is used
};

}  // namespace rubble::io
