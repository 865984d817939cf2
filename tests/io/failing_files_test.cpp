/// Each write and each allocation of every writer fails once, and with all after it.
#include <gtest/gtest.h>

#include "io/input_log.h"
#include "io/mesh_file.h"
#include "io/picture.h"
#include "io/recording.h"
#include "io/scene_json.h"
#include "tests/io/whole_files.h"
#include "tests/support/meshes.h"
#include "tests/support/scenes.h"

namespace rubble::io {
namespace {

using test::expectWholeOrAsBefore;
using test::FailingMemory;
using test::FailingWrites;

struct FailingWriter {
  std::string name;
  std::function<void(const std::string&)> write;
};
/// Each writes more than one buffer of a stream.
std::vector<FailingWriter> failingWriters() {
  const TriangleMesh ring = test::torusMesh(1, .4, 24, 12);
  const TetrahedronMesh solid = tetrahedralize(test::cubeMesh(), .5);
  std::mt19937 random(3);
  Image noise{64, 64, std::vector<std::uint8_t>(64 * 64 * 3)};
  for (std::uint8_t& c : noise.rgb) c = static_cast<std::uint8_t>(random());
  const std::vector<std::uint16_t> depths(64 * 64, 1000);
  const std::string text(100000, 'x');
  return {{"ring.obj", [=](const std::string& file) { writeObj(file, ring); }},
          {"solid.msh", [=](const std::string& file) { writeMsh(file, solid); }},
          {"noise.png", [=](const std::string& file) { writePng(noise, file); }},
          {"depths.png", [=](const std::string& file) { writePng16(64, 64, 1, depths, file); }},
          {"text.json", [=](const std::string& file) { writeText(file, text); }}};
}

TEST(FailingWrite, OfAWriterLeavesTheWholeFileOrWhatWasThere) {
  if (!test::writesFail()) GTEST_SKIP() << "a sanitizer has functions of its own";
  for (const FailingWriter& writer : failingWriters())
    expectWholeOrAsBefore<FailingWrites>(writer.name, writer.write);
}

TEST(FailingWrite, OfALogOfInputsLeavesTheWholeFileOrWhatWasThere) {
  if (!test::writesFail()) GTEST_SKIP() << "a sanitizer has functions of its own";
  const Scene scene = test::heap(2);
  const WorldOptions options = test::options(4, "cpu", 1);
  expectWholeOrAsBefore<FailingWrites>("log.txt", [&](const std::string& file) {
    World world(scene, options);
    InputLog inputs(file, scene, options, world);
    test::run(world, 20);
    inputs.finish();
  });
}

TEST(FailingAllocation, OfAWriterLeavesTheWholeFileOrWhatWasThere) {
  if (!test::countsAllocations()) GTEST_SKIP() << "a sanitizer has operators of its own";
  for (const FailingWriter& writer : failingWriters())
    expectWholeOrAsBefore<FailingMemory>(writer.name, writer.write);
}

/// A recorded run: bodies that change on the way, in several chunks.
struct RecordedRun {
  std::vector<std::vector<RecordedBody>> bodies;
  std::vector<RecordedFrame> frames;

  RecordedRun() {
    World world(test::heap(2), test::options(4, "cpu", 1));
    for (int frame = 0; frame < 70; ++frame) {
      if (frame == 40) world.addBody(test::unitCube({0, 0, 9}));
      world.step();
      bodies.push_back(recordedBodies(world)), frames.push_back(recordedFrame(world));
    }
  }
  void record(const std::string& file) const {
    RecordingOptions options;
    options.threads = 1;
    RecordingWriter writer(file, {"a test", 1 / 60., {0, 0, -9.81}, 1e-5}, options);
    for (std::size_t k = 0; k < frames.size(); ++k) writer.write(bodies[k], frames[k]);
    writer.finish();
  }
};

TEST(FailingWrite, OfARecordingLeavesItsWholeChunks) {
  if (!test::writesFail()) GTEST_SKIP() << "a sanitizer has functions of its own";
  const RecordedRun run;
  for (const bool lasting : {false, true})
    for (long n = 0; n < 1000; ++n) {
      const test::TemporaryFolder folder;
      const std::string file = (folder.path / "run.rubble").string();
      bool threw = false;
      const bool failed = test::failsAt<FailingWrites>(n, lasting, threw, [&] { run.record(file); });
      EXPECT_EQ(threw, failed) << n;
      if (!failed) break;
      // a header that is no whole one is none
      if (n < 3) continue;
      RecordingReader reader(file);
      EXPECT_FALSE(reader.complete()) << n;
      for (int frame = 0; frame < reader.frameCount(); ++frame)
        EXPECT_EQ(reader.frame(frame).step, frame + 1) << n;
    }
}

}  // namespace
}  // namespace rubble::io
