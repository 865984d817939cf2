#include "io/chunk_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <new>

#if defined(RUBBLE_HAS_ZSTD)
#include <zstd.h>
#endif

#include <rubble/error.h>

#include "io/byte_stream.h"
#include "io/crc32.h"
#include "platform/threads.h"

namespace rubble::io {
namespace {

/// How the content of a chunk is stored.
enum class Codec : std::uint32_t { None = 0, Zstd = 1 };

/// name, codec, stored size, content size, checksum of what is stored, checksum of these five.
constexpr std::size_t kHeadSize = 24;
/// No chunk is larger; a size beyond is a sign of damage.
constexpr std::uint32_t kLargestContent = 1u << 30;

#if defined(RUBBLE_HAS_ZSTD)
/// Fast enough to keep up with a run; higher levels gain little on trajectories.
constexpr int kLevel = 3;

/// Writes a piece to memory of at least ZSTD_compressBound() bytes; returns its size.
std::size_t compress(const std::uint8_t* piece, std::size_t size, std::uint8_t* to, std::size_t room) {
  const std::size_t stored = ZSTD_compress(to, room, piece, size, kLevel);
  // with so much room there is no other reason
  if (ZSTD_isError(stored)) throw std::bad_alloc();
  return stored;
}

/// An explanation of what is wrong, or "".
std::string decompress(const Bytes& stored, Bytes& content) {
  const std::size_t size = ZSTD_decompress(content.data(), content.size(), stored.data(), stored.size());
  if (ZSTD_isError(size)) return ZSTD_getErrorName(size);
  return size == content.size() ? "" : std::to_string(size) + " bytes";
}
#else
std::string decompress(const Bytes&, Bytes&) {
  return "a compressed chunk, which this build (without zstd) cannot read";
}
#endif

}  // namespace

#if defined(RUBBLE_HAS_ZSTD)
Bytes packPieces(const Bytes& content, std::size_t begin, std::size_t end) {
  const std::size_t room = ZSTD_compressBound(std::min(kPieceBytes, content.size()));
  Bytes packed((end - begin) * room);
  std::vector<std::size_t> sizes(end - begin);
  forEachTask(end - begin, [&](std::size_t k) {
    const std::size_t at = (begin + k) * kPieceBytes;
    sizes[k] = compress(content.data() + at, std::min(kPieceBytes, content.size() - at),
                        packed.data() + k * room, room);
  });
  std::size_t to = 0;
  for (std::size_t k = 0; k < sizes.size(); to += sizes[k++])
    std::memmove(packed.data() + to, packed.data() + k * room, sizes[k]);
  packed.resize(to);
  return packed;
}
#else
Bytes packPieces(const Bytes&, std::size_t, std::size_t) { return {}; }
#endif

ChunkWriter::ChunkWriter(const std::string& file)
    : file_(file), lock_(file), out_(file, std::ios::binary | std::ios::trunc) {
  if (!out_) throw Error(file_, "a file that can be written", std::strerror(errno));
}

void ChunkWriter::check() {
  if (out_.flush()) return;
  const std::string reason = std::strerror(errno);
  // a stream writes at its end what it could not write before
  out_.close();
  std::error_code none;
  std::filesystem::resize_file(file_, offset_, none);
  throw Error(file_, "to be written in full", reason);
}

void ChunkWriter::writeRaw(const Bytes& bytes) {
  out_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  check();
  offset_ += bytes.size();
}

std::uint64_t ChunkWriter::write(std::uint32_t name, const Bytes& content, const Bytes& packed) {
  if (content.size() > kLargestContent)
    throw Error(file_, "chunks of at most 1 GiB", std::to_string(content.size()) + " bytes");
  const bool packs = mayStore(content.size(), packed);
  const Codec codec = packs ? Codec::Zstd : Codec::None;
  const Bytes& stored = packs ? packed : content;
  ByteWriter head;
  head.put(name);
  head.put(static_cast<std::uint32_t>(codec));
  head.put(static_cast<std::uint32_t>(stored.size()));
  head.put(static_cast<std::uint32_t>(content.size()));
  head.put(crc32(stored.data(), stored.size()));
  head.put(crc32(head.bytes().data(), head.bytes().size()));
  const std::uint64_t offset = offset_;
  out_.write(reinterpret_cast<const char*>(head.bytes().data()), static_cast<std::streamsize>(kHeadSize));
  out_.write(reinterpret_cast<const char*>(stored.data()), static_cast<std::streamsize>(stored.size()));
  check();
  offset_ += kHeadSize + stored.size();
  return offset;
}

struct ChunkReader::FullHead {
  std::uint32_t name = 0;
  Codec codec = Codec::None;
  std::uint32_t storedSize = 0, contentSize = 0, checksum = 0;
};

ChunkReader::ChunkReader(const std::string& file) : file_(file), in_(file, std::ios::binary | std::ios::ate) {
  const std::streamoff end = in_ ? static_cast<std::streamoff>(in_.tellg()) : -1;
  if (end < 0) throw Error(file_, "a file that can be read", "none");
  size_ = static_cast<std::uint64_t>(end);
}

void ChunkReader::fail(std::uint64_t offset, const std::string& expected, const std::string& got) const {
  throw Error(file_ + " at byte " + std::to_string(offset), expected, got);
}

Bytes ChunkReader::readRaw(std::uint64_t offset, std::size_t count, Bytes memory) {
  Bytes bytes = std::move(memory);
  bytes.resize(offset < size_ ? static_cast<std::size_t>(std::min<std::uint64_t>(count, size_ - offset)) : 0);
  if (bytes.empty()) return bytes;
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(offset));
  in_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in_) fail(offset, std::to_string(bytes.size()) + " bytes", "a read error");
  return bytes;
}

std::optional<ChunkReader::FullHead> ChunkReader::fullHead(std::uint64_t offset) {
  const Bytes bytes = readRaw(offset, kHeadSize);
  if (bytes.size() < kHeadSize) return std::nullopt;
  ByteReader in(bytes);
  FullHead head;
  head.name = in.get<std::uint32_t>();
  head.codec = static_cast<Codec>(in.get<std::uint32_t>());
  head.storedSize = in.get<std::uint32_t>();
  head.contentSize = in.get<std::uint32_t>();
  head.checksum = in.get<std::uint32_t>();
  if (in.get<std::uint32_t>() != crc32(bytes.data(), kHeadSize - 4))
    fail(offset, "the head of a chunk", "a wrong checksum");
  const bool known = head.codec == Codec::Zstd ||
                     (head.codec == Codec::None && head.storedSize == head.contentSize);
  if (!known || head.contentSize > kLargestContent)
    fail(offset, "a known codec and a size of at most 1 GiB", "another");
  if (offset + kHeadSize + head.storedSize > size_) return std::nullopt;
  return head;
}

std::optional<ChunkReader::Head> ChunkReader::head(std::uint64_t offset) {
  const auto full = fullHead(offset);
  if (!full) return std::nullopt;
  return Head{full->name, offset + kHeadSize + full->storedSize};
}

std::optional<Chunk> ChunkReader::read(std::uint64_t offset, Bytes memory) {
  const auto head = fullHead(offset);
  if (!head) return std::nullopt;
  Bytes stored = readRaw(offset + kHeadSize, head->storedSize, std::move(stored_));
  if (crc32(stored.data(), stored.size()) != head->checksum)
    fail(offset + kHeadSize, "the content of a chunk", "a wrong checksum");
  Chunk chunk{offset, head->name, std::move(memory)};
  if (head->codec == Codec::None) {
    chunk.content = std::move(stored);
    return chunk;
  }
  chunk.content.resize(head->contentSize);
  const std::string wrong = decompress(stored, chunk.content);
  if (!wrong.empty())
    fail(offset + kHeadSize, std::to_string(head->contentSize) + " bytes of content", wrong);
  stored_ = std::move(stored);
  return chunk;
}

}  // namespace rubble::io
