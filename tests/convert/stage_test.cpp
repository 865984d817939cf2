/// USD and glTF: units, bodies, joints, composition, and the readers of both USD formats against our writers.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "convert/folders.h"
#include "convert/out/usd_layer.h"
#include "convert/usd/layer.h"
#include "convert/usd/packed.h"
#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Effect;
using convert::Import;
using test::bodyNamed;
using test::jointNamed;

using std::numbers::pi;
const std::string kFolder = std::string(RUBBLE_SOURCE_DIR) + "/tests/convert/models/";

void expectClose(const Vec3& a, const Vec3& b, double tolerance = 1e-9) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "axis " << k;
}
std::string usda(const std::string& prims, const std::string& settings = "upAxis = \"Z\" metersPerUnit = 1") {
  return "#usda 1.0\n( " + settings + " )\n" + prims;
}
/// A rigid body with a ball of 1 kg.
std::string ball(const std::string& name, const std::string& more = "", const std::string& metadata = "") {
  return "def Sphere \"" + name +
         "\" ( prepend apiSchemas = [\"PhysicsRigidBodyAPI\", \"PhysicsCollisionAPI\", \"PhysicsMassAPI\"] " +
         metadata + " ) { double radius = 0.5 float physics:mass = 1 " + more + " }\n";
}
std::string at(const std::string& place) {
  return "double3 xformOp:translate = " + place + " uniform token[] xformOpOrder = [\"xformOp:translate\"] ";
}
Import import(const std::string& text) { return convert::importContent(text, "stage.usda"); }

void write(convert::UsdLayer& layer) {
  using convert::Token;
  const std::vector<Vec3T<float>> points{{1, 2, 3}, {-4, 5.5f, 0}};
  const std::vector<int> counts(40, 3);
  const std::vector<Token> names{{"a"}, {"b"}};
  const int top = layer.prim(-1, "Top", "Xform"), mesh = layer.prim(top, "Mesh", "Mesh"),
            other = layer.prim(top, "Other", "Scope");
  layer.set(layer.attribute(mesh, "point3f[]", "points"), std::span<const Vec3T<float>>(points));
  layer.set(layer.attribute(mesh, "int[]", "faceVertexCounts"), std::span<const int>(counts));
  layer.set(layer.attribute(mesh, "double", "height"), 2.75);
  layer.set(layer.attribute(mesh, "bool", "shown"), true);
  layer.set(layer.attribute(mesh, "token", "axis", "", true), Token{"Y"});
  layer.set(layer.attribute(mesh, "token[]", "names"), std::span<const Token>(names));
  convert::Matrix4 matrix{};
  for (std::size_t i = 0; i < 16; ++i) matrix[i] = static_cast<double>(i) / 4;
  layer.set(layer.attribute(other, "matrix4d", "xformOp:transform"), matrix);
  const int moving = layer.attribute(other, "float", "speed");
  for (int k = 0; k < 3; ++k) layer.sample(moving, k, 1.5f + static_cast<float>(k));
  layer.relate(other, "source", {mesh});
  convert::UsdHead head;
  head.defaultPrim = "Top", head.yUp = true;
  layer.finish(head);
}

TEST(UsdLayer, BothFormatsReadWhatWeWrite) {
  const test::ModelFolder folder;
  const std::string text = (folder.path() / "a.usda").string(), crate = (folder.path() / "a.usdc").string();
  write(*convert::textLayer(text)), write(*convert::binaryLayer(crate));
  for (const std::string& file : {text, crate}) {
    SCOPED_TRACE(file);
    const usd::Layer layer = usd::parse(convert::bytesOf(file, file), file);
    EXPECT_EQ(layer.defaultPrim, "Top");
    EXPECT_EQ(layer.upAxis, "Y");
    EXPECT_EQ(layer.metersPerUnit, 1);
    const usd::Prim* const top = layer.root.child("Top");
    ASSERT_TRUE(top);
    const usd::Prim *const mesh = top->child("Mesh"), *const other = top->child("Other");
    ASSERT_TRUE(mesh && other);
    EXPECT_EQ(mesh->type, "Mesh");
    const auto numbers = [](const usd::Prim* prim, const char* name) {
      const usd::Property* const found = prim->find(name);
      return found ? found->value.numbers : std::vector<double>{};
    };
    EXPECT_EQ(numbers(mesh, "points"), (std::vector<double>{1, 2, 3, -4, 5.5, 0}));
    EXPECT_EQ(numbers(mesh, "faceVertexCounts"), std::vector<double>(40, 3));
    EXPECT_EQ(numbers(mesh, "height"), std::vector{2.75});
    EXPECT_EQ(numbers(mesh, "shown"), std::vector{1.});
    EXPECT_EQ(mesh->find("axis")->value.texts, std::vector<std::string>{"Y"});
    EXPECT_EQ(mesh->find("names")->value.texts, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(numbers(other, "xformOp:transform").at(7), 1.75);
    EXPECT_EQ(numbers(other, "speed"), std::vector{1.5});
    EXPECT_TRUE(other->find("speed")->isAnimated);
    EXPECT_EQ(other->find("source")->targets, std::vector<std::string>{"/Top/Mesh"});
  }
}

TEST(UsdLayer, UnpacksCopiesOfEarlierBytesAndRefusesOthers) {
  // three literals, then 9 bytes from 3 before
  const std::string packed{'\0', '\x35', 'a', 'b', 'c', '\x03', '\0'};
  EXPECT_EQ(usd::unpackBytes(packed, 100, "here"), "abcabcabcabc");
  EXPECT_THROW(usd::unpackBytes(packed, 11, "here"), Error);
  EXPECT_THROW(usd::unpackBytes(std::string{'\0', '\x35', 'a', 'b', 'c', '\x04', '\0'}, 100, "here"), Error);
  EXPECT_THROW(usd::unpackBytes("", 100, "here"), Error);
}

TEST(Usd, UnitsAndTheUpAxisBecomeMetersAndZ) {
  const Import model = import(
      usda(ball("b", at("(100, 200, 300)")) +
               "def PhysicsScene \"s\" { vector3f physics:gravityDirection = (0, 0, 1) "
               "float physics:gravityMagnitude = 500 }",
           "upAxis = \"Y\" metersPerUnit = 0.01 kilogramsPerUnit = 0.001"));
  expectClose(bodyNamed(model, "b").position, {1, -3, 2});
  EXPECT_NEAR(*bodyNamed(model, "b").mass, 1e-3, 1e-15);
  EXPECT_NEAR(bodyNamed(model, "b").shape.radius, .005, 1e-12);
  expectClose(model.file.scene.gravity, {0, -5, 0});
}

TEST(Usd, AMachineHasItsBodiesJointsAndFilters) {
  const Import model = convert::importModel(kFolder + "machine.usda");
  EXPECT_EQ(bodyNamed(model, "Machine/Gate").motion, Motion::Kinematic);
  const JointDef& axle = jointNamed(model, "Machine/Joints/FrontAxle");
  EXPECT_EQ(axle.type, JointType::Hinge);
  EXPECT_NEAR(axle.axes[0].targetSpeed, pi / 2, 1e-6);
  EXPECT_NEAR(axle.axes[0].driveDamping, 40 * 1e-4 * 180 / pi, 1e-9);
  EXPECT_NEAR(axle.axes[0].maxDriveForce, 20, 1e-6);
  EXPECT_EQ(jointNamed(model, "Machine/Joints/LiftSlide").type, JointType::Slider);
  EXPECT_EQ(jointNamed(model, "Machine/Joints/Shoulder").type, JointType::SwingTwist);
  EXPECT_NEAR(jointNamed(model, "Machine/Joints/Shoulder").swingZ, 40 * pi / 180, 1e-6);
  EXPECT_NEAR(jointNamed(model, "Machine/Joints/Leash").axes[0].max, .6, 1e-9);
  EXPECT_EQ(jointNamed(model, "Machine/Joints/Guide").type, JointType::SixDof);
  EXPECT_EQ(model.file.scene.exclusions.size(), 3u);
  EXPECT_EQ(model.report.count(Effect::Lost), 0u) << convert::textOf(model.report, true);
}

TEST(Usd, VariantsInheritsAndOverridesCompose) {
  const Import model = import(usda("class \"Base\" { double radius = 3 float physics:mass = 7 }\n" +
                                   ball("a", at("(0, 0, 9)"), "prepend inherits = </Base>") +
                                   "def \"b\" ( prepend references = </a> variants = { string size = \"big\" "
                                   "} ) { variantSet \"size\" = { "
                                   "\"small\" { double radius = 0.1 } \"big\" { double radius = 2 } } }"));
  // own values before those of the class, variants before references
  EXPECT_NEAR(bodyNamed(model, "a").shape.radius, .5, 1e-12);
  EXPECT_NEAR(bodyNamed(model, "b").shape.radius, 2, 1e-12);
  EXPECT_NEAR(*bodyNamed(model, "b").mass, 1, 1e-12);
  expectClose(bodyNamed(model, "b").position, {0, 0, 9});
}

TEST(Usd, ReferencesStayInsideOfTheFolderAndEnd) {
  const test::ModelFolder folder;
  folder.write("part.usda", usda(ball("part"), "defaultPrim = \"part\""));
  const std::string inside = folder.write(
      "a.usda", usda("def \"x\" ( references = @part.usda@ ) { " + at("(1, 0, 0)") + " }"));
  expectClose(bodyNamed(convert::importModel(inside), "x").position, {1, 0, 0});
  const Import outside = convert::importModel(
      folder.write("b.usda", usda("def \"x\" ( references = @../../../etc/passwd@ ) { }")));
  EXPECT_EQ(outside.report.count(Effect::Lost), 1u);
  const Import without = convert::importModel(
      folder.write("c.usda", usda(ball("b"), "upAxis = \"Z\" subLayers = [@none.usda@, @../up.usda@]")));
  EXPECT_EQ(without.report.count(Effect::Lost), 2u);
  EXPECT_EQ(without.file.scene.bodies.size(), 1u);
  for (const char* cycle :
       {"def \"a\" ( references = </b> ) { } def \"b\" ( references = </a> ) { }",
        "def \"a\" { def \"b\" ( references = </a> ) { } }", "def \"a\" ( inherits = </a> ) { }"})
    EXPECT_NE(test::messageOf([&] { import(usda(cycle)); }).find("cycle"), std::string::npos) << cycle;
}

/// A zip archive of files as they are.
std::string zipped(const std::vector<std::pair<std::string, std::string>>& files, char method = 0) {
  std::string out, directory;
  const auto number = [](std::string& to, std::size_t value, int bytes) {
    for (int k = 0; k < bytes; ++k) to += static_cast<char>(value >> (8 * k) & 255);
  };
  for (const auto& [name, content] : files) {
    std::string common{20, 0, 0, 0, method, 0};
    common += std::string(8, '\0');  // time and checksum
    number(common, content.size(), 4), number(common, content.size(), 4), number(common, name.size(), 2);
    number(common, 0, 2);
    directory += "PK\1\2" + std::string(2, '\0') + common + std::string(10, '\0');
    number(directory, out.size(), 4);
    directory += name;
    out += "PK\3\4" + common + name + content;
  }
  const std::size_t begin = out.size();
  out += directory + "PK\5\6" + std::string(4, '\0');
  number(out, files.size(), 2), number(out, files.size(), 2);
  number(out, directory.size(), 4), number(out, begin, 4), number(out, 0, 2);
  return out;
}

TEST(Usd, PackagesAreReadAsFoldersAre) {
  const test::ModelFolder folder;
  const std::string part = usda(ball("part"), "defaultPrim = \"part\""),
                    whole = usda("def \"x\" ( references = @parts/part.usda@ ) { " + at("(1, 0, 0)") +
                                     " }\n" + "def \"y\" ( references = @../part.usda@ ) { }",
                                 "defaultPrim = \"x\" upAxis = \"Z\" metersPerUnit = 1");
  const std::string package = zipped({{"whole.usda", whole}, {"parts/part.usda", part}});
  for (const bool inMemory : {false, true}) {
    const Import model = inMemory ? convert::importContent(package, "model")
                                  : convert::importModel(folder.write("model.usdz", package));
    expectClose(bodyNamed(model, "x").position, {1, 0, 0});
    EXPECT_EQ(model.report.count(Effect::Lost), 1u);  // no file outside of the package
  }
  const std::string outer = folder.write("outer.usda", usda("def \"z\" ( references = @model.usdz@ ) { }"));
  expectClose(bodyNamed(convert::importModel(outer), "z").position, {1, 0, 0});
  const std::string bracketed = folder.write("a.usdz[1]/model.usdz", package);
  expectClose(bodyNamed(convert::importModel(bracketed), "x").position, {1, 0, 0});
  EXPECT_THROW(convert::importContent(zipped({{"whole.usda", whole}}, 8), "packed"), Error);
  for (std::size_t size = 4; size < package.size(); size += 7)
    EXPECT_THROW(convert::importContent(package.substr(0, size), "torn"), Error);
}

TEST(Usd, AnInstancerGivesABodyForEachInstance) {
  const Import model = import(
      usda("def PointInstancer \"grid\" {\n" + at("(0, 0, 10)") +
           "rel prototypes = [</grid/Prototypes/a>, </grid/Prototypes/b>] int[] protoIndices = [0, 1, 0]\n"
           "point3f[] positions = [(1, 0, 0), (2, 0, 0), (0, 3, 0)] float3[] scales = [(1, 1, 1), (2, 2, 2), "
           "(1, 1, "
           "1)]\nquath[] orientations = [(1, 0, 0, 0), (1, 0, 0, 0), (0, 0, 0, 1)]\n"
           "vector3f[] velocities = [(0, 0, 0), (0, 0, 0), (0, 0, 5)]\n"
           "def Scope \"Prototypes\" { " +
           ball("a", at("(0, 0, 1)")) + ball("b") + "} }"));
  EXPECT_EQ(model.file.scene.bodies.size(), 3u);
  expectClose(bodyNamed(model, "grid/a_0").position, {1, 0, 11});
  expectClose(bodyNamed(model, "grid/b_1").position, {2, 0, 10});
  EXPECT_NEAR(bodyNamed(model, "grid/b_1").shape.radius, 1, 1e-12);
  const BodyDef& last = bodyNamed(model, "grid/a_2");
  expectClose(last.position, {0, 3, 11}), expectClose(last.velocity, {0, 0, 5});
  EXPECT_NEAR(std::fabs(last.orientation.v.z), 1, 1e-12);
  EXPECT_THROW(
      import(usda("def PointInstancer \"g\" { rel prototypes = [</none>] int[] protoIndices = [0] }")),
      Error);
}

TEST(Usd, InstancersThatContainThemselvesAreErrorsAndDeepOnesToo) {
  const auto instancer = [](const std::string& name, const std::string& target,
                            const std::string& more = "") {
    return "def PointInstancer \"" + name + "\" { rel prototypes = <" + target +
           "> int[] protoIndices = [0, 0] " + more + " }\n";
  };
  const auto faultOf = [](const std::string& prims) { return test::messageOf([&] { import(usda(prims)); }); };
  EXPECT_NE(faultOf("def Xform \"W\" { " + instancer("I", "/W") + " }").find("cycle"), std::string::npos);
  EXPECT_NE(faultOf(instancer("A", "/B") + instancer("B", "/A")).find("cycle"), std::string::npos);
  // the other spelling of a path hides the cycle
  EXPECT_NE(faultOf("def Xform \"W\" { " + instancer("I", "/W/") + " }"), "");
  std::string chain;
  for (int k = 0; k < 3000; ++k) chain += instancer("i" + std::to_string(k), "/i" + std::to_string(k + 1));
  EXPECT_NE(faultOf(chain + ball("i3000")).find("levels"), std::string::npos);
}

TEST(Usd, InstancesKeepTheirMaterialsAndFilters) {
  const Import model = import(usda(
      "def PointInstancer \"grid\" {\nrel prototypes = </grid/hand> int[] protoIndices = [0, 0]\n"
      "point3f[] positions = [(0, 0, 0), (9, 0, 0)]\ndef Scope \"hand\" {\n"
      "def Material \"rubber\" ( prepend apiSchemas = [\"PhysicsMaterialAPI\"] ) { "
      "float physics:dynamicFriction = 0.75 }\n" +
      ball("palm", "rel material:binding = </grid/hand/rubber>") +
      ball("finger", at("(0, 0, 1)") + "rel physics:filteredPairs = [</grid/hand/palm>, </none>]") + "} }"));
  EXPECT_DOUBLE_EQ(bodyNamed(model, "grid/hand_1/palm").material.dynamicFriction, 0.75);
  EXPECT_EQ(model.file.scene.exclusions, (std::vector<std::pair<int, int>>{{0, 1}, {2, 3}}));
  EXPECT_EQ(test::effectsOf(model, "filter 'finger'"), (std::vector<Effect>(2, Effect::Lost)));
}

TEST(Usd, JointsOfInstancesJoinTheBodiesOfTheirOwnInstance) {
  const Import model = import(usda(
      "def PointInstancer \"grid\" {\nrel prototypes = </grid/hand> int[] protoIndices = [0, 0]\n"
      "point3f[] positions = [(0, 0, 0), (9, 0, 0)]\nquath[] orientations = [(1, 0, 0, 0), (0, 0, 0, 1)]\n"
      "def Scope \"hand\" {\n" +
      ball("palm") + ball("finger", at("(1, 0, 1)")) +
      "def PhysicsRevoluteJoint \"knuckle\" { rel physics:body0 = </grid/hand/palm> "
      "rel physics:body1 = </grid/hand/finger> point3f physics:localPos0 = (1, 0, 1) }\n"
      "def PhysicsFixedJoint \"stray\" { rel physics:body0 = </none> rel physics:body1 = </grid/hand/finger> "
      "}} }"));
  const auto& scene = model.file.scene;
  ASSERT_EQ(scene.joints.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    const std::string hand = "grid/hand_" + std::to_string(i);
    const JointDef& joint = jointNamed(model, hand + "/knuckle");
    const BodyDef &a = scene.bodies[static_cast<std::size_t>(joint.bodyA)],
                  &b = scene.bodies[static_cast<std::size_t>(joint.bodyB)];
    EXPECT_EQ(a.name, hand + "/finger");
    EXPECT_EQ(b.name, hand + "/palm");
    expectClose(a.position + rotate(a.orientation, joint.anchorA),
                b.position + rotate(b.orientation, joint.anchorB));
  }
  EXPECT_EQ(test::effectsOf(model, "PhysicsFixedJoint 'stray'"), (std::vector<Effect>(2, Effect::Lost)));
}

TEST(Usd, ResistanceAndWeightOfPhysxAreThoseOfTheBody) {
  const Import model = import(usda(ball("b",
                                        "bool physxRigidBody:disableGravity = 1 float "
                                        "physxRigidBody:linearDamping = 0.5 float "
                                        "physxRigidBody:angularDamping = 0.25")));
  const BodyDef& body = bodyNamed(model, "b");
  EXPECT_EQ(body.gravityScale, 0);
  EXPECT_EQ(body.linearDamping, 0.5);
  EXPECT_EQ(body.angularDamping, 0.25);
  EXPECT_TRUE(model.report.exact()) << convert::textOf(model.report, true);
}

TEST(Usd, ADistanceJointHangsFromAStaticColliderWhereItStands) {
  const std::string wall = "def Cube \"wall\" ( prepend apiSchemas = [\"PhysicsCollisionAPI\"] ) { " +
                           at("(0, 0, 5)") + "}\n";
  const auto pointsOf = [](const JointDef& joint) {
    std::vector<Vec3> out;
    const auto& path = std::any_cast<const TendonFields&>(joint.own).path;
    for (std::size_t i = 0; i + 3 < path.size(); i += 5)
      out.push_back({path[i + 1], path[i + 2], path[i + 3]});
    return out;
  };
  const std::string ends =
      "rel physics:body0 = </wall> rel physics:body1 = </b> "
      "point3f physics:localPos0 = (0, 0, -1) ";
  const Import model = import(
      usda(wall + ball("b", at("(0, 0, 2)")) + "def PhysicsDistanceJoint \"leash\" { " + ends +
           "float physics:maxDistance = 3 }\ndef PhysicsJoint \"guide\" ( prepend apiSchemas = "
           "[\"PhysicsLimitAPI:distance\"] ) { " +
           ends + "float limit:distance:physics:high = 3 float physics:breakForce = 70 }"));
  for (const char* name : {"leash", "guide/distance"}) {
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = pointsOf(jointNamed(model, name));
    ASSERT_EQ(points.size(), 2u);
    expectClose(points[0], {0, 0, 0}), expectClose(points[1], {0, 0, 4});
  }
  EXPECT_DOUBLE_EQ(jointNamed(model, "guide").breakForce, 70);
  EXPECT_DOUBLE_EQ(jointNamed(model, "guide/distance").breakForce, 70);
}

TEST(Usd, GroupsThatMergeKeepWhatEachOfThemIncludes) {
  const std::string first =
                        "def PhysicsCollisionGroup \"A\" { string physics:mergeGroup = \"g\" "
                        "rel collection:colliders:includes = [</a>, </b>] "
                        "rel physics:filteredGroups = </A> }\n",
                    second =
                        "def PhysicsCollisionGroup \"B\" { string physics:mergeGroup = \"g\" "
                        "rel collection:colliders:includes = [</a>, </c>] "
                        "rel collection:colliders:excludes = </a> }\n";
  for (const std::string& groups : {first + second, second + first})
    EXPECT_EQ(import(usda(ball("a") + ball("b") + ball("c") + groups)).file.scene.exclusions.size(), 3u);
}

TEST(Usd, GroupsFilterStaticShapesAndMayBeInverted) {
  const auto excluded = [](const std::string& settings) {
    const std::string wall = "def Cube \"wall\" ( prepend apiSchemas = [\"PhysicsCollisionAPI\"] ) { }\n";
    const Import model = import(
        usda(ball("a") + ball("b") + wall +
             "def PhysicsCollisionGroup \"A\" { rel collection:colliders:includes = </a> " + settings +
             " }\n" + "def PhysicsCollisionGroup \"W\" { rel collection:colliders:includes = </wall> }"));
    std::vector<std::string> out;
    for (const auto& [i, j] : model.file.scene.exclusions) {
      std::string x = model.file.scene.bodies[static_cast<std::size_t>(i)].name,
                  y = model.file.scene.bodies[static_cast<std::size_t>(j)].name;
      out.push_back(std::min(x, y) + " " + std::max(x, y));
    }
    std::sort(out.begin(), out.end());
    return out;
  };
  EXPECT_EQ(excluded("rel physics:filteredGroups = </W>"), (std::vector<std::string>{"a wall"}));
  EXPECT_EQ(excluded("rel physics:filteredGroups = </W> bool physics:invertFilteredGroups = 1"),
            (std::vector<std::string>{"a b"}));
}

TEST(Usd, ErrorsNameFileAndLine) {
  const std::string message = test::messageOf(
      [] { import(usda("\n" + ball("b", "\nfloat physics:density = -1"))); });
  EXPECT_NE(message.find("stage.usda:5: b.physics:density"), std::string::npos) << message;
  EXPECT_NE(test::messageOf([] { import(usda("def \"a\" { double x = ( }")); }).find("stage.usda:3"),
            std::string::npos);
  for (const char* wrong : {"#usda 1.0\ndef", "#usda 1.0\n(", "PXR-USDC", "#usda 1.0\ndef \"a\" {"})
    EXPECT_NE(test::messageOf([&] { import(wrong); }), "") << wrong;
}

TEST(Gltf, AGateHasItsBodiesJointAndFilters) {
  const Import model = convert::importModel(kFolder + "gate.gltf");
  const BodyDef& crate = bodyNamed(model, "crate");
  EXPECT_NEAR(*crate.mass, 5, 1e-12);
  expectClose(crate.position, {0, 0, 2});
  expectClose(crate.shape.halfExtents, {.5, .3, .35});
  expectClose(crate.angularVelocity, {0, 0, 2}, 1e-6);
  EXPECT_DOUBLE_EQ(crate.gravityScale, .5);
  const JointDef& hinge = jointNamed(model, "hinge");
  EXPECT_EQ(hinge.type, JointType::SixDof);
  EXPECT_EQ(hinge.bodyB, kWorld);
  expectClose(hinge.anchorB, {3.3, 0, 1});
  EXPECT_DOUBLE_EQ(hinge.axes[4].max, .5);
  EXPECT_DOUBLE_EQ(hinge.axes[4].driveStiffness, 3);
  EXPECT_EQ(model.file.scene.exclusions.size(), 1u);
  EXPECT_TRUE(model.report.exact()) << convert::textOf(model.report, true);
}

TEST(Gltf, RefusesWhatIsNotThere) {
  const std::string
      head = "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_physics_rigid_bodies\"],";
  for (const std::string& rest :
       {std::string("\"nodes\":[{\"children\":[0]}]}"), std::string("\"nodes\":[{\"children\":[7]}]}"),
        std::string("\"nodes\":[{\"scale\":[1,2]}]}"),
        std::string("\"nodes\":[{\"extensions\":{\"KHR_physics_rigid_bodies\":{\"collider\":"
                    "{\"geometry\":{\"shape\":0}}}}}]}")})
    EXPECT_NE(test::messageOf([&] { convert::importContent(head + rest, "a.gltf"); }), "") << rest;
}

}  // namespace
}  // namespace rubble
