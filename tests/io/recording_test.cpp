#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "io/frame_codec.h"
#include "io/recording.h"
#include "io/recording_format.h"
#include "rubble/error.h"
#include "tests/support/files.h"

namespace rubble::io {
namespace {

using test::TemporaryFile;

constexpr double kResolution = 1e-5;
const std::string kEnding = ".rubble";

std::vector<char> bytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void writeAll(const std::string& path, const std::vector<char>& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

Quat someRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return normalize(Quat{normal(random), normal(random), normal(random), normal(random)});
}

struct Trajectory {
  std::vector<std::vector<RecordedBody>> bodies;  ///< of each frame
  std::vector<RecordedFrame> frames;
};

/// `count` frames of three bodies and, from frame 40 on, a fourth.
Trajectory makeTrajectory(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(-.1, .1);
  std::vector<RecordedBody> bodies{{"ground", Shape::plane(), Motion::Static, {0, 1}},
                                   {"box", Shape::box({.5, .25, .125}), Motion::Dynamic, {1, 1}},
                                   {"", Shape::capsule(.1, .5), Motion::Dynamic, {2, 1}}};
  std::vector<RecordedPose> poses(3);
  poses[1].position = {1e6, -3, .1};
  Trajectory made;
  for (int i = 0; i < count; ++i) {
    if (i == 40) {
      bodies.push_back({"ball", Shape::sphere(2), Motion::Dynamic, {3, 5}});
      poses.push_back({{0, 0, 50}, {}});
    }
    for (std::size_t k = 1; k < poses.size(); ++k) {
      poses[k].position += Vec3{step(random), step(random), step(random)};
      poses[k].orientation = someRotation(random);
    }
    made.bodies.push_back(bodies);
    made.frames.push_back({i, i / 60., poses});
  }
  return made;
}

void write(const std::string& path, const Trajectory& trajectory, bool finish = true) {
  RecordingWriter writer(path, {"a test", 1 / 60., {0, 0, -9.81}, kResolution});
  for (std::size_t i = 0; i < trajectory.frames.size(); ++i)
    writer.write(trajectory.bodies[i], trajectory.frames[i]);
  if (finish) writer.finish();
}

double angleBetween(const Quat& a, const Quat& b) {
  const Quat turn = conjugate(a) * b;
  return 2 * std::atan2(length(turn.v), std::fabs(turn.s));
}

void expectFrame(RecordingReader& reader, int index, const Trajectory& trajectory) {
  const auto i = static_cast<std::size_t>(index);
  const RecordedFrame frame = reader.frame(index);
  EXPECT_EQ(reader.bodies(index), trajectory.bodies[i]);
  EXPECT_EQ(frame.step, trajectory.frames[i].step);
  EXPECT_EQ(frame.time, trajectory.frames[i].time);
  ASSERT_EQ(frame.poses.size(), trajectory.frames[i].poses.size());
  for (std::size_t k = 0; k < frame.poses.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(frame.poses[k].position[axis], trajectory.frames[i].poses[k].position[axis],
                  .5001 * kResolution);
    EXPECT_LT(angleBetween(frame.poses[k].orientation, trajectory.frames[i].poses[k].orientation), 1e-5);
  }
}

TEST(Recording, FramesComeBackInAnyOrder) {
  const TemporaryFile file(kEnding);
  const Trajectory trajectory = makeTrajectory(100);
  write(file.path, trajectory);
  RecordingReader reader(file.path);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.header().scene, "a test");
  EXPECT_EQ(reader.header().gravity, (Vec3{0, 0, -9.81}));
  ASSERT_EQ(reader.frameCount(), 100);
  for (const int index : {0, 99, 39, 40, 31, 32, 33, 71, 72, 5}) expectFrame(reader, index, trajectory);
  EXPECT_EQ(reader.changes(), (std::vector<int>{0, 40}));
  EXPECT_EQ(reader.intactBytes(), reader.fileBytes());
  EXPECT_EQ(remainder(reader), "");
  EXPECT_THROW(reader.frame(100), Error);
  EXPECT_THROW(reader.frame(-1), Error);
}

/// A sheet of two triangles that loses one at frame 20, a rope and particles that come at frame 40.
struct SoftTrajectory {
  std::vector<std::vector<RecordedSoft>> softs;  ///< of each frame
  std::vector<RecordedFrame> frames;
};
SoftTrajectory makeSoftTrajectory(int count) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> step(-.1, .1);
  std::vector<RecordedSoft> softs{{"sheet", {0, 1}, 4, {{0, 1, 2}, {1, 3, 2}}, {}, .001, false, false},
                                  {"", {1, 1}, 3, {}, {{0, 1}, {1, 2}}, .01, false, false}};
  std::vector<Vec3> vertices(7);
  SoftTrajectory made;
  for (int i = 0; i < count; ++i) {
    if (i == 20) softs[0].triangles.pop_back();
    if (i == 40) {
      softs.push_back({"sand", {2, 3}, 2, {}, {}, .02, true, false});
      vertices.resize(9);
    }
    for (Vec3& x : vertices) x += Vec3{step(random), step(random), step(random)};
    made.softs.push_back(softs);
    made.frames.push_back({i, i / 60., {{{.1 * i, 0, 0}, someRotation(random)}}, vertices});
  }
  return made;
}
const std::vector<RecordedBody> kOneBody{{"box", Shape::box({.5, .25, .125}), Motion::Dynamic, {1, 1}}};
void writeSoft(const std::string& path, const SoftTrajectory& trajectory) {
  RecordingWriter writer(path, {"soft", 1 / 60., {0, 0, -9.81}, kResolution});
  for (std::size_t i = 0; i < trajectory.frames.size(); ++i)
    writer.write(kOneBody, trajectory.frames[i], trajectory.softs[i]);
  writer.finish();
}

TEST(Recording, VerticesOfDeformableObjectsComeBack) {
  const TemporaryFile file(kEnding);
  const SoftTrajectory trajectory = makeSoftTrajectory(60);
  writeSoft(file.path, trajectory);
  RecordingReader reader(file.path);
  ASSERT_EQ(reader.frameCount(), 60);
  for (const int index : {0, 59, 19, 20, 39, 40, 31, 32, 5}) {
    const auto i = static_cast<std::size_t>(index);
    const RecordedFrame frame = reader.frame(index);
    EXPECT_EQ(reader.softs(index), trajectory.softs[i]) << index;
    EXPECT_EQ(reader.bodies(index), kOneBody);
    ASSERT_EQ(frame.vertices.size(), trajectory.frames[i].vertices.size());
    for (std::size_t v = 0; v < frame.vertices.size(); ++v)
      EXPECT_LT(length(frame.vertices[v] - trajectory.frames[i].vertices[v]), kResolution) << index;
    EXPECT_NEAR(frame.poses[0].position.x, .1 * index, kResolution);
  }
}

TEST(Recording, DeformableObjectsAreDrawnAsTheyWere) {
  const TemporaryFile file(kEnding);
  Scene scene;
  scene.deformables = {tetBox({0, 0, 1}, {.5, .5, .5}, {2, 2, 2}),
                       clothSheet({-1, -1, 2}, {2, 0, 0}, {0, 2, 0}, 4, 4),
                       straightCable({0, 0, 3}, {1, 0, 3}, 4)};
  World world(scene);
  const std::vector<RecordedSoft> softs = recordedSofts(world);
  std::vector<PictureBody> live;
  {
    RecordingWriter writer(file.path,
                           {"soft", world.params().dt, world.gravity(), recordingResolution({}, softs)});
    for (int i = 0; i < 5; ++i) {
      writer.write(recordedBodies(world), recordedFrame(world), recordedSofts(world));
      live = pictureBodies(world);
      world.step();
    }
  }
  RecordingReader reader(file.path);
  const std::vector<PictureBody> drawn = pictureBodies(reader, 4);
  ASSERT_EQ(drawn.size(), live.size());
  for (std::size_t i = 0; i < live.size(); ++i) {
    EXPECT_EQ(drawn[i].key, live[i].key);
    EXPECT_EQ(drawn[i].deforms, live[i].deforms);
    EXPECT_NEAR(drawn[i].speed, live[i].speed, 1e-2 * live[i].speed) << "from differences";
    ASSERT_EQ(drawn[i].shape.geometry->triangles, live[i].shape.geometry->triangles);
    const auto& points = drawn[i].shape.geometry->points;
    for (std::size_t k = 0; k < points.size(); ++k)
      EXPECT_LT(length(points[k] + drawn[i].position - live[i].shape.geometry->points[k] - live[i].position),
                2 * reader.header().resolution);
  }
}

#if defined(RUBBLE_HAS_ZSTD)
TEST(Recording, FilesOfVersion1AreRead) {
  // drop-stack, 3 steps, written before there were deformable objects
  RecordingReader reader(std::string(RUBBLE_SOURCE_DIR) + "/tests/io/recordings/version_1.rubble");
  EXPECT_TRUE(reader.complete());
  ASSERT_EQ(reader.frameCount(), 4);
  ASSERT_EQ(reader.bodies(3).size(), 11u);
  EXPECT_TRUE(reader.softs(3).empty());
  const RecordedFrame first = reader.frame(0), last = reader.frame(3);
  EXPECT_EQ(last.step, 3);
  // free fall of implicit Euler: g dt^2 (1 + 2 + 3)
  EXPECT_NEAR(first.poses[10].position.z - last.poses[10].position.z, 10. * 6 / 3600, 1e-4);
}
#endif

TEST(Recording, AnAppearanceComesBack) {
  const TemporaryFile file(kEnding);
  RecordingHeader header{"seen", 1 / 60., {0, 0, -9.81}, kResolution};
  header.appearance.looks = {{0, {{Shape::sphere(.5), {1, 2, 3}, {}, Vec3{.25, .5, 1}}}}};
  header.appearance.daylight = {Vec3{0, 0, 1}, {1, 0.5, 0.25}, 0.5, 2};
  header.appearance.lights = {{{1, 2, 3}, {0.5, 1, 0.25}, 8}};
  header.appearance.cameras = {{"front", {1, 0, 0}, {}, 0.5}};
  RecordingWriter(file.path, header).finish();
  const Appearance read = RecordingReader(file.path).header().appearance;
  ASSERT_EQ(read.looks.size(), 1u);
  EXPECT_EQ(read.looks[0].parts.at(0).color, (Vec3{.25, .5, 1}));
  EXPECT_EQ(read.looks[0].parts[0].position, (Vec3{1, 2, 3}));
  EXPECT_EQ(read.daylight.toSun, (Vec3{0, 0, 1}));
  EXPECT_EQ(read.daylight.sunColor, (Vec3{1, 0.5, 0.25}));
  EXPECT_EQ(read.daylight.sunStrength, 0.5);
  EXPECT_EQ(read.daylight.skyStrength, 2);
  EXPECT_EQ(read.lights.at(0).position, (Vec3{1, 2, 3}));
  EXPECT_EQ(read.lights[0].color, (Vec3{0.5, 1, 0.25}));
  EXPECT_EQ(read.lights[0].intensity, 8);
  EXPECT_EQ(read.cameras.at(0).name, "front");
}

TEST(Recording, AnEmptyRecordingIsGood) {
  const TemporaryFile file(kEnding);
  write(file.path, {});
  RecordingReader reader(file.path);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.frameCount(), 0);
}

TEST(Recording, LongWaysAndLostStatesGetChunksOfTheirOwn) {
  const TemporaryFile file(kEnding);
  std::vector<RecordedBody> bodies{{"a", Shape::sphere(1), Motion::Dynamic, {0, 1}}};
  const std::vector<double> places{0, 1e9, -1e9, 5, std::nan(""), 6};
  {
    RecordingWriter writer(file.path, {"", 1, {}, kResolution});
    for (std::size_t i = 0; i < places.size(); ++i)
      writer.write(bodies, {static_cast<std::int64_t>(i), 0, {{{places[i], 0, 0}, {}}}});
  }
  RecordingReader reader(file.path);
  ASSERT_EQ(reader.frameCount(), 6);
  for (int i = 0; i < 6; ++i) {
    const double x = reader.frame(i).poses[0].position.x, wanted = places[static_cast<std::size_t>(i)];
    EXPECT_TRUE(std::isnan(wanted) ? std::isnan(x) : std::fabs(x - wanted) <= kResolution) << i;
  }
}

TEST(Recording, QuaternionsKeepTheirRotation) {
  std::mt19937 random(3);
  for (int i = 0; i < 10000; ++i) {
    const Quat q = someRotation(random);
    EXPECT_LT(angleBetween(unpackQuaternion(packQuaternion(q)), q), 5e-6);
  }
  for (const Quat& q : {Quat{1, 0, 0, 0}, Quat{-1, 0, 0, 0}, Quat{0, 1, 0, 0}, Quat{0, 0, 0, -1}})
    EXPECT_EQ(angleBetween(unpackQuaternion(packQuaternion(q)), q), 0);
}

#if defined(RUBBLE_HAS_ZSTD)
TEST(Recording, RestCostsNextToNothing) {
  const TemporaryFile file(kEnding);
  std::vector<RecordedBody> bodies;
  RecordedFrame frame;
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    bodies.push_back({"", Shape::box({.5, .25, .25}), Motion::Dynamic, {i, 1}});
    frame.poses.push_back({{i * .1, i * .2, i * .3}, someRotation(random)});
  }
  {
    RecordingWriter writer(file.path, {"", 1, {}, kResolution});
    for (frame.step = 0; frame.step < 320; ++frame.step) writer.write(bodies, frame);
  }
  // Incompressible: 1000 bodies x 10 chunks x 8 bytes of rotation and 24 of origin.
  EXPECT_LT(std::filesystem::file_size(file.path), 400'000u);
}
#endif

/// Where chunks begin: a file is a magic of 8 bytes, then heads of 24 bytes with the stored size at byte 8,
/// then a footer of 16.
std::vector<std::size_t> sliceBoundaries(const std::vector<char>& bytes) {
  std::vector<std::size_t> boundaries{0, 8};
  while (boundaries.back() + 16 < bytes.size()) {
    std::uint32_t stored = 0;
    for (std::size_t i = 0; i < 4; ++i)
      stored |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[boundaries.back() + 8 + i]))
                << (8 * i);
    boundaries.push_back(boundaries.back() + 24 + stored);
  }
  return boundaries;
}

TEST(Recording, AFileThatIsCutOffGivesItsWholeChunks) {
  const TemporaryFile file(kEnding);
  const Trajectory trajectory = makeTrajectory(100);
  write(file.path, trajectory);
  const std::vector<char> bytes = bytesOf(file.path);
  const std::vector<std::size_t> boundaries = sliceBoundaries(bytes);
  ASSERT_EQ(boundaries.size(), 10u);  // magic; HEAD BODY FRAM FRAM BODY FRAM FRAM INDX; end of INDX
  std::vector<std::size_t> sizes;
  for (const std::size_t boundary : boundaries)
    for (int offset = -3; offset <= 3; ++offset) {
      const auto size = static_cast<std::ptrdiff_t>(boundary) + offset;
      if (size >= 0 && size < static_cast<std::ptrdiff_t>(bytes.size()))
        sizes.push_back(static_cast<std::size_t>(size));
    }
  for (std::size_t size = boundaries.back(); size < bytes.size(); ++size) sizes.push_back(size);
  // Frames that lie wholly before each boundary.
  const std::vector<int> framesBefore{0, 0, 0, 0, 32, 40, 40, 72, 100, 100};
  for (const std::size_t size : sizes) {
    writeAll(file.path, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
    const auto whole = static_cast<std::size_t>(std::upper_bound(boundaries.begin(), boundaries.end(), size) -
                                                boundaries.begin()) -
                       1;
    if (whole < 2) {
      EXPECT_THROW(RecordingReader{file.path}, Error) << size;
      continue;
    }
    RecordingReader reader(file.path);
    EXPECT_FALSE(reader.complete()) << size;
    ASSERT_EQ(reader.frameCount(), framesBefore[whole]) << size;
    EXPECT_EQ(reader.intactBytes(), boundaries[whole]) << size;
    EXPECT_EQ(reader.fileBytes(), size);
    EXPECT_NE(remainder(reader).find(std::to_string(framesBefore[whole]) + " frames"), std::string::npos);
    if (reader.frameCount() > 0) expectFrame(reader, reader.frameCount() - 1, trajectory);
  }
}

TEST(Recording, AKilledRunLeavesWhatWasFlushed) {
  const TemporaryFile file(kEnding), copy(kEnding);
  const Trajectory trajectory = makeTrajectory(70);
  RecordingWriter writer(file.path, {"a test", 1 / 60., {}, kResolution});
  for (std::size_t i = 0; i < trajectory.frames.size(); ++i)
    writer.write(trajectory.bodies[i], trajectory.frames[i]);
  std::filesystem::copy_file(file.path, copy.path + "k");
  RecordingReader reader(copy.path + "k");
  EXPECT_FALSE(reader.complete());
  EXPECT_EQ(reader.frameCount(), 40);
  expectFrame(reader, 39, trajectory);
  std::filesystem::remove(copy.path + "k");
}

/// Reads everything. Returns false if that ended with an Error.
bool readsThrough(const std::string& path) {
  try {
    RecordingReader reader(path);
    for (int i = 0; i < reader.frameCount(); ++i) reader.frame(i);
    return reader.complete();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    return false;
  }
}

TEST(Recording, EveryFlippedBitIsNoticed) {
  const TemporaryFile file(kEnding);
  Trajectory trajectory = makeTrajectory(45);
  write(file.path, trajectory);
  const std::vector<char> bytes = bytesOf(file.path);
  ASSERT_TRUE(readsThrough(file.path));
  std::mt19937 random(11);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::vector<char> damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (random() % 8)));
    writeAll(file.path, damaged);
    EXPECT_FALSE(readsThrough(file.path)) << "byte " << at;
  }
}

TEST(Recording, EveryFlippedBitIsNoticedBesideDeformableObjects) {
  const TemporaryFile file(kEnding);
  writeSoft(file.path, makeSoftTrajectory(45));
  const std::vector<char> bytes = bytesOf(file.path);
  ASSERT_TRUE(readsThrough(file.path));
  std::mt19937 random(17);
  for (std::size_t at = 0; at < bytes.size(); at += 11) {
    std::vector<char> damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (random() % 8)));
    writeAll(file.path, damaged);
    EXPECT_FALSE(readsThrough(file.path)) << "byte " << at;
  }
}

TEST(Recording, ContentThatNoWriterMakesIsAnError) {
  // whole and with right checksums, but no vertex has this number
  RecordedObjects objects{{}, {{"sheet", {0, 1}, 3, {{0, 1, 2}}, {}, .001, false, false}}};
  ASSERT_TRUE(decodeObjects(encodeObjects(objects), kVersion));
  EXPECT_FALSE(decodeObjects(encodeObjects(objects), 1)) << "version 1 has no such table";
  objects.softs[0].triangles[0][2] = 3;
  EXPECT_FALSE(decodeObjects(encodeObjects(objects), kVersion));
  objects.softs[0].triangles.clear(), objects.softs[0].vertices = -1;
  EXPECT_FALSE(decodeObjects(encodeObjects(objects), kVersion));
}

TEST(Recording, RubbishIsAnErrorAndNoCrash) {
  const TemporaryFile file(kEnding);
  std::mt19937 random(13);
  for (int round = 0; round < 200; ++round) {
    std::vector<char> bytes(random() % 400);
    for (char& byte : bytes) byte = static_cast<char>(random());
    const std::string magic = "RUBBLE\r\n";
    if (round % 2 == 0 && bytes.size() > magic.size()) std::copy(magic.begin(), magic.end(), bytes.begin());
    writeAll(file.path, bytes);
    EXPECT_FALSE(readsThrough(file.path));
  }
  EXPECT_THROW(RecordingReader{"/nowhere/at/all.rubble"}, Error);
}

TEST(Recording, TheWriterSaysWhatIsWrong) {
  EXPECT_THROW(RecordingWriter("/nowhere/at/all.rubble", {}), Error);
  const TemporaryFile file(kEnding);
  RecordingWriter writer(file.path, {});
  EXPECT_THROW(writer.write({}, {0, 0, {RecordedPose{}}}), Error);
  EXPECT_THROW(writer.write({}, {0, 0, {}, {Vec3{}}}), Error);
  writer.finish();
  EXPECT_THROW(writer.write({}, {}), Error);
}

}  // namespace
}  // namespace rubble::io
