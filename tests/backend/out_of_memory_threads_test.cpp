/// Allocations that fail in other threads than that of the caller, which gets the error.
#include <thread>

#include "tests/backend/failing_worlds.h"

namespace rubble {
namespace {

using test::FailingMemoryOfOthers;
using test::Outcome;
using test::WorldsCall;

/// Every task runs on a thread of its own, one after another, so that allocations have an order.
WorldOptions onOtherThreads() {
  WorldOptions options = test::optionsOfWorlds();
  options.tasks.parts = 2;
  options.tasks.run = [](int count, TaskSystem::Task task, void* context) {
    for (int k = 0; k < count; ++k) std::thread([=] { task(context, k); }).join();
  };
  return options;
}

std::vector<WorldsCall> callsOnThreads() {
  return {
      {"array", [](Worlds& w) { w.array(StateArray::Position); }},
      {"sensorArray", [](Worlds& w) { w.array(SensorArray::Touch); }},
      {"castRays",
       [](Worlds& w) {
         static const std::vector<Worlds::WorldRay> rays{{0, {{0, 0, 9}, {0, 0, -1}, 100, {}}},
                                                         {test::kCopies, {{5, 0, 9}, {0, 0, -1}, 100, {}}}};
         w.castRays(rays);
       }},
      {"reset",
       [](Worlds& w) {
         static const std::array some{4, 0, 32};
         const Snapshot now = w[4].snapshot();
         w.reset(some, {&now, 1});
       }},
  };
}

TEST(OutOfMemoryOfAThread, ReachesTheCallerAndChangesNothing) {
  if (!test::countsAllocations()) GTEST_SKIP() << "a sanitizer has operators of its own";
  test::expectUndisturbedWorlds<FailingMemoryOfOthers>(callsOnThreads(), false, onOtherThreads());
}

/// Steps on threads whose allocations fail: no world loses its step count, its poses or its report.
void expectStepped(const WorldOptions& options, bool always) {
  Worlds reference = test::startedWorlds(options);
  reference.step();
  const std::vector<std::uint64_t> stepped = test::hashesOf(reference);
  bool everFailed = false;
  for (long k = 0; k < 400; ++k) {
    Worlds worlds = test::startedWorlds(options);
    const Outcome outcome = test::outcomeWithout<FailingMemoryOfOthers>(k, false, "step",
                                                                        [&] { worlds.step(); });
    everFailed |= outcome == Outcome::OutOfMemory;
    for (int w = 0; w < test::kWorlds; ++w) {
      EXPECT_TRUE(worlds[w].stepCount() == 2 || worlds[w].stepCount() == 3);
      if (worlds[w].stepCount() == 3) {
        EXPECT_EQ(worlds[w].hash(), stepped[static_cast<std::size_t>(w)]) << k << " " << w;
      }
    }
    worlds.step(3);
    EXPECT_TRUE(std::isfinite(worlds[test::kCopies].quality().maxSpeed));
    if (outcome == Outcome::Whole || testing::Test::HasFailure()) break;
  }
  // with other threads of the library none of them may have come
  EXPECT_TRUE(everFailed || !always);
}

TEST(OutOfMemoryOfAThread, InAStepKeepsPosesOrTakesTheStep) {
  if (!test::countsAllocations()) GTEST_SKIP() << "a sanitizer has operators of its own";
  expectStepped(onOtherThreads(), true);
  WorldOptions threads = test::optionsOfWorlds();
  threads.threads = 3;
  expectStepped(threads, false);
}

}  // namespace
}  // namespace rubble
