/// What imported models look like in pictures.
#include <cmath>

#include <gtest/gtest.h>

#include "io/look_table.h"
#include "io/scene_json.h"
#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Effect;
using convert::Import;
using test::bodyNamed;
using test::expectNear;
using test::importText;
using test::mjcf;

/// The look of a body; none: an empty one.
Look lookOf(const Import& model, const std::string& body) {
  for (const Look& look : model.file.appearance.looks)
    if (body == "world"
            ? look.body == kWorld
            : look.body >= 0 && model.file.scene.bodies[static_cast<std::size_t>(look.body)].name == body)
      return look;
  return {};
}

const char* const kTetrahedron = "<mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/>";

TEST(Looks, ColorsAreThoseOfGeomsMaterialsAndTextures) {
  const Import model = importText(mjcf(
      "<body name='b'><freejoint/><geom size='.1' rgba='1 0 .5 1'/><geom size='.2' material='m'/>"
      "<geom size='.3' material='m' rgba='0 0 1 1'/><geom size='.4' material='t'/></body>",
      "<asset><texture name='c' builtin='checker' rgb1='1 1 1' rgb2='0 0 0'/>"
      "<material name='m' rgba='.25 .5 .75 1'/><material name='t' texture='c' rgba='1 .5 0 1'/></asset>"));
  const Look look = lookOf(model, "b");
  ASSERT_EQ(look.parts.size(), 4u);
  expectNear(look.parts[0].color.value(), {1, 0, .5});
  expectNear(look.parts[1].color.value(), {.25, .5, .75});
  expectNear(look.parts[2].color.value(), {0, 0, 1});
  expectNear(look.parts[3].color.value(), {.5, .25, 0});
  EXPECT_EQ(model.report.count(Effect::Lost), 0u) << convert::textOf(model.report, true);
}

TEST(Looks, MeshesAreDrawnWholeAndNotAsTheirHulls) {
  const Import model = importText(
      mjcf("<body name='b' pos='0 0 1'><freejoint/><geom type='mesh' mesh='m' pos='1 2 3' rgba='1 0 0 1'/>"
           "<geom name='flat' type='mesh' mesh='f' contype='0' conaffinity='0' mass='0'/></body>",
           std::string("<asset>") + kTetrahedron +
               "<mesh name='f' vertex='0 0 0 1 0 0 0 1 0' face='0 1 2' inertia='shell'/></asset>"));
  const Look look = lookOf(model, "b");
  ASSERT_EQ(look.parts.size(), 2u);
  EXPECT_EQ(look.parts[0].shape.type, ShapeType::Mesh);
  EXPECT_EQ(look.parts[0].shape.geometry->triangles.size(), 4u);
  expectNear(look.parts[0].position, {1, 2, 3});
  EXPECT_EQ(look.parts[1].shape.geometry->triangles.size(), 1u);
}

TEST(Looks, WhatMuJoCoHidesIsHiddenAndWhatCollidesAloneIsDrawnAsItIs) {
  const Import model = importText(
      mjcf("<body name='b'><freejoint/><geom name='box' type='box' size='.1 .1 .1' group='3'/>"
           "<geom size='.2' contype='0' conaffinity='0' group='2' rgba='0 1 0 1' mass='0'/>"
           "<geom size='.3' contype='0' conaffinity='0' rgba='0 1 0 0' mass='0'/></body>"
           "<body name='plain'><freejoint/><geom size='.1' group='3'/></body>"
           "<body name='gray'><freejoint/><geom size='.1'/></body>"));
  const Look look = lookOf(model, "b");
  ASSERT_EQ(look.parts.size(), 1u);
  EXPECT_EQ(look.parts[0].shape.radius, .2);
  EXPECT_TRUE(lookOf(model, "plain").parts.empty());
  EXPECT_EQ(model.file.appearance.looks.size(), 1u) << "a body that looks like its shape has a look";
}

TEST(Looks, StaticGeomsHaveTheirColorsAndThoseThatCollideWithNothingAreScenery) {
  const Import model = importText(
      mjcf("<geom name='floor' type='plane' size='1 1 1' rgba='.2 .3 .4 1'/>"
           "<geom name='sign' type='box' size='1 2 3' pos='5 0 0' contype='0' conaffinity='0' "
           "rgba='1 1 0 1'/>"));
  const Look floor = lookOf(model, "floor"), scenery = lookOf(model, "world");
  ASSERT_EQ(floor.parts.size(), 1u);
  expectNear(floor.parts[0].color.value(), {.2, .3, .4});
  ASSERT_EQ(scenery.parts.size(), 1u);
  expectNear(scenery.parts[0].position, {5, 0, 0});
}

TEST(Looks, AllCamerasAndTheFirstDirectionalLightAreKept) {
  const Import model = importText(
      mjcf("<camera name='side' pos='0 -4 0' xyaxes='1 0 0 0 0 1' fovy='60'/>"
           "<body name='b' pos='0 0 2'><freejoint/><geom size='.1'/>"
           "<camera name='top' pos='0 0 3'/></body>"
           "<light name='bulb' pos='0 0 3'/><light name='sun' directional='true' dir='0 3 -4'/>"));
  const std::vector<NamedCamera>& cameras = model.file.appearance.cameras;
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras[0].name, "side");
  expectNear(normalize(cameras[0].target - cameras[0].eye), {0, 1, 0}, 1e-9);
  EXPECT_NEAR(cameras[0].fieldOfView.value(), std::acos(-1.) / 3, 1e-9);
  expectNear(cameras[1].eye, {0, 0, 5}, 1e-9);
  expectNear(model.file.appearance.daylight.toSun.value(), {0, -.6, .8}, 1e-9);
  EXPECT_EQ(model.report.count(Effect::Lost), 0u) << convert::textOf(model.report, true);
}

TEST(Looks, CamerasOfAttachedModelsMoveWithThem) {
  const test::ModelFolder folder;
  folder.write("part.xml", mjcf("<body name='b'><geom size='.1'/><camera name='eye' pos='0 0 1'/></body>"));
  const Import model = convert::importModel(
      folder.write("whole.xml", mjcf("<frame pos='3 0 0'><attach model='m' body='b' prefix='p_'/></frame>",
                                     "<asset><model name='m' file='part.xml'/></asset>")));
  ASSERT_EQ(model.file.appearance.cameras.size(), 1u);
  EXPECT_EQ(model.file.appearance.cameras[0].name, "p_eye");
  expectNear(model.file.appearance.cameras[0].eye, {3, 0, 1}, 1e-9);
}

TEST(Looks, UrdfVisualsHaveTheColorsOfTheirMaterials) {
  convert::ImportOptions options;
  options.floatingBase = true;
  const Import model = importText(
      "<robot name='r'><material name='red'><color rgba='1 0 0 1'/></material><link name='a'>"
      "<collision><geometry><box size='1 1 1'/></geometry></collision>"
      "<visual><origin xyz='0 0 2'/><geometry><sphere radius='.5'/></geometry><material name='red'/></visual>"
      "<visual><geometry><sphere radius='.25'/></geometry><material name='own'><color rgba='0 .5 0 1'/>"
      "</material></visual></link></robot>",
      "model.urdf", options);
  const Look look = lookOf(model, "a");
  ASSERT_EQ(look.parts.size(), 2u);
  expectNear(look.parts[0].color.value(), {1, 0, 0});
  expectNear(look.parts[0].position, {0, 0, 2});
  expectNear(look.parts[1].color.value(), {0, .5, 0});
}

TEST(Looks, UsdGeometryIsDrawnInItsDisplayColorOrPreviewSurface) {
  const Import model = importText(R"(#usda 1.0
(upAxis = "Z" metersPerUnit = 1)
def Xform "body" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {
  def Cube "collider" (prepend apiSchemas = ["PhysicsCollisionAPI"]) { token purpose = "guide" }
  def Sphere "ball" { color3f[] primvars:displayColor = [(1, 0, 0)]
    double3 xformOp:translate = (0, 0, 3)
    uniform token[] xformOpOrder = ["xformOp:translate"] }
  def Sphere "hidden" { token visibility = "invisible" }
  def Sphere "painted" { rel material:binding = </paint> }
}
def Material "paint" {
  def Shader "s" { uniform token info:id = "UsdPreviewSurface"
    color3f inputs:diffuseColor = (0, 0, 1) }
}
)",
                                  "model.usda");
  const Look look = lookOf(model, "body");
  ASSERT_EQ(look.parts.size(), 2u);
  expectNear(look.parts[0].color.value(), {1, 0, 0}, 1e-9);
  expectNear(look.parts[0].position, {0, 0, 3}, 1e-9);
  expectNear(look.parts[1].color.value(), {0, 0, 1}, 1e-9);
}

TEST(Looks, SceneFilesKeepThemBitForBit) {
  const Import model = importText(
      mjcf("<camera name='side' pos='0 -4 0' xyaxes='1 0 0 0 0 1'/><light directional='true' dir='1 0 -1'/>"
           "<geom name='sign' type='box' size='1 2 3' contype='0' conaffinity='0' rgba='1 1 0 1'/>"
           "<body name='b'><freejoint/><geom type='mesh' mesh='m' rgba='.1 .2 .3 1'/></body>",
           std::string("<asset>") + kTetrahedron + "</asset>"));
  const std::string text = io::toJson(model.file);
  std::vector<io::Fault> faults;
  const io::SceneFile back = io::parseScene(text, faults);
  ASSERT_TRUE(faults.empty()) << faults.front().text();
  EXPECT_EQ(back.appearance.looks.size(), 2u);
  EXPECT_EQ(io::toJson(back), text);
}

TEST(Looks, APartFollowsItsBodyAndABodyOfAnotherShapeHasNone) {
  io::PictureBody body;
  body.shape = Shape::sphere(1), body.key = 4;
  const std::vector<Look> looks{{4, {{Shape::sphere(.5), {1, 0, 0}, {}, Vec3{1, 0, 0}}}},
                                {kWorld, {{Shape::box({1, 1, 1}), {7, 0, 0}, {}, {}}}}};
  const io::LookTable table(looks, std::vector{body});
  body.position = {0, 0, 2}, body.orientation = fromAxisAngle({0, 0, 1}, std::acos(0.));
  const std::vector<io::PictureBody> drawn = table.applied(std::vector{body});
  ASSERT_EQ(drawn.size(), 2u);
  expectNear(drawn[0].position, {7, 0, 0});
  expectNear(drawn[1].position, {0, 1, 2}, 1e-9);
  EXPECT_EQ(drawn[1].key, 4u);
  io::PictureBody stand;
  stand.key = io::kStandKeys;
  EXPECT_EQ(table.applied(std::vector{body, stand}).size(), 2u);
  body.shape = Shape::sphere(2);
  EXPECT_EQ(table.applied(std::vector{body}).back().shape.radius, 2);
}

}  // namespace
}  // namespace rubble
