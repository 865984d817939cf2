/// Couplings and tendons of the coordinates of bodies that have several joints.
#include <cmath>

#include <rubble/actuators.h>
#include <rubble/world.h>

#include "tests/convert/model_file.h"

namespace rubble {
namespace {

class CompoundJoints : public ::testing::TestWithParam<const char*> {};

TEST_P(CompoundJoints, AreCoupledByEachOfTheirCoordinates) {
  convert::ImportOptions start;
  start.key = "on";
  const convert::Import model = convert::importModel(
      (std::filesystem::path(RUBBLE_SOURCE_DIR) / "tests/convert/models/compound.xml").string(), start);
  EXPECT_EQ(model.report.count(convert::Effect::Approximate), 0u) << convert::textOf(model.report, true);
  EXPECT_EQ(model.report.count(convert::Effect::Lost), 0u) << convert::textOf(model.report, true);
  WorldOptions options;
  options.threads = 1;
  options.backend = GetParam(), options.params.dt = 1. / 1000, options.params.iterations = 8;
  World world(model.file.scene, options);
  Actuators actuators(model.file.actuators, world);
  const auto axis = [&](const char* joint, std::size_t number) {
    return world.state(world.findJoint(joint)).axes[number].position;
  };
  const double before = axis("s+h", 0);
  double farthest = 0;
  for (int step = 0; step < 400; ++step) {
    actuators.apply(world), world.step();
    const double wheel = axis("w", 0), travel = axis("s+h", 0);
    ASSERT_NEAR(axis("p1+p2", 3), 0.8 * wheel + 0.3 * wheel * wheel, 1e-3) << step;
    ASSERT_NEAR(std::fabs(axis("a+b+c", 4)), std::fabs(2 * travel), 1e-3) << step;
    ASSERT_NEAR(std::fabs(axis("s+h", 3)), std::fabs(5 * travel), 2e-3) << step;
    farthest = std::max(farthest, std::fabs(travel - before));
  }
  EXPECT_GT(farthest, 0.02);
}
INSTANTIATE_TEST_SUITE_P(Backends, CompoundJoints, ::testing::Values("cpu", "reference"));

}  // namespace
}  // namespace rubble
