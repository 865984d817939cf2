/// Every scene of the registry at test size: single against double precision over the first steps, before
/// chaos parts them.
#include <gtest/gtest.h>
#include <scenes/registry.h>

#include <algorithm>
#include <cctype>

#include "tests/support/expect.h"
#include "tests/support/many_threads.h"

namespace rubble {
namespace {

constexpr int kSteps = 10;
/// [m] in a metre-sized scene whose bodies move by up to metres a second
constexpr double kPosition = 2e-3;
constexpr double kAngle = 5e-3;

scenes::Job jobOf(const std::string& name) {
  const scenes::Spec& spec = scenes::find(name);
  return scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
}

WorldOptions optionsOf(const scenes::Job& job, const std::string& backend) {
  WorldOptions options;
  options.backend = backend;
  options.threads = 1;
  options.params.iterations = job.iterations;
  options.params.substeps = job.substeps;
  // the sign of a gap decides whether a row is active, and is round-off where bodies just touch
  options.params.tuning.dormantRows = false;
  return options;
}

class Parity : public ::testing::TestWithParam<std::string> {};

TEST_P(Parity, OfCpuAndReferenceOverTenSteps) {
  scenes::Runner cpu(jobOf(GetParam()), optionsOf(jobOf(GetParam()), "cpu"));
  scenes::Runner reference(jobOf(GetParam()), optionsOf(jobOf(GetParam()), "reference"));
  for (int i = 0; i < kSteps; ++i) {
    const StepReport a = cpu.step(), b = reference.step();
    EXPECT_EQ(a.bodies, b.bodies);
    EXPECT_EQ(a.clashes, 0);
    EXPECT_EQ(a.quarantined, 0);
  }
  const std::vector<BodyId> ids = cpu.world().bodies();
  ASSERT_EQ(ids, reference.world().bodies());
  const std::vector<DeformableId> softIds = cpu.world().deformables();
  ASSERT_EQ(softIds, reference.world().deformables());
  ASSERT_FALSE(ids.empty() && softIds.empty());
  double worst = 0, worstAngle = 0;
  for (const BodyId id : ids) {
    const BodyState a = cpu.world().state(id), b = reference.world().state(id);
    worst = std::max(worst, length(a.position - b.position));
    worstAngle = std::max(worstAngle, test::angleBetween(a.orientation, b.orientation));
  }
  for (const DeformableId id : softIds) {
    const std::vector<Vec3> a = cpu.world().positions(id), b = reference.world().positions(id);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, length(a[i] - b[i]));
  }
  RecordProperty("worst_um", static_cast<int>(worst * 1e6));
  EXPECT_LT(worst, kPosition);
  EXPECT_LT(worstAngle, kAngle);
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const scenes::Spec& spec : scenes::registry()) out.push_back(spec.name);
  return out;
}

INSTANTIATE_TEST_SUITE_P(Registry, Parity, ::testing::ValuesIn(names()), [](const auto& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
});

/// Scenes of the registry with deformable objects.
std::vector<std::string> softNames() {
  std::vector<std::string> out = names();
  std::erase_if(out, [](const std::string& name) { return jobOf(name).scene.deformables.empty(); });
  return out;
}

/// The first difference between the two engines of a lockstep, over so many steps.
std::string firstDifference(const std::string& name, const std::string& backend, int threads, int steps) {
  WorldOptions options = optionsOf(jobOf(name), backend);
  options.threads = threads;
  scenes::Runner lockstep(jobOf(name), options);
  for (int i = 0; i < steps; ++i) lockstep.step();
  return lockstep.world().firstDifference();
}

TEST(Parity, OfManyThreadsIsExactForDeformableObjects) {
  ASSERT_FALSE(softNames().empty());
  for (const std::string& name : softNames())
    EXPECT_EQ(firstDifference(name, "lockstep", 3, kSteps), "") << name;
}

/// Every loop of a step gives the same from its last element to its first, as threads and lanes of a device
/// may take them. Threads alone seldom meet in the order that shows a difference.
TEST(Parity, OfLoopsThatRunBackwardIsExactForDeformableObjects) {
  for (const std::string& name : softNames())
    EXPECT_EQ(firstDifference(name, "lockstep-backward", 1, kSteps), "") << name;
}

TEST(LongParity, OfLoopsThatRunBackwardIsExact) {
  constexpr int kLongSteps = 120;
  for (const std::string& name : names())
    EXPECT_EQ(firstDifference(name, "lockstep-backward", 1, kLongSteps), "") << name;
}

TEST(Parity, OfManyThreadsIsExact) {
  const test::ManyThreads manyThreads(4);
  scenes::Runner one(jobOf("pile-1k"), optionsOf(jobOf("pile-1k"), "cpu"));
  WorldOptions options = optionsOf(jobOf("pile-1k"), "cpu");
  options.threads = 3;
  scenes::Runner three(jobOf("pile-1k"), options);
  for (int i = 0; i < kSteps; ++i) one.step(), three.step();
  EXPECT_EQ(one.world().hash(), three.world().hash());
}

}  // namespace
}  // namespace rubble
