/// Worlds inside of other programs: forks, threads, the log (docs/embedding.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kSteps = 5;

std::uint64_t hashAfter(World& world, int steps) {
  test::run(world, steps);
  return world.hash();
}

/// Does f() in a child process return true there?
template <class F> bool holdsInChild(F&& f) {
  const pid_t child = fork();
  if (child == 0) {
    bool holds = false;
    try {
      holds = f();
    } catch (...) {
    }
    _exit(holds ? 0 : 1);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Fork, LeavesTheChildAWorldOfOneThread) {
  World world(test::heap(3), test::options(4, "cpu", 1));
  test::run(world, kSteps);
  const Snapshot snapshot = world.snapshot();
  const std::uint64_t expected = hashAfter(world, kSteps);
  world.restore(snapshot);
  EXPECT_TRUE(holdsInChild([&] {
    World own(test::heap(3), test::options(4, "cpu", 1));
    return hashAfter(world, kSteps) == expected && hashAfter(own, 2 * kSteps) == expected;
  }));
  EXPECT_EQ(hashAfter(world, kSteps), expected);
}

TEST(World, IsSteppedFromAnyThread) {
  World world(test::heap(3), test::options(4, "cpu", 2)),
      reference(test::heap(3), test::options(4, "cpu", 2));
  for (int k = 0; k < 8; ++k) {
    std::thread([&] { world.step(); }).join();
    reference.step();
  }
  EXPECT_EQ(world.hash(), reference.hash());
}

TEST(World, IsIndependentOfOthersThatStepBesideIt) {
  constexpr int kWorlds = 4;
  World reference(test::heap(3), test::options(4, "cpu", 1));
  const std::uint64_t expected = hashAfter(reference, 2 * kSteps);
  std::vector<std::uint64_t> hashes(kWorlds);
  std::vector<std::thread> threads;
  for (int k = 0; k < kWorlds; ++k)
    threads.emplace_back([&, k] {
      World world(test::heap(3), test::options(4, "cpu", k % 2 + 1));
      hashes[static_cast<std::size_t>(k)] = hashAfter(world, 2 * kSteps);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(hashes, std::vector<std::uint64_t>(kWorlds, expected));
}

TEST(Log, HasWhatTheReportHasAndNothingElseIsWritten) {
  std::vector<std::string> lines;
  int warnings = 0;
  WorldOptions options = test::options(4);
  options.log = [&](LogLevel level, std::string_view line) {
    lines.emplace_back(line);
    warnings += level == LogLevel::Warning;
  };
  Scene scene = test::heap(2);
  scene.joints.push_back(test::ball(kWorld, {9, 0, 9}, 1, {0, 0, 0}));
  scene.joints.back().breakForce = 1;
  testing::internal::CaptureStdout(), testing::internal::CaptureStderr();
  World world(scene, options);
  std::size_t notable = 0;
  for (int k = 0; k < 2 * kSteps; ++k) {
    const StepReport report = world.step();
    notable += report.grown.size() + (report.brokenJoints > 0);
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(notable, 1u);
  EXPECT_EQ(lines.size() - static_cast<std::size_t>(warnings), notable);
  EXPECT_NE(std::ranges::find_if(lines, [](const auto& l) { return l.ends_with("1 joints broke"); }),
            lines.end());
  // a log that throws does not disturb the world
  options.log = [](LogLevel, std::string_view) { throw std::runtime_error("full"); };
  World other(scene, options);
  EXPECT_THROW(test::run(other, 2 * kSteps), std::runtime_error);
  while (other.stepCount() < world.stepCount()) {
    try {
      other.step();
    } catch (const std::runtime_error&) {
    }
  }
  EXPECT_EQ(other.hash(), world.hash());
}

}  // namespace
}  // namespace rubble
