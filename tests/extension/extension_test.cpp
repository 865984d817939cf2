/// What follows from the headers of a joint, an element and a shape that exist only in extension.h: files,
/// validation, listings, conversion, steps. Finite differences: tests/forces, which this program compiles
/// too.
#include <algorithm>

#include <gtest/gtest.h>
#include <rubble/info.h>
#include <rubble/rubble.h>

#include <rubble/mesh.h>
#include "backend/engine.h"
#include "collision/point_shape.h"
#include "cook/cook.h"
#include "forces/joint_kind.h"
#include "io/scene_json.h"
#include "tests/support/core.h"

namespace rubble {

// this program has the core in double only
namespace f32 {
std::unique_ptr<Engine> makeCpuEngine(const CpuOptions&) { return nullptr; }
std::uint64_t tableLayout() { return 0; }
}  // namespace f32

namespace {

/// A box in front of a wall, held by a planar joint, a square of four vertices with struts, and an ellipsoid.
constexpr const char* kScene = R"({
  "gravity": [0, 0, -10],
  "bodies": [
    {"name": "floor", "motion": "static", "shape": {"type": "plane"}},
    {"name": "slab", "shape": {"type": "box", "size": [1, 1, 1]}, "position": [0, 0, 5]},
    {"name": "egg", "shape": {"type": "ellipsoid", "size": [1, 1, 2]}, "position": [9, 0, 1.5]}
  ],
  "joints": [
    {"name": "guide", "type": "planar", "body_a": "slab", "body_b": "world", "anchor_a": [0, 0, 0],
     "anchor_b": [0, 0, 5], "offset": 0.25, "break_force": 1e6}
  ],
  "deformables": [
    {"type": "particles", "radius": 0.01, "vertices": [[20, 0, 3], [20.2, 0, 3]], "fixed": [0],
     "elements": [{"type": "strut", "vertices": [0, 1], "stiffness": 2000, "rest_length": 0.2}]}
  ]
})";

io::SceneFile read(const std::string& text) {
  std::vector<io::Fault> faults;
  io::SceneFile file = io::parseScene(text, faults);
  for (const io::Fault& fault : faults) ADD_FAILURE() << fault.text();
  return file;
}
std::string firstFault(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  std::vector<io::Fault> faults;
  io::parseScene(text, faults);
  return faults.empty() ? "none" : faults.front().text();
}
template <class Spoil> std::string errorOf(Spoil&& spoil) {
  Scene scene = read(kScene).scene;
  spoil(scene);
  try {
    validate(scene);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Extension, ReadsAndWritesItsFields) {
  const io::SceneFile file = read(kScene);
  const JointDef& joint = file.scene.joints.at(0);
  EXPECT_EQ(joint.type, jointType("planar"));
  EXPECT_STREQ(keyword(joint.type), "planar");
  EXPECT_EQ(ownIn<PlanarFields>(joint.own).offset, .25);
  const ElementDef& strut = common(file.scene.deformables.at(0)).elements.at(0);
  EXPECT_EQ(ownIn<StrutModel>(strut.fields).stiffness, 2000);
  const Shape& egg = file.scene.bodies.at(2).shape;
  EXPECT_EQ(egg.type, shapeType("ellipsoid"));
  EXPECT_EQ(egg.halfExtents, (Vec3{.5, .5, 1}));
  const std::string text = io::toJson(file);
  EXPECT_EQ(io::toJson(read(text)), text);
  for (const char* part :
       {"\"offset\": 0.25", "\"stiffness\": 2000", "\"rest_length\": 0.2", "\"ellipsoid\""})
    EXPECT_TRUE(has(text, part)) << part << text;
}

TEST(Extension, FaultsOfFilesHaveAPathAndAWish) {
  EXPECT_TRUE(has(firstFault(kScene, "\"offset\": 0.25", "\"offset\": -1"),
                  "joints[0].offset: expected a number "
                  "of at least 0 [m]"));
  EXPECT_TRUE(has(firstFault(kScene, "\"offset\"", "\"ofset\""), "joints[0].ofset: unknown key"));
  EXPECT_TRUE(has(firstFault(kScene, "planar", "planer"), "did you mean \"planar\"?"));
  EXPECT_TRUE(has(firstFault(kScene, "2000", "0"), "deformables[0].elements[0].stiffness"));
  EXPECT_TRUE(
      has(firstFault(kScene, "[1, 1, 2]", "[1, 0, 2]"), "bodies[2].shape.size[1]: expected a length"));
}

TEST(Extension, ValidationHasAPathToEachField) {
  EXPECT_EQ(errorOf([](Scene&) {}), "none");
  EXPECT_TRUE(has(errorOf([](Scene& s) { s.joints[0].own = PlanarFields{-1}; }), "joints[0].offset"));
  EXPECT_TRUE(has(errorOf([](Scene& s) { s.joints[0].own = 7; }), "joints[0].own"));
  EXPECT_TRUE(has(errorOf([](Scene& s) { s.joints[0].stiffness = .5; }), "joints[0].stiffness"));
  const auto element = [](Scene& s) -> ElementDef& { return common(s.deformables[0]).elements[0]; };
  const std::string at = "deformables[0].elements[0]";
  EXPECT_TRUE(has(errorOf([&](Scene& s) { element(s).fields = StrutModel{{}, -1, 1}; }), at + ".stiffness"));
  EXPECT_TRUE(has(errorOf([&](Scene& s) { element(s).vertices = {0, 1, 1}; }), at + ".vertices"));
  EXPECT_TRUE(has(errorOf([&](Scene& s) { element(s).vertices = {0, 7}; }), at + ".vertices"));
  EXPECT_TRUE(has(errorOf([&](Scene& s) { element(s).type = "strit"; }), at + ".type"));
  EXPECT_TRUE(
      has(errorOf([](Scene& s) { s.bodies[2].shape.halfExtents.y = 0; }), "bodies[2].shape.halfExtents.y"));
}

TEST(Extension, IsListedWithItsFields) {
  const std::vector<ForceInfo> forces = forceInfos();
  const auto force = std::find_if(forces.begin(), forces.end(), [](auto& f) { return f.name == "planar"; });
  ASSERT_NE(force, forces.end());
  EXPECT_EQ(force->rows, 3);
  EXPECT_TRUE(std::any_of(force->fields.begin(), force->fields.end(),
                          [](const ForceField& f) { return f.field == "offset" && f.unit == "m"; }));
  const std::vector<DeformableInfo> infos = deformableInfos();
  const auto strut = std::find_if(infos.begin(), infos.end(), [](auto& i) { return i.name == "strut"; });
  ASSERT_NE(strut, infos.end());
  EXPECT_EQ(strut->fields.size(), 2u);
}

TEST(Extension, DefinitionBecomesRowsAndConstants) {
  JointDef def;
  def.type = jointType("planar");
  def.own = PlanarFields{.5};
  def.stiffness = 300;
  const EngineJoint joint = kindOf(def.type).build(def, {}, nullptr);
  EXPECT_EQ(joint.type, typeIndex<RUBBLE_CORE::PlanarJoint>(RUBBLE_CORE::JointTypes{}));
  ASSERT_EQ(joint.groups.size(), 2u);
  EXPECT_EQ(joint.groups[0].stiffness, 300);
  EXPECT_EQ(RUBBLE_CORE::PlanarJoint::Data::of(joint).offset, .5);
}

TEST(Extension, ShapeHasMassBoundsSupportDistanceAndMesh) {
  using namespace RUBBLE_CORE;
  Shape shape{shapeType("ellipsoid"), {.5, 1, 2}, 0, 0};
  const MassProperties mass = massProperties(shape, 1000);
  EXPECT_NEAR(mass.mass, 4000. / 3 * std::numbers::pi, 1e-9);
  const ShapeMesh mesh = shapeMesh(shape);
  double volume = 0;
  for (const auto& t : mesh.triangles)
    volume += dot(mesh.points[std::size_t(t[0])],
                  cross(mesh.points[std::size_t(t[1])], mesh.points[std::size_t(t[2])])) /
              6;
  EXPECT_NEAR(volume, mass.mass / 1000, .03 * volume);
  const CookedShape cooked = cook(shape);
  EXPECT_EQ(cooked.shape.kind, addedKind<Ellipsoid>());
  EXPECT_GE(cooked.radius, 2);
  const ShapeData data{cooked.shape.half, 0, cooked.shape.kind, -1};
  const Convex convex = convexOf({}, data);
  test::Random random(1);
  for (int n = 0; n < 50; ++n) {
    const Vec3 d = random.direction(), x = support(convex, d);
    for (const rubble::Vec3& p : mesh.points) EXPECT_LE(dot(p, d), dot(x, d) + 1e-9);
    const PointDistance at = pointToConvex({}, data, x);
    EXPECT_NEAR(at.distance, 0, 1e-12);
    EXPECT_NEAR(dot(at.n, d), 1, 1e-12) << "the support point has that normal";
  }
}

TEST(Extension, IsSimulated) {
  WorldOptions options;
  options.backend = "reference";
  World world(read(kScene).scene, options);
  for (int i = 0; i < 240; ++i) world.step();
  // the slab falls within the plane x = 0.25 until it lies on the floor
  const BodyState slab = world.state(world.findBody("slab"));
  EXPECT_NEAR(slab.position.x, .25, 1e-3);
  EXPECT_NEAR(slab.position.z, .5, 1e-2);
  // the egg, which stood on its tip, lies or stands, and does not sink in
  const BodyState egg = world.state(world.findBody("egg"));
  EXPECT_GT(egg.position.z, .49);
  EXPECT_LT(egg.position.z, 1.01);
  // the grain hangs from the fixed one; K = 2 kN/m holds its few milligrams at the rest length
  const std::vector<Vec3> grains = world.positions(world.deformables().at(0));
  EXPECT_NEAR(length(grains[1] - grains[0]), .2, 1e-2);
}

}  // namespace
}  // namespace rubble
