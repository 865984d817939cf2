/// Trajectories that are cut off, damaged or made to deceive are read or are an Error; the sanitizers watch
/// what is touched.
#include <gtest/gtest.h>
#include <rubble/error.h>

#include <functional>

#include <rubble/mesh.h>
#include "io/byte_stream.h"
#include "io/frame_codec.h"
#include "io/recording.h"
#include "io/recording_format.h"
#include "tests/support/files.h"

namespace rubble::io {
namespace {

using test::TemporaryFile;

/// Reads all frames of a file, and what pictures are made of. Did it go without an Error?
bool readAll(const std::string& file) {
  try {
    RecordingReader reader(file);
    for (int i = 0; i < reader.frameCount(); ++i) {
      for (const PictureBody& body : pictureBodies(reader, i)) shapeMesh(body.shape, 8);
      recordingResolution(reader.bodies(i), reader.softs(i));
      if (reader.frame(i).poses.size() != reader.bodies(i).size()) ADD_FAILURE() << "frame " << i;
    }
    return true;
  } catch (const Error&) {
    return false;
  }
}

struct Piece {
  std::uint32_t name = 0;
  Bytes content;
};

/// A file of chunks with right checksums, whatever these hold. `index` is written from where the chunks are.
class Forge {
 public:
  struct Entry {
    std::size_t frames, bodies;  ///< places among the pieces
    std::int32_t count;
  };
  std::vector<Piece> pieces;
  std::vector<Entry> index;
  std::function<void(Bytes&)> changeIndex = [](Bytes&) {};

  void write(const std::string& file) const {
    ChunkWriter out(file);
    out.writeRaw(magicBytes());
    std::vector<std::uint64_t> offsets;
    for (const Piece& piece : pieces) offsets.push_back(out.write(piece.name, piece.content));
    std::vector<FrameChunk> entries;
    for (const Entry& e : index) entries.push_back({offsets[e.frames], offsets[e.bodies], e.count});
    Bytes content = encodeIndex(entries);
    changeIndex(content);
    ByteWriter footer;
    footer.put(out.write(kIndex, content));
    out.writeRaw(footer.bytes());
    out.writeRaw(magicBytes());
  }
  bool reads() const {
    const TemporaryFile file(".rubble");
    write(file.path);
    return readAll(file.path);
  }
};

const RecordedBody kBox{"box", Shape::box({.5, .25, .125}), Motion::Dynamic, {1, 1}};
const RecordedBody kHull{
    "hull", Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), Motion::Dynamic, {2, 1}};
const RecordedSoft kSheet{"sheet", {0, 1}, 4, {{0, 1, 2}, {1, 3, 2}}, {{0, 3}}, .001, false, false};

RecordedFrame frameOf(std::size_t bodies, std::size_t vertices, int step) {
  return {step, step / 60., std::vector<RecordedPose>(bodies, {{.1 * step, 0, 0}, {}}),
          std::vector<Vec3>(vertices, {0, .1 * step, 0})};
}
Bytes framesOf(std::size_t bodies, std::size_t vertices, int count) {
  FrameEncoder encoder(1e-5);
  for (int i = 0; i < count; ++i) encoder.add(frameOf(bodies, vertices, i));
  return encoder.content();
}

/// Two frames of a box, then three of a box, a hull and a sheet. Pieces: header, box, its frames, all three,
/// their frames.
Forge sample() {
  Forge forge;
  forge.pieces = {{kHead, encodeHeader({"a test", 1 / 60., {0, 0, -9.81}, 1e-5})},
                  {kBody, encodeObjects({{kBox}, {}})},
                  {kFrames, framesOf(1, 0, 2)},
                  {kBody, encodeObjects({{kBox, kHull}, {kSheet}})},
                  {kFrames, framesOf(2, 4, 3)}};
  forge.index = {{2, 1, 2}, {4, 3, 3}};
  return forge;
}

TEST(DamagedRecording, IsReadAsItIsWhenItIsWhole) { EXPECT_TRUE(sample().reads()); }

TEST(DamagedRecording, CutOffAtEveryByte) {
  const TemporaryFile whole(".rubble");
  sample().write(whole.path);
  const std::string bytes = test::contentOf(whole.path);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    readAll(TemporaryFile(".rubble", bytes.substr(0, size)).path);
}

TEST(DamagedRecording, WithEveryByteChanged) {
  const TemporaryFile whole(".rubble");
  sample().write(whole.path);
  const std::string bytes = test::contentOf(whole.path);
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (const unsigned flip : {0x01u, 0x80u, 0xffu}) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(static_cast<unsigned char>(changed[at]) ^ flip);
      readAll(TemporaryFile(".rubble", changed).path);
    }
}

TEST(DamagedRecording, OfChunksCutOffAtEveryByteUnderRightChecksums) {
  const Forge whole = sample();
  for (std::size_t piece = 0; piece < whole.pieces.size(); ++piece)
    for (std::size_t size = 0; size < whole.pieces[piece].content.size(); ++size) {
      Forge forge = whole;
      forge.pieces[piece].content.resize(size);
      EXPECT_FALSE(forge.reads()) << piece << " " << size;
    }
}

TEST(DamagedRecording, OfChunksWithEveryByteChangedUnderRightChecksums) {
  const Forge whole = sample();
  for (std::size_t piece = 0; piece < whole.pieces.size(); ++piece)
    for (std::size_t at = 0; at < whole.pieces[piece].content.size(); ++at)
      for (const unsigned flip : {0x01u, 0x40u, 0x80u, 0xffu}) {
        Forge forge = whole;
        forge.pieces[piece].content[at] ^= static_cast<std::uint8_t>(flip);
        forge.reads();
      }
  for (std::size_t at = 0; at < encodeIndex({{}, {}}).size(); ++at)
    for (const unsigned flip : {0x01u, 0x40u, 0x80u, 0xffu}) {
      Forge forge = whole;
      forge.changeIndex = [&](Bytes& index) { index[at] ^= static_cast<std::uint8_t>(flip); };
      forge.reads();
    }
}

TEST(DamagedRecording, WhoseIndexNamesOffsetZero) {
  Forge forge = sample();
  forge.changeIndex = [](Bytes& index) { std::fill(index.begin() + 4, index.begin() + 20, std::uint8_t{0}); };
  EXPECT_FALSE(forge.reads());
}

TEST(DamagedRecording, WhoseIndexNamesOneChunkTwiceWithDifferentCounts) {
  Forge forge = sample();
  forge.index = {{4, 3, 3}, {4, 3, 9}};
  EXPECT_FALSE(forge.reads());
}

TEST(DamagedRecording, WhoseIndexNamesTheBodiesOfOtherFrames) {
  Forge forge = sample();
  forge.index = {{2, 1, 2}, {2, 3, 2}};
  EXPECT_FALSE(forge.reads());
  forge.index = {{4, 3, 3}, {4, 1, 3}};
  EXPECT_FALSE(forge.reads());
}

TEST(DamagedRecording, OfBodiesWithoutTheGeometryOfTheirType) {
  for (const ShapeType type : {ShapeType::Hull, ShapeType::Compound, ShapeType::Mesh, ShapeType::HeightField,
                               ShapeType::DistanceField}) {
    Forge forge = sample();
    Bytes& content = forge.pieces[1].content;
    // number of bodies, id, generation and motion stand before it
    constexpr std::size_t kTypeAt = 4 + 4 + 4 + 1;
    ASSERT_EQ(content[kTypeAt], static_cast<int>(ShapeType::Box));
    content[kTypeAt] = static_cast<std::uint8_t>(type);
    EXPECT_FALSE(forge.reads()) << static_cast<int>(type);
  }
}

TEST(DamagedRecording, OfShapesThatPointOutsideOfThemselves) {
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const Shape& shape :
       {Shape::mesh(corners, {{0, 1, 3}}), Shape::mesh(corners, {{0, 1, 1000000}}),
        Shape::heightField(3, 2, {1, 1, 0}, {0, 0, 0, 0}), Shape::heightField(65536, 65536, {1, 1, 0}, {}),
        Shape::heightField(2147483647, 2, {1, 1, 0}, {0, 0}),
        Shape::distanceField({2, 2, 3}, {}, 1, {-1, 1, 1, 1, 1, 1, 1, 1}),
        Shape::distanceField({1 << 22, 1 << 21, 1 << 21}, {}, 1, {}),
        Shape::compound({{Shape::compound({{kBox.shape, {}, {}}}), {}, {}}})}) {
    Forge forge = sample();
    forge.pieces[1].content = encodeObjects({{{"odd", shape, Motion::Static, {1, 1}}}, {}});
    EXPECT_FALSE(forge.reads()) << static_cast<int>(shape.type);
  }
}

/// The sizes of a chunk are 32 bits each, and their product is 2^64 and a little more.
TEST(DamagedRecording, WhoseSizesMultiplyBeyondTheWidthOfAWord) {
  constexpr std::uint32_t kFrames = 2509796186u, kVertices = 4287440055u;
  constexpr std::size_t kLeft = 1744;
  static_assert(std::uint64_t{kFrames} * 16 + std::uint64_t{kVertices} * 24 +
                    std::uint64_t{kFrames} * 3 * kVertices * 4 ==
                kLeft);
  ByteWriter out;
  out.put(kFrames), out.put(std::uint32_t{0}), out.put(kVertices);
  Bytes content = out.bytes();
  content.resize(content.size() + kLeft);
  EXPECT_FALSE(FrameDecoder{}.start(content, 0, kVertices, 1e-5, kVersion));
}

}  // namespace
}  // namespace rubble::io
