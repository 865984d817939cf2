/// The verdict of every scene of the registry, at the size that a test can afford.
#include <gtest/gtest.h>
#include <scenes/registry.h>

#include <algorithm>
#include <cctype>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

class Verdict : public ::testing::TestWithParam<std::string> {};

TEST_P(Verdict, HoldsAtTestSize) {
  const scenes::Spec& spec = scenes::find(GetParam());
  scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
  const int steps = spec.testSteps > 0 ? spec.testSteps : job.steps;
  WorldOptions options = test::options(job.iterations);
  options.params.substeps = job.substeps;
  const scenes::RunResult result = scenes::Runner(std::move(job), options).run(steps);
  for (const scenes::ClaimResult& c : result.verdict.results)
    EXPECT_TRUE(c.holds) << c.claim.metric << " = " << c.value << ", wanted " << c.claim.min << " to " << c.claim.max << ": " << c.claim.why;
}

/// Scenes whose verdict does not hold yet; docs/scenes.md says what is missing ("Open").
const std::vector<std::string> kOpen = {"chain", "chain-100-1000", "chain-1000-1000", "swing", "pendulum-50-50000"};

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const scenes::Spec& spec : scenes::registry()) {
    const bool scale = std::find(spec.tags.begin(), spec.tags.end(), "scale") != spec.tags.end();
    const bool open = std::find(kOpen.begin(), kOpen.end(), spec.name) != kOpen.end();
    if (!scale && !open) out.push_back(spec.name);
  }
  return out;
}

std::string testName(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace_if(name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
}

/// What holds of the hanging chain of 100 links with 1000 times their mass at its end.
TEST(Chain, OfAHundredLinksUnderAThousandfoldLoadStretchesLessThanTwoPercent) {
  const scenes::Spec& spec = scenes::find("chain-100-1000");
  scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, {}));
  const int steps = job.steps;
  const WorldOptions options = test::options(4);
  const scenes::RunResult result = scenes::Runner(std::move(job), options).run(steps);
  EXPECT_LT(result.metrics.at("stretch"), .02);
}

INSTANTIATE_TEST_SUITE_P(Registry, Verdict, ::testing::ValuesIn(names()), testName);

}  // namespace
}  // namespace rubble
