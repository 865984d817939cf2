/// A recording has the bytes that one process writes, however many threads or processes pack it.
#include <backend/distributed/thread_transport.h>
#include <gtest/gtest.h>
#include <io/recording.h>

#include <cmath>
#include <functional>
#include <thread>

#include "tests/support/files.h"

namespace rubble {
namespace {

using io::RecordedBody;
using io::RecordedFrame;

/// Bodies that turn and drift. A chunk of their frames has several pieces, and those of one body a single
/// one; a body that comes ends a chunk early.
struct Frames {
  int bodies, frames, comes;
  std::vector<RecordedBody> bodiesAt(int frame) const {
    std::vector<RecordedBody> out;
    for (int i = 0; i < bodies + (frame >= comes ? 1 : 0); ++i)
      out.push_back({"", Shape::box({.1, .1, .1}), Motion::Dynamic, {i, 1}});
    return out;
  }
  RecordedFrame frameAt(int frame) const {
    RecordedFrame out{frame, frame / 60., {}};
    for (int i = 0; i < bodies + (frame >= comes ? 1 : 0); ++i) {
      const double angle = .1 * frame + i;
      out.poses.push_back(
          {{i + std::sin(angle), 1e-3 * frame * i, 0}, {std::cos(angle), {0, std::sin(angle), 0}}});
    }
    return out;
  }
};

void write(const Frames& run, const std::string& file, const io::RecordingOptions& options) {
  io::RecordingWriter writer(file, {"a test", 1 / 60., {0, 0, -9.81}, 1e-5}, options);
  for (int i = 0; i < run.frames; ++i) writer.write(run.bodiesAt(i), run.frameAt(i));
  writer.finish();
}

/// Calls task(transport) in a thread for each rank; returns what each one threw, or "".
std::vector<std::string> onRanks(int ranks, const std::function<void(Transport&)>& task) {
  ThreadHub hub(ranks, 30);
  std::vector<std::string> errors(static_cast<std::size_t>(ranks));
  std::vector<std::thread> threads;
  for (int r = 0; r < ranks; ++r)
    threads.emplace_back([&, r] {
      const std::unique_ptr<Transport> transport = hub.join(r);
      try {
        task(*transport);
      } catch (const Error& error) {
        errors[static_cast<std::size_t>(r)] = error.what();
      }
    });
  for (std::thread& thread : threads) thread.join();
  return errors;
}

TEST(RecordingOfRanks, HasTheBytesOfOne) {
  const test::TemporaryFolder folder;
  const std::string one = (folder.path / "one.rubble").string(),
                    many = (folder.path / "many.rubble").string();
  for (const Frames& run : {Frames{4000, 45, 40}, Frames{60000, 3, 2}, Frames{1, 3, 9}, Frames{0, 2, 9}}) {
    write(run, one, {.threads = 1});
    const std::string bytes = test::contentOf(one);
    write(run, many, {.threads = 3});
    EXPECT_EQ(test::contentOf(many) == bytes, true) << run.bodies << " bodies, three threads";
    for (const int ranks : {1, 2, 3}) {
      for (const std::string& error : onRanks(ranks, [&](Transport& transport) {
             write(run, many, {.threads = 1, .transport = &transport});
           }))
        EXPECT_EQ(error, "");
      EXPECT_EQ(test::contentOf(many) == bytes, true) << run.bodies << " bodies, " << ranks << " ranks";
    }
    io::RecordingReader reader(many);
    EXPECT_TRUE(reader.complete());
    ASSERT_EQ(reader.frameCount(), run.frames);
    for (int i = 0; i < run.frames; ++i) {
      const RecordedFrame read = reader.frame(i), wrote = run.frameAt(i);
      ASSERT_EQ(read.poses.size(), wrote.poses.size());
      for (std::size_t k = 0; k < read.poses.size(); k += 97)
        EXPECT_NEAR(length(read.poses[k].position - wrote.poses[k].position), 0, 1e-5);
    }
  }
}

TEST(RecordingOfRanks, EndsForAllIfOneCannotWrite) {
  const std::vector<std::string> errors = onRanks(3, [](Transport& transport) {
    write({1, 1, 9}, "/nowhere/at/all.rubble", {.threads = 1, .transport = &transport});
  });
  EXPECT_EQ(errors[0].find("/nowhere/at/all.rubble"), 0u) << errors[0];
  for (const std::size_t r : {1u, 2u})
    EXPECT_EQ(errors[r].find("rank 0 failed: /nowhere/at/all.rubble"), 0u) << errors[r];
}

TEST(RecordingOfRanks, EndsForAllIfOneHasNoFrame) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path / "run.rubble").string();
  const std::vector<std::string> errors = onRanks(3, [&](Transport& transport) {
    const Frames run{2, 1, 9};
    io::RecordingWriter writer(file, {"a test", 1 / 60., {}, 1e-5}, {.threads = 1, .transport = &transport});
    RecordedFrame frame = run.frameAt(0);
    if (transport.rank() == 1) frame.poses.pop_back();
    writer.write(run.bodiesAt(0), frame);
    writer.finish();
  });
  EXPECT_EQ(errors[1].find("recording.frame"), 0u) << errors[1];
  for (const std::size_t r : {0u, 2u})
    EXPECT_EQ(errors[r].find("rank 1 failed: recording.frame"), 0u) << errors[r];
}

}  // namespace
}  // namespace rubble
