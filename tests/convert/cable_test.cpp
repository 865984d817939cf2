/// <composite> of the type cable, and the elasticity of its plugin.
#include <cmath>
#include <numbers>

#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Effect;
using convert::Import;
using test::bodyNamed;
using test::expectNear;
using test::importText;
using test::jointNamed;
using test::mjcf;

Import cable(const std::string& attributes, const std::string& config, const std::string& geom,
             const std::string& joint = "") {
  return importText(mjcf("<body name='post' pos='0 0 1'><composite type='cable' prefix='c' " + attributes +
                             "><plugin plugin='mujoco.elasticity.cable'>" + config +
                             "</plugin><joint kind='main' " + joint + "/><geom " + geom +
                             " density='800'/></composite></body>",
                         "<extension><plugin plugin='mujoco.elasticity.cable'/></extension>"));
}

TEST(Cables, SegmentsHaveSpringsOfTheirSection) {
  constexpr double kTwist = 3e6, kBend = 8e6, kRadius = .02, kLength = .25;
  const std::string moduli = "<config key='twist' value='3e6'/><config key='bend' value='8e6'/>";
  const Import model = cable("curve='s' count='5 1 1' size='1' initial='ball'", moduli,
                             "type='capsule' size='.02'", "damping='.3'");
  EXPECT_TRUE(model.report.exact()) << convert::textOf(model.report, true);
  const double second = std::numbers::pi * std::pow(kRadius, 4) / 4;
  // as in MuJoCo, the joint of the first segment has no springs
  EXPECT_EQ(jointNamed(model, "cJ_first").driveStiffness, 0);
  for (const char* name : {"cJ_1", "cJ_2", "cJ_last"}) {
    const JointDef& joint = jointNamed(model, name);
    ASSERT_EQ(joint.type, JointType::SixDof);
    EXPECT_NEAR(joint.axes[3].driveStiffness, kTwist * 2 * second / kLength, 1e-12);
    for (const std::size_t bend : {4u, 5u}) {
      EXPECT_NEAR(joint.axes[bend].driveStiffness, kBend * second / kLength, 1e-12);
      EXPECT_EQ(joint.axes[bend].damping, .3);
    }
    EXPECT_EQ(joint.axes[0].max, 0) << "it does not stretch";
  }
  expectNear(bodyNamed(model, "cB_last").position, {.75, 0, 1});
}

TEST(Cables, AStripBendsMoreEasilyAboutItsWideSide) {
  const Import model = cable("vertex='0 0 0 .2 0 0 .4 0 0' initial='none'",
                             "<config key='twist' value='1e6'/><config key='bend' value='1e6'/>",
                             "type='box' size='.1 .03 .01'");
  const JointDef& joint = jointNamed(model, "cJ_last");
  // w h^3 / 12 of full sides 0.06 and 0.02
  EXPECT_NEAR(joint.axes[4].driveStiffness, 1e6 * .06 * std::pow(.02, 3) / 12 / .2, 1e-9);
  EXPECT_NEAR(joint.axes[5].driveStiffness, 1e6 * .02 * std::pow(.06, 3) / 12 / .2, 1e-9);
  // torsion constant of a rectangle with sides 3 to 1: 0.263 w h^3 (Roark)
  EXPECT_NEAR(joint.axes[3].driveStiffness, 1e6 * .263 * .06 * std::pow(.02, 3) / .2, 3e-3);
}

TEST(Cables, AFlatCableIsStraightAtRestAndAnotherOneAsItIsMade) {
  const auto restOf = [](const std::string& flat) {
    const Import model = cable("vertex='0 0 0 1 0 0 1 1 0' initial='none'",
                               "<config key='twist' value='1e6'/><config key='bend' value='1e6'/>" + flat,
                               "type='cylinder' size='.02'");
    const JointDef& joint = jointNamed(model, "cJ_last");
    // at rest its frames coincide; that of A is in the parent
    return rotate(joint.frameA * conjugate(joint.frameB), {1, 0, 0});
  };
  expectNear(restOf(""), {0, 1, 0}, 1e-9);
  expectNear(restOf("<config key='flat' value='true'/>"), {1, 0, 0}, 1e-9);
}

TEST(Cables, AnInstanceOfThePluginMakesSpringsOfBodiesThatAreWrittenOut) {
  const Import model = importText(mjcf(
      "<body name='a'><joint name='i' type='ball'/><geom type='capsule' fromto='0 0 0 .5 0 0' size='.02'/>"
      "<plugin instance='e'/><body name='b' pos='.5 0 0'><joint name='j' type='ball'/>"
      "<geom type='capsule' fromto='0 0 0 .5 0 0' size='.02'/><plugin instance='e'/></body></body>",
      "<extension><plugin plugin='mujoco.elasticity.cable'><instance name='e'>"
      "<config key='twist' value='2e6'/><config key='bend' value='1e6'/></instance></plugin></extension>"));
  EXPECT_TRUE(model.report.exact()) << convert::textOf(model.report, true);
  EXPECT_NEAR(jointNamed(model, "j").axes[4].driveStiffness,
              1e6 * std::numbers::pi * std::pow(.02, 4) / 4 / .5, 1e-9);
  EXPECT_EQ(jointNamed(model, "i").type, JointType::Ball);
}

TEST(Cables, OtherPluginsAndCompositesAreLostWithTheirLine) {
  const Import model = importText(mjcf("<body><geom size='.1'/>\n<composite type='particle'/></body>",
                                       "<extension><plugin plugin='mujoco.sdf.gear'/></extension>"));
  EXPECT_EQ(test::effectsOf(model, "composite"), std::vector{Effect::Lost});
  EXPECT_EQ(test::effectsOf(model, "plugin"), std::vector{Effect::Lost});
  EXPECT_THROW(cable("curve='z' count='5 1 1'", "", "type='capsule' size='.02'"), Error);
}

}  // namespace
}  // namespace rubble
