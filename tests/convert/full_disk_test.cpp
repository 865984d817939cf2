/// Exports to a disk that is full.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include <rubble/error.h>
#include <rubble/world.h>

#include "convert/out/export.h"
#include "tests/io/whole_files.h"
#include "tests/support/files.h"
#include "tests/support/full_disk.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kFrames = 12;

/// A heap and a cloth.
void record(const std::string& file) {
  Scene scene = test::heap(2);
  scene.deformables.emplace_back(clothSheet({5, 0, 2}, {1, 0, 0}, {0, 1, 0}, 6, 6));
  World world(scene, test::options(4, "cpu", 1));
  io::RecordingWriter writer(file, {"a test", 1 / 60., {0, 0, -9.81}, 1e-5});
  for (int frame = 0; frame < kFrames; ++frame) {
    world.step();
    writer.write(io::recordedBodies(world), io::recordedFrame(world), io::recordedSofts(world));
  }
  writer.finish();
}

std::uintmax_t bytesIn(const std::filesystem::path& folder) {
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) bytes += entry.file_size();
  return bytes;
}

TEST(Export, OfEveryFormatToAFullDiskIsAnErrorAndLeavesNoPart) {
  const test::TemporaryFolder source;
  const std::string run = (source.path / "run.rubble").string();
  record(run);
  for (const std::string& ending : convert::exportEndings()) {
    const test::TemporaryFolder folder;
    const std::string file = (folder.path / ("frames" + ending)).string();
    const auto write = [&] {
      io::RecordingReader recording(run);
      convert::exportRecording(recording, file);
    };
    write();
    const std::uintmax_t bytes = bytesIn(folder.path);
    ASSERT_GT(bytes, 1000u) << ending;
    for (const std::uintmax_t cut : {std::uintmax_t{0}, std::uintmax_t{1}, bytes / 4, bytes / 2, bytes - 1}) {
      std::filesystem::remove(file);
      {
        const test::FullDisk full(cut);
        EXPECT_THROW(write(), Error) << ending << " " << cut;
      }
      // tables of text grow frame by frame, so that an export that was cut off can go on
      EXPECT_TRUE(ending == ".csv" || std::filesystem::is_empty(folder.path)) << ending << " " << cut;
    }
    write();
    EXPECT_EQ(bytesIn(folder.path), bytes) << ending;
  }
}

/// Each write of each export fails, but for tables of text, which grow frame by frame.
template <class Failing> void expectWholeExports() {
  const test::TemporaryFolder source;
  const std::string run = (source.path / "run.rubble").string();
  record(run);
  for (const std::string& ending : convert::exportEndings()) {
    if (ending == ".csv") continue;
    const bool isOne = ending != ".obj";
    test::expectWholeOrAsBefore<Failing>(
        "frames" + ending,
        [&](const std::string& file) {
          io::RecordingReader recording(run);
          convert::exportRecording(recording, file);
        },
        isOne);
  }
}

TEST(Export, OfEveryFormatThatFailsAtAWriteLeavesNoPart) {
  if (!test::writesFail()) GTEST_SKIP() << "a sanitizer has functions of its own";
  expectWholeExports<test::FailingWrites>();
}

TEST(Export, OfATableThatFailsAtAWriteKeepsItsWholeFramesAndGoesOn) {
  if (!test::writesFail()) GTEST_SKIP() << "a sanitizer has functions of its own";
  const test::TemporaryFolder folder;
  const std::string run = (folder.path / "run.rubble").string(), whole = (folder.path / "whole.csv").string();
  record(run);
  const auto write = [&](const std::string& file, bool resume) {
    io::RecordingReader recording(run);
    convert::ExportOptions options;
    options.resume = resume;
    convert::exportRecording(recording, file, options);
  };
  write(whole, false);
  for (long n = 0; n < 1000; ++n) {
    const std::string file = (folder.path / ("part" + std::to_string(n) + ".csv")).string();
    bool threw = false;
    const bool failed = test::failsAt<test::FailingWrites>(n, true, threw, [&] { write(file, false); });
    EXPECT_EQ(threw, failed) << n;
    write(file, true);
    EXPECT_EQ(test::contentOf(file) == test::contentOf(whole), true) << n;
    if (!failed || testing::Test::HasFailure()) break;
  }
}

}  // namespace
}  // namespace rubble
