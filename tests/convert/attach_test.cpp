/// <attach> of MJCF: bodies, what joins them, keyframes and sensors of other models.
#include <algorithm>
#include <cmath>

#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Effect;
using convert::Import;
using test::bodyNamed;
using test::collide;
using test::expectNear;
using test::importText;
using test::jointNamed;
using test::mjcf;

/// An arm with sensors and two keyframes, in the frame of another model.
Import armIn(const test::ModelFolder& folder, const std::string& key, const std::string& sections = "") {
  folder.write(
      "arm.xml",
      mjcf("<site name='mark' pos='1 0 0'/><body name='upper' pos='0 0 1'><joint name='j' axis='0 1 0'/>"
           "<geom size='.1'/><site name='hand' pos='0 0 -.5'/></body>"
           "<body name='loose' pos='0 0 4'><freejoint/><geom size='.1'/></body>"
           "<body name='target' mocap='true' pos='2 0 0'/>",
           "<actuator><position name='servo' joint='j' kp='8'/></actuator>"
           "<tendon><fixed name='sum'><joint joint='j' coef='3'/></fixed></tendon>"
           "<sensor><jointpos name='angle' joint='j'/><tendonpos name='length' tendon='sum'/>"
           "<actuatorfrc name='force' actuator='servo'/>"
           "<framepos name='reach' objtype='site' objname='hand' reftype='site' refname='mark'/></sensor>"
           "<keyframe><key name='rest'/><key name='bent' qpos='.7 0 0 9 0 0 0 1' ctrl='.5' "
           "qvel='2 0 0 0 1 0 0'/></keyframe>"));
  convert::ImportOptions options;
  options.key = key;
  return convert::importModel(
      folder.write("whole.xml",
                   mjcf("<body name='post'><joint name='k'/><geom size='.1'/></body>"
                        "<frame pos='0 5 0' euler='0 0 90'><attach model='m' prefix='p_'/></frame>",
                        "<asset><model name='m' file='arm.xml'/></asset>" + sections)),
      options);
}

const SensorDef& sensorNamed(const Import& model, const std::string& name) {
  const auto found = std::ranges::find(model.file.sensors, name, &SensorDef::name);
  if (found == model.file.sensors.end()) throw Error("sensors", "one of that name", name);
  return *found;
}

TEST(Attach, KeyframesOfAttachedModelsHaveTheirPrefix) {
  const test::ModelFolder folder;
  const Import model = armIn(folder, "p_bent");
  // a free body is where the keyframe says, in the world of the whole model, as in MuJoCo
  const BodyDef& loose = bodyNamed(model, "p_loose");
  expectNear(loose.position, {0, 0, 9});
  expectNear(rotate(loose.orientation, {1, 0, 0}), {-1, 0, 0});
  expectNear(loose.angularVelocity, {-1, 0, 0});
  // a mocap body that it does not move stays in its frame
  expectNear(bodyNamed(model, "p_target").position, {0, 7, 0});
  const BodyDef& upper = bodyNamed(model, "p_upper");
  expectNear(rotate(upper.orientation, {0, 0, 1}), {0, std::sin(.7), std::cos(.7)});
  expectNear(upper.angularVelocity, {-2, 0, 0});
  EXPECT_DOUBLE_EQ(jointNamed(model, "p_j").axes[0].targetPosition, .5);
  EXPECT_EQ(model.report.count(Effect::Lost), 0u) << convert::textOf(model.report, true);
  EXPECT_THROW(armIn(folder, "bent"), Error);
}

TEST(Attach, ControlsOfAttachedModelsInAKeyframeAreReported) {
  const test::ModelFolder folder;
  const std::string own = "<actuator><motor joint='k'/></actuator><keyframe><key name='own' ctrl='";
  const Import without = armIn(folder, "own", own + "2'/></keyframe>");
  EXPECT_EQ(without.report.count(Effect::Lost), 0u) << convert::textOf(without.report, true);
  EXPECT_DOUBLE_EQ(jointNamed(without, "k").axes[0].motorForce, 2);
  const Import with = armIn(folder, "own", own + "2 1'/></keyframe>");
  EXPECT_EQ(test::effectsOf(with, "key.ctrl"), std::vector{Effect::Lost});
}

TEST(Attach, SensorsOfAttachedModelsMeasureTheirBodies) {
  const test::ModelFolder folder;
  const std::string reading = "<sensor><actuatorfrc name='whole' actuator='p_servo'/></sensor>";
  const Import model = armIn(folder, "", reading);
  const auto jointOf = [&](const char* sensor) {
    return model.file.scene.joints.at(static_cast<std::size_t>(sensorNamed(model, sensor).joint)).name;
  };
  EXPECT_EQ(jointOf("p_angle"), "p_j");
  EXPECT_EQ(jointOf("p_length"), "p_sum");
  EXPECT_EQ(jointOf("p_force"), "p_j");
  EXPECT_EQ(jointOf("whole"), "p_j");
  const SensorDef& reach = sensorNamed(model, "p_reach");
  EXPECT_EQ(model.file.scene.bodies.at(static_cast<std::size_t>(reach.body)).name, "p_upper");
  expectNear(reach.position, {0, 0, -.5});
  // the site in the world of the part is now at (0, 6, 0)
  EXPECT_EQ(reach.reference, kWorld);
  expectNear(reach.referencePosition, {0, 6, 0});
  expectNear(rotate(reach.referenceOrientation, {1, 0, 0}), {0, 1, 0});
}

TEST(Attach, TheForceOfAnAttachedActuatorIsNotReadWhereAnotherActsToo) {
  const test::ModelFolder folder;
  const Import model = armIn(folder, "", "<actuator><motor joint='p_j'/></actuator>");
  EXPECT_THROW(sensorNamed(model, "p_force"), Error);
  EXPECT_EQ(test::effectsOf(model, "actuatorfrc 'force'"), std::vector{Effect::None});
  EXPECT_EQ(sensorNamed(model, "p_angle").type, SensorType::JointPosition);
}

TEST(Attach, PairsOfAttachedModelsAreTheirOwn) {
  const test::ModelFolder folder;
  const std::string masks = " contype='0' conaffinity='0'/>";
  std::string bodies, pairs;
  for (int k = 0; k < 8; ++k) {
    const std::string own = std::to_string(k);
    for (const char* side : {"a", "b"})
      bodies += "<body name='" + (side + own) + "' pos='0 0 " + own + "'><freejoint/><geom name='" +
                (side + own) + "' size='.1'" + masks + "</body>";
    pairs += "<pair geom1='a" + own + "' geom2='b" + own + "'/>";
  }
  folder.write("part.xml", mjcf(bodies, "<contact>" + pairs + "</contact>"));
  const auto attached = [&](int copies) {
    std::string text;
    for (int k = 0; k < copies; ++k)
      text += "<attach model='m' prefix='" + std::string(1, static_cast<char>('p' + k)) + "_'/>";
    return convert::importModel(
        folder.write("whole.xml", mjcf(text, "<asset><model name='m' file='part.xml'/></asset>")));
  };
  const Import two = attached(2);
  for (const char* copy : {"p_", "q_"}) {
    EXPECT_TRUE(collide(two, copy + std::string("a0"), copy + std::string("b0")));
    EXPECT_FALSE(collide(two, "p_a0", copy + std::string("b1")));
  }
  EXPECT_FALSE(collide(two, "p_a0", "q_b0"));
  EXPECT_EQ(attached(9).report.count(Effect::Lost), 8u + 1u);  // of 72, and more than 32 combinations
}

TEST(Attach, TheWorldOfAnAttachedModelBecomesPartOfItsBody) {
  const test::ModelFolder folder;
  folder.write(
      "part.xml",
      mjcf("<geom name='base' type='box' size='.5 .5 .5' mass='3'/><site name='s' pos='1 0 0'/>"
           "<camera name='eye' pos='0 4 0' mode='targetbody' target='rod'/>"
           "<body name='rod' pos='0 0 2'><joint name='j'/><geom size='.1'/><site name='t'/></body>",
           "<equality><connect name='tie' body1='rod' anchor='0 0 1'/><connect name='knot' site1='s' "
           "site2='t'/>"
           "</equality>"
           "<tendon><spatial name='cord' stiffness='5'><site site='s'/><site site='t'/></spatial></tendon>"));
  const Import model = convert::importModel(folder.write(
      "whole.xml", mjcf("<body name='host' pos='0 0 5'><freejoint/><geom size='.1' mass='1'/>"
                        "<frame pos='1 0 0' euler='0 0 90'><attach model='m' prefix='p_'/></frame></body>",
                        "<asset><model name='m' file='part.xml'/></asset><tendon><spatial name='own' "
                        "stiffness='1'><site site='p_s'/><site site='p_t'/></spatial></tendon>")));
  EXPECT_NEAR(*bodyNamed(model, "host").mass, 4, 1e-12);
  expectNear(massProperties(bodyNamed(model, "host").shape, 1).center, {0.75, 0, 0});
  EXPECT_EQ(model.report.count(Effect::Lost), 0u) << convert::textOf(model.report, true);
  for (const char* name : {"p_cord", "own"}) {
    const auto path = std::any_cast<TendonFields>(jointNamed(model, name).own).path;
    ASSERT_EQ(path.size(), 10u);
    expectNear({path[1], path[2], path[3]}, {1, 1, 0}), expectNear({path[6], path[7], path[8]}, {0, 0, 0});
  }
  // the world that the equality names is that of the whole model
  const JointDef& tie = jointNamed(model, "p_tie");
  EXPECT_EQ(tie.bodyB, kWorld);
  expectNear(tie.anchorA, {0, 0, 1}), expectNear(tie.anchorB, {1, 0, 8});
  const JointDef& knot = jointNamed(model, "p_knot");
  expectNear(knot.anchorA, {1, 1, 0}), expectNear(knot.anchorB, {0, 0, 0});
  // its camera stands 4 m beside the axis of the part and looks at the rod, 2 m above
  const auto& camera = model.file.camera;
  ASSERT_TRUE(camera);
  expectNear(camera->eye, {-3, 0, 5}, 1e-9);
  expectNear(normalize(camera->target - camera->eye), normalize(Vec3{4, 0, 2}), 1e-9);
}

TEST(Attach, FlexibleObjectsOfAttachedModelsMoveWithThem) {
  const test::ModelFolder folder;
  folder.write("part.xml",
               mjcf("<body name='b' pos='0 0 1'><joint/><geom size='.1'/><flexcomp name='f' type='grid' "
                    "dim='1' count='3 1 1' spacing='.5 1 1'><pin id='0'/></flexcomp></body>"));
  const Import model = convert::importModel(folder.write(
      "whole.xml", mjcf("<frame pos='3 0 0' euler='0 0 90'><attach model='m' body='b' prefix='p_'/></frame>",
                        "<asset><model name='m' file='part.xml'/></asset>")));
  const Scene& scene = model.file.scene;
  ASSERT_EQ(scene.deformables.size(), 1u) << convert::textOf(model.report, true);
  EXPECT_EQ(common(scene.deformables[0]).name, "p_f");
  expectNear(common(scene.deformables[0]).vertices.at(0), {3, -0.5, 1}, 1e-9);
  ASSERT_EQ(scene.attachments.size(), 1u);
  EXPECT_EQ(scene.bodies.at(static_cast<std::size_t>(scene.attachments[0].body)).name, "p_b");
}

TEST(Attach, AttachedModelsKeepWhatJoinsTheirBodies) {
  const test::ModelFolder folder;
  folder.write(
      "parts/hand.xml",
      mjcf("<body name='palm' pos='1 0 0'><joint name='wrist' damping='2'/><geom size='.1' mass='3'/>"
           "<site name='s'/><body name='finger' pos='0 0 1'><joint name='knuckle'/><geom size='.1'/>"
           "<site name='t'/></body></body><body name='other'><freejoint/><geom size='.1'/></body>",
           "<tendon><spatial name='cord' stiffness='5'><site site='s'/><site site='t'/></spatial>"
           "</tendon><actuator><position joint='knuckle' kp='7'/></actuator>"
           "<equality><connect body1='other' body2='finger' anchor='0 0 0'/></equality>"));
  const Import model = convert::importModel(folder.write(
      "robot.xml", mjcf("<body name='arm' pos='0 0 2'><joint name='elbow'/><geom size='.1'/>"
                        "<frame pos='0 1 0' euler='0 0 90'><attach model='hand' body='palm' prefix='l_'/>"
                        "</frame></body><attach model='hand' prefix='w_'/>",
                        "<asset><model name='hand' file='parts/hand.xml'/></asset>"
                        "<equality><joint joint1='l_knuckle' joint2='elbow'/></equality>")));
  expectNear(bodyNamed(model, "l_palm").position, {0, 2, 2});
  expectNear(bodyNamed(model, "l_finger").position, {0, 2, 3});
  expectNear(bodyNamed(model, "w_palm").position, {1, 0, 0});
  EXPECT_NEAR(*bodyNamed(model, "l_palm").mass, 3, 1e-12);
  EXPECT_DOUBLE_EQ(jointNamed(model, "l_wrist").axes[0].damping, 2);
  EXPECT_DOUBLE_EQ(jointNamed(model, "w_knuckle").axes[0].driveStiffness, 7);
  EXPECT_DOUBLE_EQ(jointNamed(model, "l_cord").axes[0].driveStiffness, 5);
  // the loop of the first copy needs a body that is not attached
  EXPECT_EQ(model.report.count(Effect::Lost), 1u) << convert::textOf(model.report, true);
  EXPECT_EQ(model.file.scene.bodies.size(), 6u);
  folder.write("a.xml",
               mjcf("<attach model='b' prefix='x'/>", "<asset><model name='b' file='b.xml'/></asset>"));
  const std::string cycle = folder.write(
      "b.xml", mjcf("<attach model='a' prefix='y'/>", "<asset><model name='a' file='a.xml'/></asset>"));
  EXPECT_THROW(convert::importModel(cycle), Error);
}

}  // namespace
}  // namespace rubble
