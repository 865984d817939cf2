/// Units, defaults, frames and joints of MJCF, and what the report says.
#include <cmath>
#include <numbers>

#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Effect;
using convert::Import;
using test::bodyNamed;
using test::collide;
using test::effectsOf;
using test::expectNear;
using test::importText;
using test::jointNamed;
using test::mjcf;

using std::numbers::pi;

TEST(Mjcf, AnglesAreDegreesUnlessTheCompilerSaysRadian) {
  const std::string
      body = "<body name='b' euler='0 0 90'><joint name='j' range='-90 45'/><geom size='1'/></body>";
  const Import degrees = importText(mjcf(body));
  EXPECT_NEAR(jointNamed(degrees, "j").axes[0].min, -pi / 2, 1e-12);
  EXPECT_NEAR(jointNamed(degrees, "j").axes[0].max, pi / 4, 1e-12);
  expectNear(rotate(bodyNamed(degrees, "b").orientation, {1, 0, 0}), {0, 1, 0});
  const Import radians = importText(mjcf(body, "<compiler angle='radian'/>"));
  EXPECT_NEAR(jointNamed(radians, "j").axes[0].max, 45, 1e-12);
}

TEST(Mjcf, RangesOfSlidesAreLengths) {
  const Import model = importText(
      mjcf("<body><joint name='j' type='slide' range='-1 2'/><geom size='1'/></body>"));
  EXPECT_EQ(jointNamed(model, "j").type, JointType::Slider);
  EXPECT_DOUBLE_EQ(jointNamed(model, "j").axes[0].max, 2);
}

TEST(Mjcf, LimitsAreMeasuredFromTheReferenceOfTheJoint) {
  const Import model = importText(mjcf(
      "<body><joint name='j' range='0 90' ref='30' springref='60' stiffness='2'/><geom size='1'/></body>"));
  const JointAxis& axis = jointNamed(model, "j").axes[0];
  EXPECT_NEAR(axis.min, -pi / 6, 1e-12);
  EXPECT_NEAR(axis.max, pi / 3, 1e-12);
  EXPECT_NEAR(axis.targetPosition, pi / 6, 1e-12);
  EXPECT_DOUBLE_EQ(axis.driveStiffness, 2);
}

TEST(Mjcf, ElementsTakeDefaultsOfTheirClassAndItsParents) {
  const Import model = importText(
      mjcf("<body name='a' childclass='heavy'><freejoint/><geom/></body>"
           "<body name='b' pos='9 0 0'><freejoint/><geom class='heavy' density='1'/></body>"
           "<body name='c' pos='18 0 0'><freejoint/><geom/></body>",
           "<default><geom type='box' size='.5 .5 .5'/>"
           "<default class='heavy'><geom density='2000'/></default></default>"));
  EXPECT_NEAR(*bodyNamed(model, "a").mass, 2000, 1e-9);
  EXPECT_NEAR(*bodyNamed(model, "b").mass, 1, 1e-12);
  EXPECT_NEAR(*bodyNamed(model, "c").mass, 1000, 1e-9);
}

TEST(Mjcf, FramesMoveWhatIsInThem) {
  const Import model = importText(
      mjcf("<frame pos='1 2 3' euler='0 0 90'><body name='b' pos='1 0 0'><joint name='j' "
           "axis='1 0 0'/><geom size='1'/></body></frame>"));
  expectNear(bodyNamed(model, "b").position, {1, 3, 3});
  const JointDef& joint = jointNamed(model, "j");
  expectNear(rotate(joint.frameB, {1, 0, 0}), {0, 1, 0});
}

TEST(Mjcf, ReplicateMakesCopiesWithNumberedNames) {
  const Import model = importText(
      mjcf("<replicate count='11' offset='1 0 0' sep='-'><body name='b'><freejoint/>"
           "<geom size='.1'/></body></replicate>"));
  EXPECT_EQ(model.file.scene.bodies.size(), 11u);
  expectNear(bodyNamed(model, "b-03").position, {3, 0, 0});
  expectNear(bodyNamed(model, "b-10").position, {10, 0, 0});
}

TEST(Mjcf, BodiesWithoutJointsBecomePartOfTheirParent) {
  const Import model = importText(
      mjcf("<body name='a'><freejoint/><geom type='box' size='.5 .5 .5'/><body name='b' "
           "pos='2 0 0'><geom type='box' size='.5 .5 .5'/></body></body>"));
  ASSERT_EQ(model.file.scene.bodies.size(), 1u);
  EXPECT_NEAR(*model.file.scene.bodies[0].mass, 2000, 1e-9);
  const MassProperties mass = massProperties(model.file.scene.bodies[0].shape, 1);
  expectNear(mass.center, {1, 0, 0});
}

TEST(Mjcf, AnInertialGivesCenterAndAxesOfItsBody) {
  const Import model = importText(
      mjcf("<body name='a' pos='0 0 5'><freejoint/><geom size='.1'/><inertial pos='.1 .2 .3' "
           "mass='4' diaginertia='1 2 2.5' euler='0 0 90'/></body>"));
  const MassProperties mass = massProperties(bodyNamed(model, "a").shape, 1);
  EXPECT_NEAR(mass.mass, 4, 1e-12);
  expectNear(mass.center, {.1, .2, .3});
  // the first axis is now along y
  const Vec3 y = rotateInverse(mass.axes, {0, 1, 0});
  EXPECT_NEAR(dot(y, mul(mass.inertia, y)), 1, 1e-9);
}

TEST(Mjcf, TwoHingesOfOneBodyAreOneJointWithTwoFreeAxes) {
  const Import model = importText(
      mjcf("<body><joint name='u' axis='1 0 0' range='-10 20'/><joint name='v' axis='0 1 0' "
           "range='-30 40'/><geom size='1'/></body>"));
  const JointDef& joint = jointNamed(model, "u+v");
  EXPECT_EQ(joint.type, JointType::SixDof);
  EXPECT_NEAR(joint.axes[3].max, 40 * pi / 180, 1e-12);
  EXPECT_NEAR(joint.axes[5].max, 20 * pi / 180, 1e-12);
  for (const std::size_t i : {0u, 1u, 2u, 4u}) EXPECT_EQ(joint.axes[i].min, joint.axes[i].max) << i;
  EXPECT_EQ(model.file.scene.bodies.size(), 1u);
}

TEST(Mjcf, ThreeHingesOfOneBodyThatAreNotOrthogonalAreReportedWithTheirLine) {
  const auto notesOf = [](const std::string& second, const std::string& third) {
    const Import model = importText(
        mjcf("<body name='b'>\n<joint name='i' axis='1 0 0'/><joint name='j' axis='" + second + "'/>" +
             third + "<geom size='.1' pos='0 0 -.5'/></body>"));
    std::vector<convert::Note> out;
    for (const convert::Note& note : model.report.notes)
      if (note.effect == Effect::Approximate) out.push_back(note);
    return out;
  };
  EXPECT_TRUE(notesOf("0 1 0", "").empty());
  EXPECT_TRUE(notesOf("1 1 0", "").empty());
  EXPECT_TRUE(notesOf("0 1 0", "<joint axis='1 0 1' damping='1'/>").size() == 1);  // turns by less than 90
  EXPECT_TRUE(notesOf("1 1 0", "<joint axis='0 0 1'/>").empty());
  const std::vector<convert::Note> notes = notesOf("1 1 0", "<joint axis='0 0 1' damping='1'/>");
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].place.file, "model.xml");
  EXPECT_EQ(notes[0].place.line, 2);
  EXPECT_EQ(notes[0].what, "joints of body 'b'");
}

TEST(Mjcf, ArmatureOfABallJointIsThatOfItsSwingAndTwist) {
  const Import model = importText(
      mjcf("<body name='b'><joint name='j' type='ball' armature='.5' damping='2'/><geom size='.1'/></body>"));
  const JointDef& joint = jointNamed(model, "j");
  ASSERT_EQ(joint.type, JointType::SixDof);
  for (const std::size_t axis : {3u, 4u, 5u}) {
    EXPECT_EQ(joint.axes[axis].armature, .5);
    EXPECT_EQ(joint.axes[axis].damping, 2);
  }
  EXPECT_EQ(effectsOf(model, "joint.armature"), std::vector{Effect::Approximate});
}

TEST(Mjcf, ASlideBehindAHingeMovesAlongItsOwnBody) {
  const Import model = importText(
      mjcf("<body name='b'><joint name='turn' axis='0 1 0'/><joint name='reach' type='slide' "
           "axis='1 0 0' range='0 2'/><geom size='1'/></body>"));
  const JointDef& joint = jointNamed(model, "turn+reach");
  EXPECT_EQ(joint.bodyA, kWorld);
  double least = 0, most = 0;
  for (std::size_t i = 0; i < 3; ++i)
    least = std::min(least, joint.axes[i].min), most = std::max(most, joint.axes[i].max);
  EXPECT_NEAR(most - least, 2, 1e-12);
}

TEST(Mjcf, MocapBodiesAreKinematic) {
  const Import model = importText(mjcf("<body name='m' mocap='true'><geom size='1'/></body>"));
  EXPECT_EQ(bodyNamed(model, "m").motion, Motion::Kinematic);
}

TEST(Mjcf, GeomsCollideByContypeAndConaffinity) {
  const Import model = importText(
      mjcf("<geom name='floor' type='plane' size='1 1 1' contype='1' conaffinity='2'/>"
           "<body name='a'><freejoint/><geom size='1' contype='2' conaffinity='1'/></body>"
           "<body name='b'><freejoint/><geom size='1' contype='2' conaffinity='1'/></body>"
           "<body name='c'><freejoint/><geom size='1' contype='0' conaffinity='0'/></body>"));
  EXPECT_TRUE(collide(model, "a", "floor"));
  EXPECT_FALSE(collide(model, "a", "b"));
  EXPECT_FALSE(collide(model, "c", "floor"));
}

TEST(Mjcf, APositionActuatorIsADriveOfItsJoint) {
  const Import model = importText(
      mjcf("<body><joint name='j' damping='1'/><geom size='1'/></body>",
           "<actuator><position joint='j' kp='10' kv='2' gear='3' forcerange='-5 5'/></actuator>"));
  const JointAxis& axis = jointNamed(model, "j").axes[0];
  EXPECT_DOUBLE_EQ(axis.driveStiffness, 90);
  EXPECT_DOUBLE_EQ(axis.driveDamping, 18);
  EXPECT_DOUBLE_EQ(axis.damping, 1);
  EXPECT_DOUBLE_EQ(axis.maxDriveForce, 15);
}

TEST(Mjcf, AKeyframeIsTheStartOfTheScene) {
  const std::string text = mjcf(
      "<body name='b' pos='0 0 1'><joint name='j' axis='0 1 0'/><geom size='.1' pos='1 0 0'/>"
      "</body>",
      "<keyframe><key name='up' qpos='1.5707963267948966'/></keyframe>");
  convert::ImportOptions options;
  options.key = "up";
  const Import model = importText(text, "model.xml", options);
  expectNear(rotate(bodyNamed(model, "b").orientation, {1, 0, 0}), {0, 0, -1});
  EXPECT_NE(test::messageOf([&] {
              options.key = "down";
              importText(text, "model.xml", options);
            }),
            "");
}

TEST(Mjcf, TheReportTellsWhatIsLostWithItsLine) {
  const Import model = importText(
      mjcf("\n<body><joint name='j' springyield='1'/>\n<geom size='1' shade='red' solmix='2'/>"
           "<composite/></body>"));
  EXPECT_EQ(effectsOf(model, "joint.springyield"), std::vector{Effect::Lost});
  EXPECT_EQ(effectsOf(model, "geom.shade"), std::vector{Effect::Lost});
  EXPECT_EQ(effectsOf(model, "geom.solmix"), std::vector{Effect::None});
  EXPECT_EQ(effectsOf(model, "composite"), std::vector{Effect::Lost});
  for (const convert::Note& note : model.report.notes)
    if (note.what == "geom.shade") {
      EXPECT_EQ(note.place.line, 3);
      EXPECT_EQ(note.place.file, "model.xml");
    }
  EXPECT_FALSE(model.report.exact());
}

TEST(Mjcf, AMotorIsAPlainForceWithinItsRange) {
  convert::ImportOptions options;
  options.key = "0";
  const Import model = importText(mjcf("<body><joint name='j' armature='.2'/><geom size='1'/></body>",
                                       "<actuator><motor joint='j' gear='-4' ctrlrange='-1 2'/><motor "
                                       "joint='j' forcerange='-.5 .5'/></actuator>"
                                       "<keyframe><key ctrl='9 3'/></keyframe>"),
                                  "model.xml", options);
  const JointAxis& axis = jointNamed(model, "j").axes[0];
  EXPECT_DOUBLE_EQ(axis.motorForce, -8 + .5);
  EXPECT_DOUBLE_EQ(axis.armature, .2);
  EXPECT_TRUE(model.report.exact()) << convert::textOf(model.report, true);
}

TEST(Mjcf, ActuatorsOfEveryLinearKindAreDrivesOrMotors) {
  const auto modelWith = [](const std::string& actuator) {
    convert::ImportOptions options;
    options.key = "0";
    return importText(
        mjcf("<body><joint name='j' type='slide'/><geom size='1' mass='3'/></body>",
             "<actuator>" + actuator + "</actuator><keyframe><key ctrl='2' act='.5'/></keyframe>"),
        "model.xml", options);
  };
  const auto axisWith = [&](const std::string& actuator) {
    return jointNamed(modelWith(actuator), "j").axes[0];
  };
  EXPECT_DOUBLE_EQ(axisWith("<velocity joint='j' kv='4'/>").targetSpeed, 2);
  EXPECT_DOUBLE_EQ(axisWith("<intvelocity joint='j' kp='4' actrange='-1 1'/>").targetPosition, .5);
  EXPECT_DOUBLE_EQ(axisWith("<cylinder joint='j' area='3'/>").motorForce, 1.5);
  // c = 2 zeta sqrt(k m)
  EXPECT_DOUBLE_EQ(axisWith("<position joint='j' kp='12' dampratio='.5'/>").driveDamping, 6);
  EXPECT_DOUBLE_EQ(
      axisWith("<general joint='j' gainprm='12' biastype='affine' biasprm='0 -12 .5'/>").driveDamping, 6);
  // a gain by length or speed is a law of the actuator alone
  const Import model = modelWith(
      "<general joint='j' gear='2' gaintype='affine' gainprm='1 0 -5' biastype='affine' biasprm='0 -7 0'/>");
  const ActuatorDef& law = model.file.actuators.at(0);
  EXPECT_EQ(law.type, ActuatorType::Force);
  EXPECT_EQ(law.gain, (Vec3{1, 0, -5}));
  EXPECT_EQ(law.bias, (Vec3{0, -7, 0}));
  EXPECT_DOUBLE_EQ(std::fabs(law.gear), 2);
  EXPECT_EQ(jointNamed(model, "j").axes[0].driveStiffness, 0);
}

TEST(Mjcf, AKeyframeGivesVelocitiesOfTheWholeTree) {
  convert::ImportOptions options;
  options.key = "0";
  const Import model = importText(
      mjcf("<body name='a'><joint name='i' axis='0 0 1'/><geom size='.1' pos='1 0 0'/>"
           "<body name='b' pos='2 0 0'><joint name='j' type='slide' axis='0 1 0'/><geom "
           "size='.1'/></body></body>",
           "<keyframe><key qvel='3 5'/></keyframe>"),
      "model.xml", options);
  expectNear(bodyNamed(model, "a").velocity, {0, 3, 0});
  expectNear(bodyNamed(model, "b").velocity, {0, 6 + 5, 0});
  expectNear(bodyNamed(model, "b").angularVelocity, {0, 0, 3});
}

TEST(Mjcf, CouplingsOfSlidesAndPolynomialsAreTendons) {
  const Import model = importText(
      mjcf("<body name='a'><joint name='x' type='slide' axis='1 0 0'/><geom size='.1'/></body>"
           "<body name='b' pos='1 0 0'><joint name='y' type='slide' axis='0 1 0'/><geom size='.1'/></body>",
           "<equality><joint name='e' joint1='x' joint2='y' polycoef='.1 -1 2'/></equality>"));
  const JointDef& joint = jointNamed(model, "e");
  EXPECT_EQ(joint.type, jointType("tendon"));
  const auto fields = std::any_cast<TendonFields>(joint.own);
  ASSERT_EQ(fields.terms.size(), 26u);
  EXPECT_DOUBLE_EQ(fields.terms[9], 1);
  EXPECT_DOUBLE_EQ(fields.terms[13 + 9], 1);
  EXPECT_DOUBLE_EQ(fields.terms[13 + 10], -2);
  EXPECT_DOUBLE_EQ(joint.axes[0].min, .1);
}

TEST(Mjcf, ASpatialTendonHasItsLimitsSpringAndMotor) {
  const Import model = importText(mjcf(
      "<site name='s' pos='0 0 2'/><body name='a'><joint name='j'/><geom size='.1' pos='0 0 -1'/>"
      "<site name='t' pos='0 0 -1'/></body>",
      "<tendon><spatial name='rope' range='0 4' stiffness='20' damping='3'><site site='s'/><site site='t'/>"
      "</spatial></tendon><actuator><motor tendon='rope' gear='2'/></actuator>"));
  const JointDef& joint = jointNamed(model, "rope");
  EXPECT_DOUBLE_EQ(joint.axes[0].max, 4);
  EXPECT_DOUBLE_EQ(joint.axes[0].driveStiffness, 20);
  EXPECT_DOUBLE_EQ(joint.axes[0].targetPosition, 3);  // the length in the file
  EXPECT_DOUBLE_EQ(joint.axes[0].damping, 3);
}

TEST(Mjcf, TendonsWrapSpheresAndCylindersOfTheirBodies) {
  const auto model = [](const std::string& path) {
    return importText(
        mjcf("<site name='s' pos='-2 0 1'/><site name='inner' pos='0 0 .1'/><body name='a'>"
             "<joint name='j'/><geom size='.1' pos='0 0 -1'/><site name='t' pos='2 0 1'/>"
             "<geom name='ball' pos='0 0 .8' size='.5'/>"
             "<geom name='pin' type='cylinder' pos='0 0 .8' size='.5 1' euler='90 0 0'/></body>",
             "<tendon><spatial name='rope' stiffness='1'><site site='s'/>" + path + "</spatial></tendon>"));
  };
  // tangents to a circle of 0.5 m from points 2 m beside and 0.2 m above its center
  const double far = std::hypot(2, .2), turn = std::acos((.04 - 4) / (far * far)) - 2 * std::acos(.5 / far);
  const double around = 2 * std::sqrt(far * far - .25) + .5 * turn;
  for (const char* geom : {"ball", "pin"}) {
    const Import wrapped = model("<geom geom='" + std::string(geom) + "'/><site site='t'/>");
    const JointDef& joint = jointNamed(wrapped, "rope");
    EXPECT_NEAR(joint.axes[0].targetPosition, around, 1e-9);
    const auto& wraps = std::any_cast<const TendonFields&>(joint.own).wraps;
    ASSERT_EQ(wraps.size(), 13u);
    EXPECT_NEAR(std::fabs(wraps[6]), geom[0] == 'p' ? 1 : 0, 1e-12);
    EXPECT_EQ(wrapped.report.count(Effect::Lost), 0u);
  }
  EXPECT_THROW(model("<geom geom='ball'/>"), Error);
  EXPECT_THROW(model("<geom geom='ball'/><geom geom='pin'/><site site='t'/>"), Error);
  EXPECT_THROW(model("<geom geom='none'/><site site='t'/>"), Error);
}

TEST(Mjcf, AnExplicitPairCollidesWhateverItsMasksSay) {
  const std::string masks = " contype='0' conaffinity='0'/>";
  const Import model = importText(
      mjcf("<geom name='floor' type='plane' size='1 1 1'" + masks +
               "<body name='a'><freejoint/><geom name='a' size='.1'" + masks +
               "</body><body name='b' pos='1 0 0'><freejoint/><geom size='.1'" + masks +
               "</body><body name='c' pos='2 0 0'><freejoint/><geom size='.1'/></body>",
           "<contact><pair geom1='floor' geom2='a'/></contact>"));
  EXPECT_TRUE(collide(model, "floor", "a"));
  EXPECT_FALSE(collide(model, "a", "c"));
  EXPECT_FALSE(collide(model, "floor", "c"));
  EXPECT_EQ(bodyNamed(model, "b").filter.layers, 0u);
}

TEST(Mjcf, AnExplicitPairOfParentAndChildCollidesIfItIsAllThatWould) {
  const auto arm = [](const std::string& more) {
    return importText(mjcf("<body name='a'><freejoint/><geom name='a' size='.1'/>" + more +
                               "<body name='b' pos='1 0 0'><joint name='j'/><geom name='b' size='.1'/>"
                               "</body></body>",
                           "<contact><pair geom1='a' geom2='b'/><exclude body1='a' body2='b'/></contact>"));
  };
  const Import exact = arm("");
  EXPECT_TRUE(jointNamed(exact, "j").collide);
  EXPECT_TRUE(exact.file.scene.exclusions.empty());
  EXPECT_TRUE(exact.report.exact()) << convert::textOf(exact.report, true);
  const Import lost = arm("<geom pos='0.5 0 0' size='.1'/>");
  EXPECT_FALSE(jointNamed(lost, "j").collide);
  EXPECT_EQ(lost.file.scene.exclusions.size(), 1u);
  EXPECT_EQ(effectsOf(lost, "pair"), std::vector{Effect::Lost});
}

TEST(Mjcf, AModelThatIsUsedInFullIsExact) {
  const Import model = importText(
      mjcf("<geom type='plane' size='1 1 1'/><body pos='0 0 1'><freejoint/>"
           "<geom type='box' size='.1 .1 .1'/></body>"));
  EXPECT_TRUE(model.report.exact()) << convert::textOf(model.report, true);
}

TEST(Mjcf, IncludedFilesStandInPlaceOfTheirElement) {
  const test::ModelFolder folder;
  folder.write(
      "parts/part.xml",
      "<mujocoinclude><body name='b'><freejoint/>\n<geom size='1' shade='1'/></body></mujocoinclude>");
  const Import model = convert::importModel(
      folder.write("main.xml", mjcf("<include file='parts/part.xml'/>")));
  EXPECT_EQ(model.file.scene.bodies.at(0).name, "b");
  for (const convert::Note& note : model.report.notes)
    if (note.what == "geom.shade") {
      EXPECT_EQ(note.place.text(), "part.xml:2");
    }
}

}  // namespace
}  // namespace rubble
