/// Couplings and tendons of the coordinates of bodies that have several joints.
#include <cmath>

#include <rubble/actuators.h>
#include <rubble/sensors.h>
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
/// In a keyframe, where the importer places bodies by itself, their joints have the coordinates of the model.
TEST(CompoundJoint, HasTheCoordinatesOfHingesThatDoNotMeet) {
  convert::ImportOptions options;
  options.key = "k";
  const convert::Import model = test::importText(
      test::mjcf("<body name='a' pos='0.1 0.2 0.3' euler='10 20 30'>"
                 "<joint name='s' type='slide' axis='1 0.2 0.1'/>"
                 "<joint name='p' axis='1 0.2 0.1' pos='0 0.1 0.02'/>"
                 "<joint name='q' axis='0.3 1 -0.2' pos='-0.05 0 0.1' range='-60 60'/>"
                 "<joint name='r' axis='0.1 0.4 1' pos='0.1 -0.07 0'/><geom size='0.1' mass='2'/>"
                 "<body name='b' pos='0.4 0 0'><joint name='t' axis='0 1 0.2' pos='0 0 0.1'/>"
                 "<joint name='u' axis='1 0.5 0' pos='0 0.05 0'/>"
                 "<joint name='v' type='slide' axis='1 0.5 0'/><geom size='0.05' mass='1'/></body></body>",
                 "<sensor><jointpos joint='s'/><jointpos joint='p'/><jointpos joint='q'/><jointpos "
                 "joint='r'/><jointpos joint='t'/><jointpos joint='u'/><jointpos joint='v'/></sensor>"
                 "<keyframe><key name='k' qpos='0.05 0.7 -0.6 2.5 -2.2 0.9 0.1'/></keyframe>"),
      "model.xml", options);
  EXPECT_EQ(model.report.count(convert::Effect::Approximate), 0u) << convert::textOf(model.report, true);
  EXPECT_EQ(model.report.count(convert::Effect::Lost), 0u) << convert::textOf(model.report, true);
  WorldOptions reference;
  reference.backend = "reference", reference.threads = 1;
  World world(model.file.scene, reference);
  Sensors sensors(model.file.sensors, world);
  sensors.update(world);
  const double expected[] = {0.05, 0.7, -0.6, 2.5, -2.2, 0.9, 0.1};
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(sensors.values(i)[0], expected[i], 1e-9) << i;
  for (const JointId id : world.joints()) {
    const JointState joint = world.state(id);
    EXPECT_NEAR(joint.axes[0].position, 0, 1e-9);
    EXPECT_NEAR(joint.axes[1].position, 0, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, CompoundJoints, ::testing::Values("cpu", "reference"));

}  // namespace
}  // namespace rubble
