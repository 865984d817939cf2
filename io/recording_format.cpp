#include "io/recording_format.h"

#include "io/byte_stream.h"
#include "io/shape_json.h"

namespace rubble::io {

namespace {

/// Bit of a shape's type: the shape as JSON text follows the name of the body.
constexpr int kDescribed = 0x80;

}  // namespace

Bytes magicBytes() { return {kMagic.begin(), kMagic.end()}; }

Bytes encodeHeader(const RecordingHeader& header) {
  ByteWriter out;
  out.put(kVersion);
  out.put(header.scene);
  out.put(header.dt);
  for (int axis = 0; axis < 3; ++axis) out.put(header.gravity[axis]);
  out.put(header.resolution);
  return out.bytes();
}

std::uint32_t decodeHeader(const Bytes& content, std::optional<RecordingHeader>& header) {
  ByteReader in(content);
  const auto version = in.get<std::uint32_t>();
  if (version != kVersion) return version;
  RecordingHeader read;
  read.scene = in.getText();
  read.dt = in.getDouble();
  for (int axis = 0; axis < 3; ++axis) read.gravity[axis] = in.getDouble();
  read.resolution = in.getDouble();
  if (in.atEnd() && read.resolution > 0) header = read;
  return version;
}

Bytes encodeBodies(const std::vector<RecordedBody>& bodies) {
  ByteWriter out;
  out.put(static_cast<std::uint32_t>(bodies.size()));
  for (const RecordedBody& body : bodies) {
    out.put(body.id.index);
    out.put(body.id.generation);
    out.put(static_cast<std::uint8_t>(body.motion));
    const bool described = body.shape.type > ShapeType::Plane || body.shape.rounding > 0;
    out.put(static_cast<std::uint8_t>(static_cast<int>(body.shape.type) | (described ? kDescribed : 0)));
    for (int axis = 0; axis < 3; ++axis) out.put(body.shape.halfExtents[axis]);
    out.put(body.shape.radius);
    out.put(body.shape.halfLength);
    out.put(body.name);
    if (described) out.put(shapeJson(body.shape).dump());
  }
  return out.bytes();
}

std::optional<std::vector<RecordedBody>> decodeBodies(const Bytes& content) {
  ByteReader in(content);
  const std::size_t count = in.get<std::uint32_t>();
  constexpr std::size_t kSmallest = 54;
  if (count > in.left() / kSmallest) return std::nullopt;
  std::vector<RecordedBody> bodies(count);
  for (RecordedBody& body : bodies) {
    body.id.index = in.get<std::int32_t>();
    body.id.generation = in.get<std::uint32_t>();
    const auto motion = in.get<std::uint8_t>(), code = in.get<std::uint8_t>();
    const int type = code & ~kDescribed;
    if (motion > static_cast<int>(Motion::Dynamic) || type > static_cast<int>(ShapeType::DistanceField)) return std::nullopt;
    body.motion = static_cast<Motion>(motion);
    body.shape.type = static_cast<ShapeType>(type);
    for (int axis = 0; axis < 3; ++axis) body.shape.halfExtents[axis] = in.getDouble();
    body.shape.radius = in.getDouble();
    body.shape.halfLength = in.getDouble();
    body.name = in.getText();
    if (!(code & kDescribed)) continue;
    std::vector<Fault> faults;
    const std::optional<Json> json = parseJson(in.getText(), faults);
    if (!json) return std::nullopt;
    body.shape = readShape(Node(*json, "shape", faults), {}, readMaterial);
    if (!faults.empty()) return std::nullopt;
  }
  return in.atEnd() ? std::optional(std::move(bodies)) : std::nullopt;
}

Bytes encodeIndex(const std::vector<FrameChunk>& chunks) {
  ByteWriter out;
  out.put(static_cast<std::uint32_t>(chunks.size()));
  for (const FrameChunk& chunk : chunks) out.put(chunk.offset), out.put(chunk.bodyOffset), out.put(chunk.frameCount);
  return out.bytes();
}

std::optional<std::vector<FrameChunk>> decodeIndex(const Bytes& content) {
  ByteReader in(content);
  const std::size_t count = in.get<std::uint32_t>();
  if (in.left() != count * 20) return std::nullopt;
  std::vector<FrameChunk> chunks(count);
  for (FrameChunk& chunk : chunks) {
    chunk.offset = in.get<std::uint64_t>();
    chunk.bodyOffset = in.get<std::uint64_t>();
    chunk.frameCount = in.get<std::int32_t>();
    if (chunk.frameCount < 1) return std::nullopt;
  }
  return chunks;
}

}  // namespace rubble::io
