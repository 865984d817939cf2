/// Trajectories whose chunks have right checksums and any content. The input is a list of chunks and an index
/// of them, see Forged.
#include <algorithm>
#include <fstream>

#include <rubble/rubble.h>

#include <rubble/mesh.h>
#include "io/byte_stream.h"
#include "io/recording.h"
#include "io/recording_format.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/scratch_file.h"
#include "tests/fuzz/target.h"

namespace rubble::fuzz {
namespace {

using namespace io;

constexpr std::uint32_t kNames[] = {kHead, kBody, kFrames, kIndex};
constexpr std::size_t kMostFrames = 64, kMostTriangles = 20000;

/// Chunks, each a byte for its name, two for its size, and its content; a name of kEnd ends them. What
/// follows is the index: three bytes for each entry (chunk of frames, chunk of bodies, count), or, with
/// kRawIndex, its content.
class Forged {
 public:
  static constexpr int kEnd = 4, kRawIndex = 5, kNoIndex = 6;

  explicit Forged(ByteSource in) {
    int name = in.below(7);
    for (; name < kEnd && !in.atEnd(); name = in.below(7)) {
      const std::size_t low = in.byte(), size = low + 256 * std::size_t{in.byte()};
      const std::string content = in.text(size);
      chunks_.push_back({kNames[name], {content.begin(), content.end()}});
    }
    hasIndex_ = name != kNoIndex;
    if (name == kRawIndex) {
      const std::string content = in.rest();
      rawIndex_ = Bytes(content.begin(), content.end());
    }
    while (!in.atEnd()) {
      const std::size_t frames = in.byte(), bodies = in.byte();
      entries_.push_back({frames, bodies, in.byte()});
    }
  }

  void write(const std::string& file) const {
    ChunkWriter out(file);
    out.writeRaw(magicBytes());
    std::vector<std::uint64_t> offsets{0};
    for (const auto& [name, content] : chunks_) offsets.push_back(out.write(name, content));
    if (!hasIndex_) return;
    std::vector<FrameChunk> index;
    for (const Entry& e : entries_)
      index.push_back({offsets[e.frames % offsets.size()], offsets[e.bodies % offsets.size()], e.count});
    ByteWriter footer;
    footer.put(out.write(kIndex, rawIndex_.empty() ? encodeIndex(index) : rawIndex_));
    out.writeRaw(footer.bytes());
    out.writeRaw(magicBytes());
  }

 private:
  struct Entry {
    std::size_t frames, bodies;
    std::int32_t count;
  };
  std::vector<std::pair<std::uint32_t, Bytes>> chunks_;
  std::vector<Entry> entries_;
  Bytes rawIndex_;
  bool hasIndex_ = false;
};

void readAll(const std::string& file) {
  RecordingReader reader(file);
  const int frames = std::min(reader.frameCount(), static_cast<int>(kMostFrames));
  const std::vector<int> changes = reader.changes();
  for (int i = 0; i < frames; ++i) {
    const RecordedFrame frame = reader.frame(i);
    expect(frame.poses.size() == reader.bodies(i).size(), "a frame has another number of poses than bodies");
    std::size_t vertices = 0;
    for (const RecordedSoft& soft : reader.softs(i)) vertices += static_cast<std::size_t>(soft.vertices);
    expect(frame.vertices.size() == vertices, "a frame has another number of vertices than its objects");
    const std::vector<PictureBody> pictures = pictureBodies(reader, i);
    if (!std::ranges::binary_search(changes, i)) continue;
    recordingResolution(reader.bodies(i), reader.softs(i));
    for (const PictureBody& body : pictures) {
      const auto& geometry = body.shape.geometry;
      if (!geometry || geometry->samples.size() < kMostTriangles) shapeMesh(body.shape, 4);
    }
  }
  if (frames > 0) frameAfter(reader, reader.frame(frames - 1).step);
}

/// What is read.
const std::string& scratchFile() {
  static const ScratchFile scratch(".rubble");
  return scratch.path;
}

}  // namespace

void testInput(std::span<const std::uint8_t> bytes) {
  // a file as it is, or forged chunks
  if (bytes.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
    std::ofstream(scratchFile(), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  } else {
    Forged{ByteSource(bytes)}.write(scratchFile());
  }
  try {
    readAll(scratchFile());
  } catch (const Error&) {
  }
}

}  // namespace rubble::fuzz
