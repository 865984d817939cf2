/// URDF and SRDF.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Effect;
using convert::Import;
using convert::ImportOptions;
using test::bodyNamed;
using test::importText;
using test::jointNamed;
using test::messageOf;

const std::string kMass =
    "<inertial><mass value='2'/><inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial>";

std::string twoLinks(const std::string& joint) {
  return "<robot name='r'><link name='base'/><link name='arm'>" + kMass + "</link><joint name='j' " + joint +
         "</joint></robot>";
}
const std::string kEnds = "<parent link='base'/><child link='arm'/>";

TEST(Urdf, ARevoluteJointIsAHingeWithLimitsInRadians) {
  const Import model = importText(
      twoLinks("type='revolute'>" + kEnds +
               "<origin xyz='0 0 1'/><axis xyz='0 1 0'/><limit lower='-1' upper='2'/>"
               "<dynamics damping='.5' friction='.2'/>"),
      "r.urdf");
  const JointDef& joint = jointNamed(model, "j");
  EXPECT_EQ(joint.type, JointType::Hinge);
  EXPECT_DOUBLE_EQ(joint.axes[0].min, -1);
  EXPECT_DOUBLE_EQ(joint.axes[0].max, 2);
  EXPECT_DOUBLE_EQ(joint.axes[0].damping, .5);
  EXPECT_DOUBLE_EQ(joint.axes[0].friction, .2);
  EXPECT_NEAR(rotate(joint.frameB, Vec3{1, 0, 0}).y, 1, 1e-12);
  EXPECT_EQ(joint.bodyB, kWorld);
}

TEST(Urdf, TypesOfJointsHaveTheirFreedom) {
  EXPECT_EQ(jointNamed(importText(twoLinks("type='continuous'>" + kEnds), "r.urdf"), "j").axes[0].max, kFree);
  EXPECT_EQ(
      jointNamed(importText(twoLinks("type='prismatic'>" + kEnds + "<limit lower='0' upper='1'/>"), "r.urdf"),
                 "j")
          .type,
      JointType::Slider);
  EXPECT_TRUE(importText(twoLinks("type='floating'>" + kEnds), "r.urdf").file.scene.joints.empty());
  const Import planar = importText(twoLinks("type='planar'>" + kEnds + "<axis xyz='0 0 1'/>"), "r.urdf");
  ASSERT_EQ(planar.file.scene.joints.size(), 1u);
  int free = 0;
  for (const JointAxis& axis : planar.file.scene.joints[0].axes) free += axis.min != axis.max;
  EXPECT_EQ(free, 3);
}

TEST(Urdf, TheRootIsStaticUnlessTheBaseFloats) {
  const std::string text = "<robot name='r'><link name='base'>" + kMass + "</link></robot>";
  EXPECT_TRUE(importText(text, "r.urdf").file.scene.bodies.empty());
  ImportOptions options;
  options.floatingBase = true;
  EXPECT_EQ(bodyNamed(importText(text, "r.urdf", options), "base").motion, Motion::Dynamic);
}

TEST(Urdf, AMimicIsAGear) {
  const Import model = importText(
      "<robot name='r'><link name='base'/><link name='a'>" + kMass + "</link><link name='b'>" + kMass +
          "</link><joint name='ja' type='continuous'><parent link='base'/><child link='a'/></joint>"
          "<joint name='jb' type='continuous'><parent link='base'/><child link='b'/><mimic joint='ja' "
          "multiplier='-2'/></joint>"
          "</robot>",
      "r.urdf");
  const JointDef& gear = jointNamed(model, "jb_mimic");
  EXPECT_EQ(gear.type, JointType::Gear);
  EXPECT_DOUBLE_EQ(gear.ratio, 2);
}

TEST(Urdf, PackagesAreFoundUpwardOrByOption) {
  const std::string tetra = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const std::string text =
      "<robot name='r'><link name='base'><collision><geometry>"
      "<mesh filename='package://robot_meshes/tetra.obj'/></geometry></collision></link></robot>";
  const test::ModelFolder folder;
  folder.write("robot_meshes/tetra.obj", tetra);
  EXPECT_EQ(convert::importModel(folder.write("urdf/deep/r.urdf", text)).file.scene.bodies.size(), 1u);
  folder.write("elsewhere/tetra.obj", tetra);
  folder.write("urdf/deep/s.urdf", std::string(text).replace(text.find("robot_meshes"), 12, "named"));
  ImportOptions options;
  const std::string file = (folder.path() / "urdf/deep/s.urdf").string();
  const Import without = convert::importModel(file, options);
  ASSERT_EQ(without.report.count(Effect::Lost), 1u);
  EXPECT_NE(convert::textOf(without.report, true).find("--package"), std::string::npos);
  options.packages["named"] = (folder.path() / "elsewhere").string();
  EXPECT_EQ(convert::importModel(file, options).file.scene.bodies.size(), 1u);
}

std::string robotWith(const std::string& kind, const std::string& mesh) {
  return "<robot name='r'><link name='base'><" + kind + "><geometry><mesh filename='" + mesh +
         "'/></geometry></" + kind + "></link></robot>";
}

TEST(Urdf, AMeshThatIsNotThereIsLostUnlessItIsOnlySeen) {
  EXPECT_EQ(importText(robotWith("visual", "none.stl"), "r.urdf").report.count(Effect::Lost), 0u);
  EXPECT_EQ(importText(robotWith("visual", "package://none/a.dae"), "r.urdf").report.count(Effect::Lost), 0u);
  EXPECT_EQ(importText(robotWith("collision", "none.dae"), "r.urdf").report.count(Effect::Lost), 1u);
  EXPECT_EQ(importText(robotWith("collision", "none.stl"), "r.urdf").report.count(Effect::Lost), 1u);
}

TEST(Urdf, FilesOfAPackageMayLieBesideTheFolderOfTheModel) {
  const std::string tetra = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const std::string text = robotWith("collision", "../meshes/tetra.obj");
  const test::ModelFolder folder;
  folder.write("named/meshes/tetra.obj", tetra);
  folder.write("plain/meshes/tetra.obj", tetra);
  folder.write("marked/package.xml", "<package/>");
  folder.write("marked/meshes/tetra.obj", tetra);
  const auto lost = [](const std::string& file) {
    return convert::importModel(file).report.count(Effect::Lost);
  };
  EXPECT_EQ(lost(folder.write("named/urdf/r.urdf", text)), 0u);
  EXPECT_EQ(lost(folder.write("marked/any/r.urdf", text)), 0u);
  EXPECT_EQ(lost(folder.write("plain/any/r.urdf", text)), 1u);
}

std::string movingLink(const std::string& content) {
  return "<robot name='r'><link name='base'/><link name='arm'>" + content + "</link><joint name='j' " +
         "type='continuous'><parent link='base'/><child link='arm'/></joint></robot>";
}

TEST(Urdf, ALinkWithoutAnInertialHasTheMassOfItsShapesInWater) {
  const Import model = importText(
      movingLink("<collision><origin xyz='0 0 1'/><geometry><box size='.1 .2 .3'/></geometry></collision>"),
      "r.urdf");
  EXPECT_NEAR(*bodyNamed(model, "arm").mass, 6, 1e-9);
  EXPECT_EQ(model.report.count(Effect::Approximate), 0u);
}

TEST(Urdf, ALinkThatMovesWithoutAnyMassGetsOne) {
  const Import model = importText(movingLink(""), "r.urdf");
  EXPECT_GT(*bodyNamed(model, "arm").mass, 0);
  EXPECT_EQ(model.report.count(Effect::Approximate), 1u);
}

/// Random tensors, half of which no solid has: those stay as they are that one has.
TEST(Urdf, AnInertiaThatNoSolidHasBecomesOneThatASolidHas) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-0.3, 1);
  int kept = 0, changed = 0;
  for (int round = 0; round < 200; ++round) {
    const std::array<double, 6> t{number(random),       number(random),       number(random),
                                  number(random) * 0.2, number(random) * 0.2, number(random) * 0.2};
    std::string inertia;
    const char* keys[] = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    for (std::size_t k = 0; k < 6; ++k) inertia += std::string(keys[k]) + "='" + std::to_string(t[k]) + "' ";
    const Import model = importText(
        movingLink("<inertial><mass value='2'/><inertia " + inertia + "/></inertial>"), "r.urdf");
    const MassProperties mass = massProperties(bodyNamed(model, "arm").shape, 1);
    const Vec3& i = mass.inertia;
    EXPECT_GT(std::min({i.x, i.y, i.z}), 0);
    EXPECT_LE(2 * std::max({i.x, i.y, i.z}), (i.x + i.y + i.z) * (1 + 1e-8));
    const bool exact = model.report.count(Effect::Approximate) == 0;
    (exact ? kept : changed) += 1;
    if (exact) {
      EXPECT_NEAR(i.x + i.y + i.z, t[0] + t[1] + t[2], 1e-5);
    }
  }
  EXPECT_GT(kept, 20);
  EXPECT_GT(changed, 20);
}

#if defined(RUBBLE_HAS_ASSIMP)
TEST(Urdf, ColladaKeepsTheAxesOfItsFileAndItsUnit) {
  for (const char* up : {"Y_UP", "Z_UP"}) {
    SCOPED_TRACE(up);
    const test::ModelFolder folder;
    folder.write("a.dae",
                 "<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'><asset>"
                 "<unit meter='0.01'/><up_axis>" +
                     std::string(up) +
                     "</up_axis></asset><library_geometries><geometry id='g'><mesh><source id='p'>"
                     "<float_array id='f' count='12'>0 0 0 100 0 0 0 200 0 0 0 300</float_array>"
                     "<technique_common><accessor source='#f' count='4' stride='3'><param name='X' "
                     "type='float'/><param name='Y' type='float'/><param name='Z' type='float'/></accessor>"
                     "</technique_common></source><vertices id='v'><input semantic='POSITION' source='#p'/>"
                     "</vertices><triangles count='4'><input semantic='VERTEX' source='#v' offset='0'/>"
                     "<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>"
                     "<library_visual_scenes><visual_scene id='s'><node><instance_geometry url='#g'/></node>"
                     "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene>"
                     "</COLLADA>");
    const Import model = convert::importModel(folder.write("r.urdf", robotWith("collision", "a.dae")));
    ASSERT_EQ(model.file.scene.bodies.size(), 1u) << convert::textOf(model.report, true);
    Vec3 high;
    for (const Vec3& x : model.file.scene.bodies[0].shape.geometry->points)
      for (int k = 0; k < 3; ++k) high[k] = std::max(high[k], x[k]);
    EXPECT_NEAR(length(high - Vec3{1, 2, 3}), 0, 1e-6) << high.x << " " << high.y << " " << high.z;
  }
}
#endif

TEST(Urdf, XacroHasToBeExpandedFirst) {
  const std::string message = messageOf([] {
    importText("<robot name='r'><xacro:property name='x' value='1'/><link name='base'/></robot>", "r.xacro");
  });
  EXPECT_NE(message.find("expand"), std::string::npos);
}

TEST(Urdf, SrdfExcludesPairsFromCollision) {
  const test::ModelFolder folder;
  const std::string ball = "<collision><geometry><sphere radius='.1'/></geometry></collision></link>";
  const std::string urdf = folder.write(
      "r.urdf",
      "<robot name='r'><link name='base'/><link name='a'>" + kMass + ball + "<link name='b'>" + kMass + ball +
          "<joint name='ja' type='continuous'><parent link='base'/><child link='a'/></joint>"
          "<joint name='jb' type='continuous'><parent link='base'/><child link='b'/></joint></robot>");
  ImportOptions options;
  options.srdf = folder.write("r.srdf", "<robot name='r'><disable_collisions link1='a' link2='b'/></robot>");
  EXPECT_EQ(convert::importModel(urdf, options).file.scene.exclusions.size(), 1u);
}

TEST(Urdf, LinksFormTrees) {
  const std::string loop =
      "<robot name='r'><link name='root'/><link name='a'/><link name='b'/>"
      "<joint name='x' type='fixed'><parent link='a'/><child link='b'/></joint>"
      "<joint name='y' type='fixed'><parent link='b'/><child link='a'/></joint></robot>";
  EXPECT_NE(messageOf([&] { importText(loop, "r.urdf"); }).find("loop"), std::string::npos);
  const Import two = importText("<robot name='r'><link name='a'/><link name='b'/></robot>", "r.urdf");
  EXPECT_EQ(two.report.count(Effect::Approximate), 1u);
}

TEST(Urdf, LimitsThatAreAbsentOrSwappedAreReported) {
  const Import without = importText(twoLinks("type='revolute'>" + kEnds), "r.urdf");
  EXPECT_EQ(jointNamed(without, "j").axes[0].max, kFree);
  EXPECT_EQ(without.report.count(Effect::Approximate), 1u);
  const Import swapped = importText(twoLinks("type='revolute'>" + kEnds + "<limit lower='1' upper='-2'/>"),
                                    "r.urdf");
  EXPECT_EQ(jointNamed(swapped, "j").axes[0].min, -2);
  EXPECT_EQ(swapped.report.count(Effect::Approximate), 1u);
  EXPECT_EQ(jointNamed(importText(twoLinks("type='spherical'>" + kEnds), "r.urdf"), "j").type,
            JointType::Ball);
}

}  // namespace
}  // namespace rubble
