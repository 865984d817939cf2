/// Recorded hashes of scenes on the CPU (tests/golden.txt): the same for every compiler, instruction set and
/// number of threads. They change with the method only. If this test fails while all others pass, check
/// whether the change was intended, and put the row of the message into the table.
#include <gtest/gtest.h>
#include <rubble/info.h>

#include <set>

#include "tests/support/golden.h"

namespace rubble {
namespace {

constexpr int kFewSteps = 30, kManySteps = 300;

void expectRecorded(const test::Golden& golden, const std::string& instructionSet = "") {
  WorldOptions options;
  options.instructionSet = instructionSet;
  const std::uint64_t hash = test::hashOf(golden, options);
  EXPECT_EQ(hash, golden.hash) << test::rowOf(golden, hash) << " " << instructionSet;
}

/// Scenes after `steps` steps with each instruction set of this machine but the one that runs by default.
void expectRecordedWithOtherSets(int steps, const std::set<std::string>& scenes) {
  const std::vector<std::string> sets = instructionSets();
  if (sets.size() < 2) GTEST_SKIP() << "one instruction set";
  for (const test::Golden& golden : test::goldens("cpu", steps))
    for (const std::string& set : sets)
      if (set != sets.back() && (scenes.empty() || scenes.contains(golden.scene)))
        expectRecorded(golden, set);
}

class Golden : public testing::TestWithParam<test::Golden> {};
class LongGolden : public testing::TestWithParam<test::Golden> {};

TEST_P(Golden, HashIsTheRecordedOne) { expectRecorded(GetParam()); }
TEST_P(LongGolden, HashIsTheRecordedOne) { expectRecorded(GetParam()); }

TEST(GoldenTable, HashesAreTheRecordedOnesWithEveryInstructionSet) {
  expectRecordedWithOtherSets(kFewSteps, {"pile-1k", "joint-grid", "every-shape", "rolling", "soft-dent"});
}
TEST(LongGoldenTable, HashesAreTheRecordedOnesWithEveryInstructionSet) {
  expectRecordedWithOtherSets(kFewSteps, {});
  expectRecordedWithOtherSets(kManySteps, {});
}

constexpr auto kName = [](const auto& info) { return info.param.name(); };
INSTANTIATE_TEST_SUITE_P(Scenes, Golden, testing::ValuesIn(test::goldens("cpu", kFewSteps)), kName);
INSTANTIATE_TEST_SUITE_P(LongScenes, LongGolden, testing::ValuesIn(test::goldens("cpu", kManySteps)), kName);

TEST(GoldenTable, HasFortyScenesAfterFewStepsAndMany) {
  EXPECT_GE(test::goldens("cpu", kFewSteps).size(), 40u);
  EXPECT_GE(test::goldens("cpu", kManySteps).size(), 40u);
}

}  // namespace
}  // namespace rubble
