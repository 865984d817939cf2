/// Grains in tall bins, whatever the order of filling: walls bear a part of the weight and the floor the
/// rest.
#include <gtest/gtest.h>
#include <scenes/registry.h>

#include <algorithm>
#include <string>
#include <vector>

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

INSTANTIATE_TEST_SUITE_P(
    Fillings, Silo,
    ::testing::Values(
        Filling{"Gentle", {{"rise", 0}, {"boxes", 0}, {"layers", 24}, {"across", 5}}},
        Filling{"Dropped", {{"rise", .5}, {"boxes", 0}, {"layers", 24}, {"across", 5}}},
        Filling{"DroppedFromHigh", {{"rise", 1.5}, {"boxes", 0}, {"layers", 24}, {"across", 5}}, .2},
        Filling{"Mixed", {{"rise", .5}, {"boxes", .5}, {"layers", 24}, {"across", 5}}},
        // grains that lie in rings press less on a round wall
        Filling{"Round", {{"rise", .5}, {"boxes", 0}, {"layers", 28}, {"across", 6}, {"sides", 12}}, .2}),
    [](const auto& info) { return info.param.name; });

/// Largest displacement of a body from the end of `settled` steps to that of `more`, at 4 iterations [m].
double creepOf(const std::string& name, const scenes::Arguments& arguments, int settled, int more) {
  const scenes::Spec& spec = scenes::find(name);
  const scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, arguments));
  WorldOptions options = test::options(job.iterations);
  options.params.substeps = job.substeps;
  World world(job.scene, options);
  test::run(world, settled);
  std::vector<Vec3> before;
  for (const BodyId id : world.bodies()) before.push_back(world.state(id).position);
  test::run(world, more);
  double creep = 0;
  std::size_t k = 0;
  for (const BodyId id : world.bodies())
    creep = std::max(creep, length(world.state(id).position - before[k++]));
  return creep;
}

TEST(Settling, DoesNotMoveWhatFrictionHolds) {
  // stones of about a metre and cards of 0.4 m, in twenty seconds
  EXPECT_LT(creepOf("voussoir-arch", {}, 600, 1200), 5e-4);
  EXPECT_LT(creepOf("card-tower", {{"smash", 0}}, 600, 1200), 5e-4);
}

}  // namespace
}  // namespace rubble
