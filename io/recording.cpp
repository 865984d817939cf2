#include "io/recording.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "io/appearance_json.h"
#include "io/byte_stream.h"
#include "io/frame_codec.h"
#include "io/recording_format.h"
#include "io/shape_json.h"

namespace rubble::io {

bool operator==(const RecordedBody& a, const RecordedBody& b) {
  return a.id == b.id && a.motion == b.motion && a.name == b.name && a.shape.type == b.shape.type &&
         a.shape.halfExtents == b.shape.halfExtents && a.shape.radius == b.shape.radius &&
         a.shape.halfLength == b.shape.halfLength && a.shape.rounding == b.shape.rounding &&
         (a.shape.geometry == b.shape.geometry ||
          (a.shape.geometry && b.shape.geometry && shapeJson(a.shape) == shapeJson(b.shape)));
}

double recordingResolution(const std::vector<RecordedBody>& bodies, const std::vector<RecordedSoft>& softs) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const RecordedBody& body : bodies) {
    const Vec3& h = body.shape.halfExtents;
    if (body.shape.type == ShapeType::Box) smallest = std::min({smallest, h.x, h.y, h.z});
    if (body.shape.type == ShapeType::Sphere || body.shape.type == ShapeType::Capsule)
      smallest = std::min(smallest, body.shape.radius);
    if (body.shape.type > ShapeType::Plane) smallest = std::min(smallest, .1 * boundingRadius(body.shape));
  }
  constexpr double kOfRadius = 256;
  for (const RecordedSoft& soft : softs)
    if (soft.radius > 0) smallest = std::min(smallest, kOfRadius * soft.radius);
  return std::isfinite(smallest) ? std::ldexp(smallest, -16) : RecordingHeader{}.resolution;
}

struct RecordingReader::Impl {
  ChunkReader in;
  RecordingHeader header;
  std::vector<FrameChunk> chunks;
  std::vector<int> firstFrames;  ///< of each chunk
  int frameCount = 0;
  bool complete = false;
  std::uint64_t intact = 0;  ///< end of the last chunk of a file without an index, or of the file
  // What was read last: a chunk of frames by its place in `chunks`, the bodies by the offset of theirs.
  std::optional<std::size_t> framesOf;
  std::optional<std::uint64_t> bodiesOffset;
  FrameDecoder frames;
  RecordedObjects objects;
  std::uint32_t version = kVersion;

  explicit Impl(const std::string& file) : in(file) {
    const std::uint64_t first = readHeader();
    if (const auto offset = indexOffset()) {
      readIndex(*offset);
    } else {
      walk(first);
    }
    for (const FrameChunk& chunk : chunks) {
      firstFrames.push_back(frameCount);
      if (chunk.frameCount > std::numeric_limits<int>::max() - frameCount)
        in.fail(chunk.offset, "fewer than 2^31 frames", "more");
      frameCount += chunk.frameCount;
    }
  }

  Chunk need(std::uint64_t offset, std::uint32_t name, const std::string& what, Bytes memory = {}) {
    std::optional<Chunk> chunk = in.read(offset, std::move(memory));
    if (!chunk) in.fail(offset, what, "the end of the file");
    if (chunk->name != name) in.fail(offset, what, "another chunk");
    return std::move(*chunk);
  }

  /// Returns the offset behind the header.
  std::uint64_t readHeader() {
    if (in.readRaw(0, kMagic.size()) != magicBytes()) in.fail(0, "a Rubble trajectory", "another file");
    const Chunk chunk = need(kMagic.size(), kHead, "the header of a trajectory");
    std::optional<RecordingHeader> decoded;
    version = decodeHeader(chunk.content, decoded);
    if (version < kOldestVersion || version > kVersion)
      in.fail(chunk.offset, "version " + std::to_string(kOldestVersion) + " to " + std::to_string(kVersion),
              "version " + std::to_string(version));
    if (!decoded) in.fail(chunk.offset, "the header of a trajectory", "other content");
    header = *decoded;
    const std::uint64_t first = in.head(kMagic.size())->end;
    const auto next = in.head(first);
    if (!next || next->name != kLook) return first;
    std::optional<Appearance> look = appearanceOf(
        ByteReader(need(first, kLook, "an appearance").content).getText());
    if (!look) in.fail(first, "an appearance", "other content");
    header.appearance = std::move(*look);
    return next->end;
  }

  /// Where the index is, if the file has its footer.
  std::optional<std::uint64_t> indexOffset() {
    if (in.size() < kFooterSize) return std::nullopt;
    const Bytes footer = in.readRaw(in.size() - kFooterSize, kFooterSize);
    if (!std::equal(kMagic.begin(), kMagic.end(), footer.begin() + 8)) return std::nullopt;
    return ByteReader(footer).get<std::uint64_t>();
  }

  void readIndex(std::uint64_t offset) {
    const Chunk chunk = need(offset, kIndex, "the index of a trajectory");
    const auto decoded = decodeIndex(chunk.content);
    if (!decoded) in.fail(offset, "the index of a trajectory", "other content");
    chunks = *decoded;
    complete = true;
    intact = in.size();
  }

  /// Finds the chunks of a file without an index, up to one that is cut off.
  void walk(std::uint64_t offset) {
    std::uint64_t bodyOffset = 0;
    intact = offset;
    while (const auto head = in.head(offset)) {
      if (head->name == kBody) bodyOffset = offset;
      if (head->name == kFrames) {
        const Chunk chunk = need(offset, kFrames, "frames");
        if (bodyOffset == 0) in.fail(offset, "bodies before frames", "frames");
        const int count = ByteReader(chunk.content).get<std::int32_t>();
        if (count < 1) in.fail(offset, "at least one frame", std::to_string(count));
        chunks.push_back({offset, bodyOffset, count});
      }
      offset = head->end;
      intact = offset;
      // Behind the index comes the footer, and this file has not got a whole one.
      if (head->name == kIndex && in.size() - offset >= kFooterSize)
        in.fail(offset, "the footer of a trajectory", "other content");
    }
  }

  /// The chunk that a frame is in. Its tables are the present ones then.
  std::size_t loadObjects(int frame) {
    if (frame < 0 || frame >= frameCount)
      throw Error("recording.frame", "one of " + std::to_string(frameCount) + " frames",
                  std::to_string(frame));
    const auto place = static_cast<std::size_t>(
                           std::upper_bound(firstFrames.begin(), firstFrames.end(), frame) -
                           firstFrames.begin()) -
                       1;
    const FrameChunk& chunk = chunks[place];
    if (chunk.bodyOffset != bodiesOffset) {
      bodiesOffset.reset();
      auto decoded = decodeObjects(need(chunk.bodyOffset, kBody, "the bodies of a trajectory").content,
                                   version);
      if (!decoded) in.fail(chunk.bodyOffset, "the bodies of a trajectory", "other content");
      objects = std::move(*decoded);
      bodiesOffset = chunk.bodyOffset;
    }
    return place;
  }

  /// Makes the chunk of a frame the present one; returns the frame's place in it.
  std::size_t load(int frame) {
    const std::size_t place = loadObjects(frame);
    const FrameChunk& chunk = chunks[place];
    if (framesOf == place) return static_cast<std::size_t>(frame - firstFrames[place]);
    framesOf.reset();
    Bytes content = need(chunk.offset, kFrames, "frames", frames.takeContent()).content;
    if (!frames.start(std::move(content), objects.bodies.size(), objects.vertexCount(), header.resolution,
                      version) ||
        frames.frameCount() != static_cast<std::size_t>(chunk.frameCount))
      in.fail(chunk.offset,
              std::to_string(chunk.frameCount) + " frames of " + std::to_string(objects.bodies.size()) +
                  " bodies and " + std::to_string(objects.vertexCount()) + " vertices",
              "other content");
    framesOf = place;
    return static_cast<std::size_t>(frame - firstFrames[place]);
  }
};

RecordingReader::RecordingReader(const std::string& file) : impl_(std::make_unique<Impl>(file)) {}
RecordingReader::~RecordingReader() = default;
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader& RecordingReader::operator=(RecordingReader&&) noexcept = default;

const RecordingHeader& RecordingReader::header() const { return impl_->header; }
bool RecordingReader::complete() const { return impl_->complete; }
int RecordingReader::frameCount() const { return impl_->frameCount; }
RecordedFrame RecordingReader::frame(int index) { return *share(index); }
std::shared_ptr<const RecordedFrame> RecordingReader::share(int index) {
  const std::size_t place = impl_->load(index);
  return impl_->frames.frame(place);
}
std::uint64_t RecordingReader::fileBytes() const { return impl_->in.size(); }
std::uint64_t RecordingReader::intactBytes() const { return impl_->intact; }
const std::vector<RecordedBody>& RecordingReader::bodies(int frameIndex) {
  impl_->loadObjects(frameIndex);
  return impl_->objects.bodies;
}
const std::vector<RecordedSoft>& RecordingReader::softs(int frameIndex) {
  impl_->loadObjects(frameIndex);
  return impl_->objects.softs;
}
std::vector<int> RecordingReader::changes() const {
  std::vector<int> out;
  for (std::size_t i = 0; i < impl_->chunks.size(); ++i)
    if (i == 0 || impl_->chunks[i].bodyOffset != impl_->chunks[i - 1].bodyOffset)
      out.push_back(impl_->firstFrames[i]);
  return out;
}

}  // namespace rubble::io
