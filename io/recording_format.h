#pragma once
/// What the chunks of a trajectory file hold. The decoders give nothing for bytes that no encoder makes.
#include <array>
#include <optional>

#include "io/chunk_file.h"
#include "io/recording.h"

namespace rubble::io {

/// Version 1 had no deformable objects.
inline constexpr std::uint32_t kVersion = 2, kOldestVersion = 1;
inline constexpr std::uint32_t kHead = chunkName("HEAD");
inline constexpr std::uint32_t kLook = chunkName("LOOK");
inline constexpr std::uint32_t kBody = chunkName("BODY");
inline constexpr std::uint32_t kFrames = chunkName("FRAM");
inline constexpr std::uint32_t kIndex = chunkName("INDX");
/// Begin and end of every file.
inline constexpr std::array<std::uint8_t, 8> kMagic{'R', 'U', 'B', 'B', 'L', 'E', '\r', '\n'};
inline constexpr std::size_t kFooterSize = 16;

/// Where a chunk of frames is, and what it needs.
struct FrameChunk {
  std::uint64_t offset = 0, bodyOffset = 0;
  std::int32_t frameCount = 0;
};

Bytes magicBytes();
Bytes encodeHeader(const RecordingHeader& header);
/// Returns the version that the bytes say; the header is read only if that is kOldestVersion to kVersion.
std::uint32_t decodeHeader(const Bytes& content, std::optional<RecordingHeader>& header);
/// The tables of a BODY chunk.
struct RecordedObjects {
  std::vector<RecordedBody> bodies;
  std::vector<RecordedSoft> softs;

  std::size_t vertexCount() const;
};
Bytes encodeObjects(const RecordedObjects& objects);
std::optional<RecordedObjects> decodeObjects(const Bytes& content, std::uint32_t version);
Bytes encodeIndex(const std::vector<FrameChunk>& chunks);
std::optional<std::vector<FrameChunk>> decodeIndex(const Bytes& content);

}  // namespace rubble::io
