/// Actuators of MJCF that act on sites, ball joints and free joints, and what depends on the mass they move.
#include <cmath>
#include <random>

#include <rubble/actuators.h>
#include <rubble/world.h>

#include "io/picture.h"
#include "io/scene_json.h"
#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Effect;
using convert::Import;
using test::actuatorNamed;
using test::bodyNamed;
using test::effectsOf;
using test::expectNear;
using test::importText;
using test::jointNamed;
using test::mjcf;

constexpr const char* kStill = "<option gravity='0 0 0'/>";

Import importWith(const std::string& world, const std::string& sections, const std::string& controls) {
  convert::ImportOptions options;
  options.key = "0";
  return importText(mjcf(world, sections + "<keyframe><key ctrl='" + controls + "'/></keyframe>"),
                    "model.xml", options);
}

/// State of a body after half a second at small steps.
BodyState afterHalfASecond(const Import& model, const std::string& body) {
  WorldOptions options;
  options.threads = 1;
  options.params.dt = 1. / 2000;
  World world(model.file.scene, options);
  Actuators actuators(model.file.actuators, world);
  for (int step = 0; step < 1000; ++step) actuators.apply(world), world.step();
  return world.state(world.findBody(body));
}

TEST(Actuators, FourRotorsHoldADroneAndLiftItByWhatTheyHaveMore) {
  std::string sites, motors;
  const double arm = 0.2;
  for (int i = 0; i < 4; ++i) {
    const std::string name = "r" + std::to_string(i);
    sites += "<site name='" + name + "' pos='" + std::to_string(i % 2 ? arm : -arm) + " " +
             std::to_string(i / 2 ? arm : -arm) + " 0.05'/>";
    motors += "<motor name='" + name + "' site='" + name + "' gear='0 0 1 0 0 " + (i % 3 ? "-" : "") +
              "0.02'/>";
  }
  const std::string world = "<body name='drone'><freejoint/><geom type='box' size='0.2 0.2 0.05' mass='2'/>" +
                            sites + "</body>";
  const std::string hold = std::to_string(2 * 9.81 / 4), more = std::to_string(3 * 9.81 / 4);
  const auto all = [](const std::string& each) { return each + " " + each + " " + each + " " + each; };
  const Import held = importWith(world, "<actuator>" + motors + "</actuator>", all(hold));
  EXPECT_EQ(held.report.count(Effect::Lost), 0u) << convert::textOf(held.report, true);
  EXPECT_LT(length(afterHalfASecond(held, "drone").position), 1e-4);
  const BodyState lifted = afterHalfASecond(
      importWith(world, "<actuator>" + motors + "</actuator>", all(more)), "drone");
  EXPECT_NEAR(lifted.position.z, 9.81 / 2 * 0.25 / 2, 2e-3);
  EXPECT_NEAR(lifted.orientation.s, 1, 1e-5);
}

TEST(Actuators, ThoseOfSitesOfAnAttachedModelActOnItsBodies) {
  const test::ModelFolder folder;
  folder.write("drone.xml",
               mjcf("<body name='a' pos='0 0 1'><freejoint name='f'/><geom size='0.1'/>"
                    "<site name='s' pos='0.1 0 0'/></body><site name='base' pos='0 0 2'/>",
                    "<actuator><motor name='up' site='s' gear='0 0 1 0 0 0'/>"
                    "<motor name='pull' site='s' refsite='base' gear='1 0 0 0 0 0'/></actuator>"));
  const Import model = convert::importModel(folder.write(
      "main.xml", mjcf("<body name='first'><freejoint/><geom size='0.1'/></body>"
                       "<frame pos='5 0 0' euler='0 0 90'><attach model='drone' prefix='p_'/></frame>",
                       "<asset><model name='drone' file='drone.xml'/></asset>"
                       "<actuator><motor name='push' joint='p_f' gear='1 0 0 0 0 0'/></actuator>")));
  EXPECT_EQ(model.report.count(Effect::Lost), 0u) << convert::textOf(model.report, true);
  const ActuatorDef& up = actuatorNamed(model, "p_up");
  EXPECT_EQ(model.file.scene.bodies[static_cast<std::size_t>(up.body)].name, "p_a");
  expectNear(up.position, {0.1, 0, 0});
  expectNear(up.force, {0, 0, 1});
  for (const char* name : {"p_pull", "push"}) {
    const JointDef& joint = jointNamed(model, name);
    EXPECT_EQ(model.file.scene.bodies[static_cast<std::size_t>(joint.bodyA)].name, "p_a") << name;
    const auto& terms = std::any_cast<const TendonFields&>(joint.own).terms;
    ASSERT_EQ(terms.size(), 13u);
    EXPECT_NEAR(terms[6], name == std::string("push") ? 0 : 0.1, 1e-12);
    // in the frame of the body: the frame that it is attached to is turned
    const Vec3 axis{terms[3], terms[4], terms[5]},
        wanted = name == std::string("p_pull") ? Vec3{1, 0, 0} : Vec3{0, -1, 0};
    EXPECT_LT(length(axis - wanted), 1e-9) << name;
  }
}

TEST(Actuators, ATorqueOfASiteTurnsItsBody) {
  const Import model = importWith(
      "<body name='wheel'><freejoint/><geom type='cylinder' size='0.3 0.05' mass='2'/><site "
      "name='s'/></body>",
      std::string(kStill) + "<actuator><motor site='s' gear='0 0 0 0 0 3'/></actuator>", "0.4");
  EXPECT_NEAR(afterHalfASecond(model, "wheel").angularVelocity.z, 1.2 / 0.09 * 0.5, 1e-3);
}

TEST(Actuators, AForceOfAFreeJointIsAlongTheAxesOfTheWorld) {
  const Import model = importWith(
      "<body name='b' euler='0 0 90'><freejoint name='f'/><geom size='0.1' mass='2'/></body>",
      std::string(kStill) + "<actuator><motor joint='f' gear='3 0 0 0 0 0'/></actuator>", "2");
  const BodyState end = afterHalfASecond(model, "b");
  EXPECT_NEAR(end.velocity.x, 1.5, 1e-4);
  EXPECT_NEAR(end.velocity.y, 0, 1e-6);
}

TEST(Actuators, ADriveOfABallJointTurnsItToItsControl) {
  const Import model = importWith(
      "<body name='b' euler='20 30 40'><joint name='j' type='ball' damping='0.05'/><geom size='0.1' "
      "mass='2'/>"
      "</body>",
      std::string(kStill) + "<actuator><position jointinparent='j' kp='4' kv='0.3' gear='0 2 0'/></actuator>",
      "0.6");
  const Quat before = bodyNamed(model, "b").orientation;
  const Quat turn = normalize(afterHalfASecond(model, "b").orientation * conjugate(before));
  // the length is the angle times the gear
  EXPECT_NEAR(2 * std::asin(dot(turn.v, rotate(before, Vec3{0, 1, 0}))), 0.3, 5e-3);
}

TEST(Actuators, ADriveBetweenTwoSitesMovesTheirDistanceToItsControl) {
  const Import model = importWith(
      "<body name='base' pos='1 2 3' euler='0 0 90'><geom size='0.1'/><site name='r'/></body>"
      "<body name='b' pos='1 2.5 3'><freejoint/><geom size='0.1' mass='2'/><site name='s'/></body>",
      std::string(kStill) +
          "<actuator><position site='s' refsite='r' kp='400' kv='50' gear='1 0 0 0 0 0'/></actuator>",
      "0.8");
  const BodyState end = afterHalfASecond(model, "b");
  EXPECT_NEAR(end.position.y, 2.8, 2e-3);
  EXPECT_NEAR(end.position.x, 1, 1e-4);
}

TEST(Actuators, ADampingRatioIsOfTheMassThatTheActuatorMoves) {
  const auto damping = [](const std::string& joint) {
    const Import model = importText(
        mjcf("<body><joint type='slide' axis='1 0 0'/><geom size='0.1' mass='3'/><body name='b'>"
             "<joint name='j' type='slide' axis='1 0 0' " +
                 joint + "/><geom size='0.1' mass='6'/></body></body>",
             "<actuator><position joint='j' kp='50' dampratio='0.7' gear='2'/></actuator>"));
    return jointNamed(model, "j").axes[0];
  };
  // the two masses move against one another with mass 2, which the gear divides by 4 for the actuator
  EXPECT_NEAR(damping("").driveDamping, 4 * 2 * 0.7 * std::sqrt(50 * 2. / 4), 1e-9);
  const JointAxis sprung = damping("springdamper='0.1 0.5'");
  EXPECT_NEAR(sprung.damping, 2 * 2 / 0.1, 1e-9);
  EXPECT_NEAR(sprung.driveStiffness - 200, 2 / (0.1 * 0.1 * 0.5 * 0.5), 1e-9);
}

TEST(Actuators, AMuscleOfUnknownForceIsScaledByTheMassThatItMoves) {
  const auto muscle = [](double mass) {
    const Import model = importWith(
        "<body><joint name='j' type='slide'/><geom size='0.1' mass='" + std::to_string(mass) + "'/></body>",
        "<actuator><muscle joint='j' lengthrange='-1 1'/></actuator>", "0");
    return model.file.actuators.at(0).muscle;
  };
  EXPECT_NEAR(muscle(6).peakForce, 2 * muscle(3).peakForce, 1e-9);
  EXPECT_NEAR(muscle(3).peakForce, 200 * 3, 1e-9);
}

TEST(Actuators, AdhesionPullsItsBodyWithGainTimesControl) {
  const Import model = importWith("<body name='b'><freejoint/><geom size='0.1'/></body>",
                                  "<actuator><adhesion body='b' ctrlrange='0 1' gain='5'/></actuator>", "3");
  EXPECT_EQ(model.report.count(Effect::Lost), 0u) << convert::textOf(model.report, true);
  const ActuatorDef& pull = model.file.actuators.at(0);
  EXPECT_EQ(pull.type, ActuatorType::Adhesion);
  EXPECT_EQ(model.file.scene.bodies[static_cast<std::size_t>(pull.body)].name, "b");
  EXPECT_DOUBLE_EQ(pull.gain.x, 5);
  EXPECT_DOUBLE_EQ(pull.control, 1);
}

/// A tendon over one hinge is shortest and longest at its limits, or where it is stretched out.
TEST(Actuators, AMuscleWithoutALengthRangeHasThatWithinTheLimitsOfItsJoints) {
  const auto muscleOf = [](const std::string& range) {
    return importText(mjcf("<site name='a' pos='-1 0 0'/><body><joint name='j' axis='0 0 1' range='" + range +
                               "'/><geom size='0.1'/><site name='b' pos='1 0 0'/></body>",
                           "<tendon><spatial name='t'><site site='a'/><site site='b'/></spatial></tendon>"
                           "<actuator><muscle tendon='t' range='0.5 1' force='9'/></actuator>"))
        .file.actuators.at(0)
        .muscle;
  };
  const auto length = [](double degrees) { return 2 * std::cos(degrees * std::acos(-1.) / 360); };
  EXPECT_NEAR(muscleOf("30 90").optimalLength, (length(30) - length(90)) / 0.5, 1e-6);
  EXPECT_NEAR(muscleOf("-40 90").optimalLength, (length(0) - length(90)) / 0.5, 1e-6);
}

TEST(Actuators, ThoseOfTheScenesFilesAreWhatTheyWere) {
  const Import model = importWith(
      "<body name='b'><joint name='j' range='-1 1'/><geom size='0.1' mass='2'/><site name='s'/></body>",
      "<actuator><muscle name='m' joint='j' force='7' timeconst='0.02 0.05'/>"
      "<position name='p' joint='j' kp='3' timeconst='0.1' inheritrange='0.5'/>"
      "<motor name='r' site='s' gear='0 1 2 0 3 0' ctrlrange='-1 2'/>"
      "<adhesion name='a' body='b' ctrlrange='0 1'/></actuator>",
      "0.3 2 0.4 0.5");
  std::vector<io::Fault> faults;
  const std::string text = io::toJson(model.file);
  const io::SceneFile read = io::parseScene(text, faults);
  EXPECT_TRUE(faults.empty()) << io::faultText("scene", faults);
  ASSERT_EQ(read.actuators.size(), 4u);
  EXPECT_EQ(io::toJson(read), text);
  EXPECT_NEAR(read.actuators[1].maxControl, 0.5 * std::acos(-1.) / 180, 1e-12);
}

TEST(Actuators, ThreeHingesOfABodyHaveTheirAnglesAsCoordinates) {
  const Import model = importText(
      mjcf("<body name='b'><joint name='x' axis='1 0 0' range='-90 90'/><joint name='z' axis='0 0 1' "
           "range='-70 70'/><joint name='y' axis='0 1 0'/><geom pos='0.3 0.1 0' size='0.1' mass='2'/></body>",
           "<keyframe><key name='k' qpos='0.5 -0.9 1.2'/></keyframe>"),
      "model.xml", [] {
        convert::ImportOptions options;
        options.key = "k";
        return options;
      }());
  EXPECT_EQ(model.report.count(Effect::Approximate), 0u) << convert::textOf(model.report, true);
  const World world(model.file.scene, {});
  const JointState state = world.state(world.joints()[0]);
  EXPECT_STREQ(keyword(jointNamed(model, "x+z+y").type), "gimbal");
  // outer, middle and inner hinge are about z, y and x of the joint, the middle one in either direction
  EXPECT_NEAR(state.axes[5].position, 0.5, 1e-5);
  EXPECT_NEAR(std::fabs(state.axes[4].position), 0.9, 1e-5);
  EXPECT_NEAR(state.axes[3].position, 1.2, 1e-5);
}

TEST(Actuators, ALimitSofterThanUsualHasItsStiffnessAndDampingRatio) {
  const auto axisOf = [](const std::string& solref) {
    const Import model = importText(mjcf("<body><joint name='j' type='slide' range='0 1' solreflimit='" +
                                         solref + "'/><geom size='0.1' mass='3'/></body>"));
    return jointNamed(model, "j").axes[0];
  };
  // (1 - d) m g = K x with K = m / (time constant * damping ratio)^2, d = 0.95
  const double stiffness = 3 / (0.1 * 0.1 * 0.7 * 0.7) / 0.05;
  EXPECT_NEAR(axisOf("0.1 0.7").limitStiffness, stiffness, 1e-9 * stiffness);
  EXPECT_NEAR(axisOf("0.1 0.7").limitDamping, 2 * 0.7 * std::sqrt(3 * stiffness), 1e-9 * stiffness);
  const double direct = 3 * 300 / 0.05;
  EXPECT_NEAR(axisOf("-300 -20").limitStiffness, direct, 1e-9 * direct);
  EXPECT_EQ(axisOf("0.02 1").limitStiffness, kHard);
  EXPECT_EQ(axisOf("0.004 1").limitStiffness, kHard);
}

TEST(Actuators, TendonsAndConstraintsTakeTheDefaultsOfTheirKind) {
  const Import model = importText(
      mjcf("<body><joint name='i' type='slide'/><geom size='0.1'/></body>"
           "<body><joint name='j' type='slide'/><geom size='0.1'/></body>",
           "<default><tendon damping='3'/><equality active='false'/><default class='c'><tendon damping='4'/>"
           "</default></default>"
           "<tendon><fixed name='s'><joint joint='i' coef='1'/></fixed>"
           "<fixed name='t' class='c'><joint joint='j' coef='1'/></fixed></tendon>"
           "<equality><joint joint1='i' joint2='j'/></equality>"));
  EXPECT_DOUBLE_EQ(jointNamed(model, "s").axes[0].damping, 3);
  EXPECT_DOUBLE_EQ(jointNamed(model, "t").axes[0].damping, 4);
  EXPECT_EQ(model.file.scene.joints.size(), 4u);
}

TEST(Actuators, ASumOfAChainOfParallelJointsIsOneCoordinate) {
  std::string open, close, sum;
  for (int i = 0; i < 6; ++i) {
    const std::string name = "s" + std::to_string(i);
    open += "<body name='" + name + "' pos='0.1 0 0'><joint name='" + name +
            "' type='slide' axis='1 0 0' damping='20'/><geom size='0.02' mass='0.1'/>";
    close += "</body>";
    sum += "<joint joint='" + name + "' coef='1'/>";
  }
  const Import model = importWith(open + close,
                                  std::string(kStill) + "<tendon><fixed name='t'>" + sum +
                                      "</fixed></tendon><actuator><position tendon='t' kp='900'/></actuator>",
                                  "0.3");
  EXPECT_EQ(model.report.count(Effect::Lost), 0u) << convert::textOf(model.report, true);
  EXPECT_EQ(std::any_cast<const TendonFields&>(jointNamed(model, "t").own).terms.size(), 13u);
  EXPECT_NEAR(afterHalfASecond(model, "s5").position.x, 0.6 + 0.3, 2e-3);
}

TEST(Actuators, GeomsOfTheWorldWithoutNamesGiveAValidScene) {
  const Import model = importText(mjcf("<geom type='plane' size='1 1 1'/><geom type='box' size='1 1 1'/>"));
  EXPECT_EQ(model.file.scene.bodies.size(), 2u);
  std::vector<io::Fault> faults;
  io::parseScene(io::toJson(model.file), faults);
  EXPECT_TRUE(faults.empty()) << io::faultText("scene", faults);
}

TEST(Actuators, ThoseOfGearZeroStayAndDoNothing) {
  for (const char* const gear : {"0", "-0", "1e-200"}) {
    const Import model = importText(
        mjcf("<body><joint name='j' axis='0 0 1'/><geom size='1'/></body>",
             std::string("<actuator><position name='p' joint='j' kp='10' kv='2' gear='") + gear +
                 "'/><velocity name='v' joint='j' kv='3' gear='" + gear + "'/></actuator>"));
    World world(model.file.scene);
    Actuators actuators(model.file.actuators, world);
    std::ranges::fill(actuators.controls(), 1.);
    for (int step = 0; step < 20; ++step) actuators.apply(world), world.step();
    EXPECT_EQ(world.state(world.bodies().front()).angularVelocity, Vec3{}) << gear;
  }
}

TEST(Actuators, NamesThatSceneFilesRefuseAreOthers) {
  const std::string ball = "<freejoint/><geom size='.1'/>";
  const Import model = importText(mjcf("<body name='foot*'>" + ball +
                                       "</body><body name='foot_' pos='1 0 0'>" + ball +
                                       "</body><geom name='*' type='plane' size='1 1 1'/>"));
  std::vector<io::Fault> faults;
  io::parseScene(io::toJson(model.file), faults);
  EXPECT_TRUE(faults.empty()) << io::faultText("scene", faults);
  for (const char* const name : {"foot_", "foot__2", "_"}) bodyNamed(model, name);
}

/// Boxes of random sizes and places: the primitive that is fitted to one has its inertia, or sizes in the
/// proportion of its edges.
TEST(Actuators, PrimitivesThatAreFittedToAMeshHaveItsBox) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> size(0.05, 0.1);
  for (int round = 0; round < 20; ++round) {
    const double a = size(random), b = a * 1.3, c = a * 2;
    std::string corners;
    for (int i = 0; i < 8; ++i)
      corners += std::to_string(0.3 + (i & 1 ? c : -c)) + " " + std::to_string(0.2 + (i & 2 ? a : -a)) + " " +
                 std::to_string(i & 4 ? b : -b) + " ";
    const auto shapeOf = [&](const std::string& type) {
      return bodyNamed(
                 importText(mjcf("<body name='m'><freejoint/><geom type='" + type + "' mesh='q'/></body>",
                                 "<asset><mesh name='q' vertex='" + corners + "'/></asset>")),
                 "m")
          .shape.geometry->parts.at(0);
    };
    const ShapePartDef box = shapeOf("box"), rod = shapeOf("capsule");
    EXPECT_LT(length(box.shape.halfExtents - Vec3{a, b, c}), 1e-5);
    EXPECT_LT(length(box.position - Vec3{0.3, 0.2, 0}), 1e-5);
    EXPECT_NEAR(std::fabs(rotate(rod.orientation, Vec3{0, 0, 1}).x), 1, 1e-6);
    EXPECT_NEAR(rod.shape.radius, (a + b) / 2, 1e-5);
    EXPECT_NEAR(rod.shape.halfLength, c - (a + b) / 4, 1e-5);
  }
}

#if defined(RUBBLE_HAS_PNG)
/// Random pictures: their red channel from the top is the elevation of the same model, row by row.
TEST(HeightFields, APictureGivesTheHeightsOfItsRedChannel) {
  std::mt19937 random(3);
  for (int round = 0; round < 10; ++round) {
    io::Image picture{3 + round, 2 + round % 4, {}};
    std::string elevation;
    for (int i = 0; i < picture.width * picture.height; ++i) {
      const auto red = static_cast<std::uint8_t>(random() % 256);
      picture.rgb.insert(picture.rgb.end(), {red, 7, static_cast<std::uint8_t>(i)});
      elevation += std::to_string(red) + " ";
    }
    const test::ModelFolder folder;
    io::writePng(picture, (folder.path() / "hills.png").string());
    const auto heightsOf = [&](const std::string& field) {
      const std::string file = folder.write(
          "model.xml", mjcf("<geom name='g' type='hfield' hfield='hills'/>",
                            "<asset><hfield name='hills' size='2 1 0.3 0.1' " + field + "/></asset>"));
      const Import model = convert::importModel(file);
      const ShapeGeometry& shape = *bodyNamed(model, "g").shape.geometry;
      return std::pair{shape.counts, shape.samples};
    };
    EXPECT_EQ(heightsOf("file='hills.png'"),
              heightsOf("nrow='" + std::to_string(picture.height) + "' ncol='" +
                        std::to_string(picture.width) + "' elevation='" + elevation + "'"));
  }
}
#endif

}  // namespace
}  // namespace rubble
