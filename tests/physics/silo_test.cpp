/// Grains in tall bins, however they are filled in: walls bear a part of their weight, and the floor the rest.
#include <gtest/gtest.h>
#include <scenes/registry.h>

#include <string>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

struct Filling {
  std::string name;
  scenes::Arguments arguments;
  double leastK = .3;
};

class Silo : public ::testing::TestWithParam<Filling> {
 protected:
  static scenes::Metrics run(int iterations) {
    const scenes::Spec& spec = scenes::find("silo");
    scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, GetParam().arguments));
    return scenes::Runner(std::move(job), test::options(iterations)).run(spec.steps).metrics;
  }
};

TEST_P(Silo, HangsOnItsWallsByJanssensLawAtTenIterations) {
  const scenes::Metrics metrics = run(10);
  EXPECT_GE(metrics.at("janssen_k"), GetParam().leastK);
  EXPECT_LE(metrics.at("janssen_k"), 1);
  EXPECT_NEAR(metrics.at("floor_ratio") + metrics.at("wall_ratio"), 1, .05);
}

TEST_P(Silo, HangsOnItsWallsAtFourIterations) {
  const scenes::Metrics metrics = run(4);
  EXPECT_GT(metrics.at("wall_ratio"), .25);
  EXPECT_LT(metrics.at("floor_ratio"), .75);
}

INSTANTIATE_TEST_SUITE_P(Fillings, Silo,
                         ::testing::Values(Filling{"Gentle", {{"rise", 0}, {"boxes", 0}, {"layers", 24}, {"across", 5}}},
                                           Filling{"Dropped", {{"rise", .5}, {"boxes", 0}, {"layers", 24}, {"across", 5}}},
                                           Filling{"DroppedFromHigh", {{"rise", 1.5}, {"boxes", 0}, {"layers", 24}, {"across", 5}}},
                                           Filling{"Mixed", {{"rise", .5}, {"boxes", .5}, {"layers", 24}, {"across", 5}}},
                                           // grains that lie in rings press less on a round wall
                                           Filling{"Round", {{"rise", .5}, {"boxes", 0}, {"layers", 28}, {"across", 6}, {"sides", 12}}, .2}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace rubble
