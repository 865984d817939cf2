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
    EXPECT_TRUE(c.holds) << c.claim.metric << " = " << c.value << ", wanted " << c.claim.min << " to "
                         << c.claim.max << ": " << c.claim.why;
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const scenes::Spec& spec : scenes::registry()) {
    const bool scale = std::find(spec.tags.begin(), spec.tags.end(), "scale") != spec.tags.end();
    if (!scale) out.push_back(spec.name);
  }
  return out;
}

std::string testName(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Registry, Verdict, ::testing::ValuesIn(names()), testName);

}  // namespace
}  // namespace rubble
