#include "io/recording_format.h"

#include <cmath>

#include <rubble/error.h>

#include "cook/shape_traits.h"
#include "cook/size.h"
#include "io/byte_stream.h"
#include "io/shape_json.h"

namespace rubble::io {

namespace {

/// Bits of what a deformable object is.
constexpr int kSpheres = 1, kSolid = 2;
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
  if (version < kOldestVersion || version > kVersion) return version;
  RecordingHeader read;
  read.scene = in.getText();
  read.dt = in.getDouble();
  for (int axis = 0; axis < 3; ++axis) read.gravity[axis] = in.getDouble();
  read.resolution = in.getDouble();
  const bool finite = std::isfinite(read.dt + read.gravity.x + read.gravity.y + read.gravity.z +
                                    read.resolution);
  if (in.atEnd() && finite && read.resolution > 0) header = read;
  return version;
}

std::size_t RecordedObjects::vertexCount() const {
  std::size_t count = 0;
  for (const RecordedSoft& soft : softs) count += static_cast<std::size_t>(soft.vertices);
  return count;
}

namespace {

void putBodies(ByteWriter& out, const std::vector<RecordedBody>& bodies) {
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
}

/// Has the shape all that pictures look at?
bool isWhole(const Shape& shape) {
  try {
    validate(shape, "shape");
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::optional<std::vector<RecordedBody>> getBodies(ByteReader& in) {
  const std::size_t count = in.get<std::uint32_t>();
  constexpr std::size_t kSmallest = 54;
  if (count > in.left() / kSmallest) return std::nullopt;
  std::vector<RecordedBody> bodies(count);
  for (RecordedBody& body : bodies) {
    body.id.index = in.get<std::int32_t>();
    body.id.generation = in.get<std::uint32_t>();
    const auto motion = in.get<std::uint8_t>(), code = in.get<std::uint8_t>();
    const int type = code & ~kDescribed;
    if (motion > static_cast<int>(Motion::Dynamic) || type >= static_cast<int>(shapeTraits().size()))
      return std::nullopt;
    body.motion = static_cast<Motion>(motion);
    body.shape.type = static_cast<ShapeType>(type);
    for (int axis = 0; axis < 3; ++axis) body.shape.halfExtents[axis] = in.getDouble();
    body.shape.radius = in.getDouble();
    body.shape.halfLength = in.getDouble();
    body.name = in.getText();
    if (code & kDescribed) {
      std::vector<Fault> faults;
      const std::optional<JsonDocument> json = parseJson(in.getText(), faults);
      if (!json) return std::nullopt;
      body.shape = readShape(Node(json->root(), "shape", faults), {}, readMaterial);
      if (!faults.empty()) return std::nullopt;
    }
    if (!isWhole(body.shape)) return std::nullopt;
  }
  return bodies;
}

template <std::size_t N> void putCorners(ByteWriter& out, const std::vector<std::array<int, N>>& lists) {
  out.put(static_cast<std::uint32_t>(lists.size()));
  for (const auto& list : lists)
    for (const int v : list) out.put(static_cast<std::int32_t>(v));
}
/// False if there are fewer than they say, or one is no vertex.
template <std::size_t N>
bool getCorners(ByteReader& in, int vertices, std::vector<std::array<int, N>>& lists) {
  const std::size_t count = in.get<std::uint32_t>();
  if (count > in.left() / (N * sizeof(std::int32_t))) return false;
  lists.resize(count);
  for (auto& list : lists)
    for (int& v : list) {
      v = in.get<std::int32_t>();
      if (v < 0 || v >= vertices) return false;
    }
  return true;
}

void putSofts(ByteWriter& out, const std::vector<RecordedSoft>& softs) {
  out.put(static_cast<std::uint32_t>(softs.size()));
  for (const RecordedSoft& soft : softs) {
    out.put(soft.id.index);
    out.put(soft.id.generation);
    out.put(static_cast<std::uint8_t>((soft.spheres ? kSpheres : 0) | (soft.solid ? kSolid : 0)));
    out.put(static_cast<std::int32_t>(soft.vertices));
    out.put(soft.radius);
    out.put(soft.name);
    putCorners(out, soft.triangles);
    putCorners(out, soft.segments);
  }
}

std::optional<std::vector<RecordedSoft>> getSofts(ByteReader& in) {
  const std::size_t count = in.get<std::uint32_t>();
  constexpr std::size_t kSmallest = 33;
  if (count > in.left() / kSmallest) return std::nullopt;
  std::vector<RecordedSoft> softs(count);
  for (RecordedSoft& soft : softs) {
    soft.id.index = in.get<std::int32_t>();
    soft.id.generation = in.get<std::uint32_t>();
    const auto bits = in.get<std::uint8_t>();
    soft.spheres = (bits & kSpheres) != 0, soft.solid = (bits & kSolid) != 0;
    soft.vertices = in.get<std::int32_t>();
    soft.radius = in.getDouble();
    soft.name = in.getText();
    if (bits > (kSpheres | kSolid) || soft.vertices < 0) return std::nullopt;
    if (!getCorners(in, soft.vertices, soft.triangles) || !getCorners(in, soft.vertices, soft.segments))
      return std::nullopt;
  }
  return softs;
}

}  // namespace

Bytes encodeObjects(const RecordedObjects& objects) {
  ByteWriter out;
  putBodies(out, objects.bodies);
  putSofts(out, objects.softs);
  return out.bytes();
}

std::optional<RecordedObjects> decodeObjects(const Bytes& content, std::uint32_t version) {
  ByteReader in(content);
  RecordedObjects objects;
  if (auto bodies = getBodies(in))
    objects.bodies = std::move(*bodies);
  else
    return std::nullopt;
  if (version > 1) {
    if (auto softs = getSofts(in))
      objects.softs = std::move(*softs);
    else
      return std::nullopt;
  }
  return in.atEnd() ? std::optional(std::move(objects)) : std::nullopt;
}

Bytes encodeIndex(const std::vector<FrameChunk>& chunks) {
  ByteWriter out;
  out.put(static_cast<std::uint32_t>(chunks.size()));
  for (const FrameChunk& chunk : chunks)
    out.put(chunk.offset), out.put(chunk.bodyOffset), out.put(chunk.frameCount);
  return out.bytes();
}

std::optional<std::vector<FrameChunk>> decodeIndex(const Bytes& content) {
  ByteReader in(content);
  const std::size_t count = in.get<std::uint32_t>();
  if (!(Size(count) * 20 == in.left())) return std::nullopt;
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
