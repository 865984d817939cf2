/// Files are written completely or not at all.
#include <gtest/gtest.h>
#include <rubble/error.h>

#include <functional>
#include <set>

#include <sys/stat.h>
#include <unistd.h>

#include "io/input_log.h"
#include "io/mesh_file.h"
#include "io/output_file.h"
#include "io/picture.h"
#include "io/recording.h"
#include "io/scene_json.h"
#include "tests/support/files.h"
#include "tests/support/full_disk.h"
#include "tests/support/meshes.h"
#include "tests/support/scenes.h"

namespace rubble::io {
namespace {

using test::FullDisk;
using test::TemporaryFolder;

std::set<std::string> namesIn(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

struct Writer {
  std::string ending;
  std::function<void(const std::string&)> write;
};
/// Each writes more than 2 kB.
std::vector<Writer> writers() {
  const TriangleMesh ring = test::torusMesh(1, .4, 24, 12);
  const TetrahedronMesh solid = tetrahedralize(test::cubeMesh(), .3);
  std::mt19937 random(3);
  Image noise{64, 64, std::vector<std::uint8_t>(64 * 64 * 3)};
  for (std::uint8_t& c : noise.rgb) c = static_cast<std::uint8_t>(random());
  return {{".obj", [=](const std::string& file) { writeObj(file, ring); }},
          {".msh", [=](const std::string& file) { writeMsh(file, solid); }},
          {".png", [=](const std::string& file) { writePng(noise, file); }},
          {".json", [=](const std::string& file) { writeText(file, std::string(100000, 'x')); }}};
}

TEST(OutputFile, OfEveryWriterLeavesWhatWasThereOnAFullDisk) {
  for (const Writer& writer : writers())
    for (const bool isThere : {false, true}) {
      const TemporaryFolder folder;
      const std::string file = (folder.path / ("file" + writer.ending)).string();
      if (isThere) std::ofstream(file) << "before";
      {
        const FullDisk full(2000);
        EXPECT_THROW(writer.write(file), Error) << writer.ending;
      }
      EXPECT_EQ(namesIn(folder.path),
                isThere ? std::set<std::string>{"file" + writer.ending} : std::set<std::string>{});
      if (isThere) {
        EXPECT_EQ(test::contentOf(file), "before");
      }
      writer.write(file);
      EXPECT_GT(std::filesystem::file_size(file), 2000u) << writer.ending;
      EXPECT_EQ(namesIn(folder.path).size(), 1u);
    }
}

/// Sizes at which a file of `bytes` is cut off: at its start, inside of it, and before its last byte.
std::vector<rlim_t> cutsOf(std::uintmax_t bytes) { return {0, 1, bytes / 4, bytes / 2, bytes - 1}; }

/// Records a falling heap.
void record(const std::string& file) {
  World world(test::heap(3), test::options(4, "cpu", 1));
  RecordingWriter writer(file, {"a test", 1 / 60., {0, 0, -9.81}, 1e-5});
  for (int frame = 0; frame < 70; ++frame) {
    world.step();
    writer.write(recordedBodies(world), recordedFrame(world));
  }
  writer.finish();
}

TEST(Recording, OfAFullDiskIsAnErrorAndHasItsWholeChunks) {
  const TemporaryFolder folder;
  const std::string file = (folder.path / "run.rubble").string();
  record(file);
  for (const rlim_t cut : cutsOf(std::filesystem::file_size(file))) {
    {
      const FullDisk full(cut);
      EXPECT_THROW(record(file), Error) << cut;
    }
    EXPECT_LE(std::filesystem::file_size(file), cut);
    if (cut <= 1) continue;
    RecordingReader reader(file);
    EXPECT_FALSE(reader.complete()) << cut;
    for (int frame = 0; frame < reader.frameCount(); ++frame) EXPECT_EQ(reader.frame(frame).step, frame + 1);
  }
}

TEST(InputLog, OfAFullDiskIsAnErrorAndLeavesWhatWasThere) {
  const TemporaryFolder folder;
  const std::string file = (folder.path / "log.txt").string();
  const Scene scene = test::heap(2);
  const WorldOptions options = test::options(4, "cpu", 1);
  const auto log = [&] {
    World world(scene, options);
    InputLog inputs(file, scene, options, world);
    test::run(world, 20);
    inputs.finish();
  };
  log();
  const std::string before = test::contentOf(file);
  for (const rlim_t cut : cutsOf(before.size())) {
    const FullDisk full(cut);
    EXPECT_THROW(log(), Error) << cut;
  }
  EXPECT_EQ(test::contentOf(file), before);
  EXPECT_EQ(namesIn(folder.path).size(), 1u);
}

TEST(OutputFile, KeepsPermissionsAndLinks) {
  const TemporaryFolder folder;
  const auto file = folder.path / "real.json", link = folder.path / "link.json";
  std::ofstream(file) << "before";
  std::filesystem::permissions(file,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  std::filesystem::create_symlink("real.json", link);
  writeText(link.string(), "after");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(test::contentOf(file), "after");
  EXPECT_EQ(std::filesystem::status(file).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST(OutputFile, NeverReplacesADeviceOrAFolder) {
  const TemporaryFolder folder;
  EXPECT_THROW(writeText(folder.path.string(), "text"), Error);
  EXPECT_NO_THROW(writeText("/dev/null", "text"));
  EXPECT_FALSE(std::filesystem::is_regular_file("/dev/null"));
  EXPECT_THROW(writeText("/dev/full", "text"), Error);
  EXPECT_THROW(writeText((folder.path / "none" / "file").string(), "text"), Error);
  const auto pipe = folder.path / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::fstream reader(pipe, std::ios::in | std::ios::out);
  writeText(pipe.string(), "text\n");
  std::string line;
  std::getline(reader, line);
  EXPECT_EQ(line, "text");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST(Recording, HasOneWriter) {
  const TemporaryFolder folder;
  const std::string file = (folder.path / "run.rubble").string();
  const RecordingHeader header{"a test", 1 / 60., {0, 0, -9.81}, 1e-5};
  {
    RecordingWriter first(file, header);
    EXPECT_THROW(RecordingWriter(file, header), Error);
    first.finish();
  }
  EXPECT_TRUE(RecordingReader(file).complete());
  EXPECT_NO_THROW(RecordingWriter(file, header).finish());
}

}  // namespace
}  // namespace rubble::io
