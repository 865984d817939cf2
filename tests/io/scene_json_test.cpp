#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "io/scene_json.h"

namespace rubble::io {
namespace {

std::vector<Fault> faultsOf(const std::string& text) {
  std::vector<Fault> faults;
  parseScene(text, faults);
  return faults;
}

/// A scene of one body with these keys beside its shape.
std::string withBody(const std::string& keys) {
  return R"({"bodies": [{"shape": {"type": "sphere", "radius": 1}, )" + keys + "}]}";
}
std::string withShape(const std::string& shape) { return R"({"bodies": [{"shape": )" + shape + "}]}"; }
/// A scene with one deformable object of two vertices.
std::string withSoft(const std::string& keys, const std::string& more = "") {
  return R"({"bodies": [], "deformables": [{"name": "line", "vertices": [[0, 0, 0], [1, 0, 0]], )" + keys +
         "}]" + more + "}";
}
/// A scene with the bodies "a" and "b" and these further keys.
std::string withTwo(const std::string& keys) {
  return R"({"bodies": [{"name": "a", "shape": {"type": "sphere", "radius": 1}},
                        {"name": "b", "shape": {"type": "sphere", "radius": 1}, "position": [3, 0, 0]}], )" +
         keys + "}";
}
std::string withJoint(const std::string& keys) {
  return withTwo(R"("joints": [{"type": "ball", )" + keys + "}]");
}

std::string manyLights(int count) {
  std::string list;
  for (int i = 0; i < count; ++i) list += std::string(i > 0 ? ", " : "") + R"({"position": [0, 0, 1]})";
  return list;
}

struct BadFile {
  std::string text;
  std::string path;     ///< of the first fault
  std::string message;  ///< a part of it
};

const std::vector<BadFile>& badFiles() {
  static const std::vector<BadFile> files{
      {"[]", "", "a scene"},
      {"{}", "", "\"bodies\""},
      {R"({"bodies": 3})", "bodies", "a list of bodies, got 3"},
      {R"({"bodies": [], "gravty": [0, 0, 0]})", "gravty", "did you mean \"gravity\"?"},
      {R"({"bodies": [], "gravity": [0, 0]})", "gravity", "a list of 3 numbers, got a list of 2"},
      {R"({"bodies": [], "gravity": [0, "x", 0]})", "gravity[1]", "a number, got \"x\""},
      {R"({"bodies": [], "steps": 0})", "steps", "a whole number above 0"},
      {R"({"bodies": [], "steps": 1.5})", "steps", "got 1.5"},
      {R"({"bodies": [], "dt": -1})", "dt", "a time above 0 [s]"},
      {R"({"bodies": [], "name": 3})", "name", "a text"},
      {R"({"bodies": [], "steps": 3, "steps": 4})", "steps", "each key once"},
      {R"({"bodies": [{"shape": {"type": "plane"}, "name": "x", "name": "y"}]})", "bodies[0].name",
       "each key once"},
      {R"({"bodies": [3]})", "bodies[0]", "a body, got 3"},
      {R"({"bodies": [{}]})", "bodies[0]", "\"shape\""},
      {withSoft(R"("radius": 1)"), "deformables[0]", "\"type\""},
      {withSoft(R"("type": "cables")"), "deformables[0].type", "did you mean \"cable\"?"},
      {withSoft(R"("type": "cable", "radios": 1)"), "deformables[0].radios", "did you mean \"radius\"?"},
      {withSoft(R"("type": "cable", "tetrahedra": [])"), "deformables[0].tetrahedra", "unknown key"},
      {withSoft(R"("type": "cable", "fixed": [0.5])"), "deformables[0].fixed[0]", "the index of a vertex"},
      {withSoft(R"("type": "cable", "radius": -1)"), "", "deformables[0].radius"},
      {withSoft(R"("type": "net", "edges": [[0, 1]])"), "deformables[0].edges[0]", "stiffness"},
      {withSoft(R"("type": "cable")", R"(, "attachments": [{"object": "lime", "vertices": [0]}])"),
       "attachments[0].object", "did you mean \"line\"?"},
      {withSoft(R"("type": "cable")", R"(, "attachments": [{"object": 1, "vertices": [0]}])"),
       "attachments[0].object", "one of 1"},
      {withShape("7"), "bodies[0].shape", "a shape"},
      {withShape("{}"), "bodies[0].shape", "\"type\""},
      {withShape(R"({"type": "bix"})"), "bodies[0].shape.type", "did you mean \"box\"?"},
      {withShape(R"({"type": "box"})"), "bodies[0].shape", "\"size\""},
      {withShape(R"({"type": "box", "size": [1, 0, 1]})"), "bodies[0].shape.size[1]",
       "a length above 0 [m], got 0"},
      {withShape(R"({"type": "box", "size": [1, 1, 1], "radius": 2})"), "bodies[0].shape.radius",
       "unknown key"},
      {withShape(R"({"type": "sphere", "radius": -1})"), "bodies[0].shape.radius",
       "a length above 0 [m], got -1"},
      {withShape(R"({"type": "capsule", "radius": 1})"), "bodies[0].shape", "\"length\""},
      {withBody(R"("mass": 0)"), "bodies[0].mass", "a mass above 0 [kg], got 0"},
      {withBody(R"("mass": "heavy")"), "bodies[0].mass", "got \"heavy\""},
      {withBody(R"("mass": 1, "density": 1)"), "bodies[0].mass", "got both"},
      {withBody(R"("density": null)"), "bodies[0].density", "got null"},
      {withBody(R"("motion": "frozen")"), "bodies[0].motion", "one of \"static\""},
      {withBody(R"("material": "ice")"), "bodies[0].material", "a name in \"materials\""},
      {withBody(R"("material": {"friction": -1})"), "bodies[0].material.friction", "at least 0"},
      {withBody(R"("material": {"static_friction": 0.2, "dynamic_friction": 0.3})"), "bodies[0].material",
       "at most static_friction"},
      {withBody(R"("material": {"friction": 1, "static_friction": 1})"), "bodies[0].material.friction",
       "got both"},
      {withBody(R"("material": {"restitution": 2})"), "bodies[0].material.restitution", "from 0 to 1"},
      {withBody(R"("orientation": [1, 0, 0])"), "bodies[0].orientation", "a unit quaternion"},
      {withBody(R"("orientation": [1, 1, 0, 0])"), "bodies[0].orientation", "got a length of 1.41"},
      {withBody(R"("orientation": {"axis": [0, 0, 0], "degrees": 3})"), "bodies[0].orientation.axis",
       "an axis of some length"},
      {withBody(R"("orientation": {"degrees": 3})"), "bodies[0].orientation", "\"axis\""},
      {withBody(R"("velocity": [1, 2, 1e999])"), "", ""},
      {withBody(R"("name": "world")"), "bodies[0].name", "fixed world"},
      {withBody(R"("name": "x*")"), "bodies[0].name", "final '*'"},
      {withBody(R"("positon": [0, 0, 0])"), "bodies[0].positon", "did you mean \"position\"?"},
      {R"({"bodies": [{"shape": {"type": "plane"}, "motion": "dynamic"}]})", "bodies[0]",
       "\"static\" for a plane"},
      {R"({"bodies": [{"name": "a", "shape": {"type": "plane"}}, {"name": "a",
        "shape": {"type": "plane"}}]})",
       "bodies[1].name", "again"},
      {R"({"materials": {"ice": {"frction": 0}}, "bodies": []})", "materials.ice.frction",
       "did you mean \"friction\"?"},
      {withJoint(R"("body_a": "a", "body_b": "c", "anchor": [1, 0, 0])"), "joints[0].body_b",
       "the name or index of a body"},
      {withJoint(R"("body_a": "a", "body_b": 2, "anchor": [1, 0, 0])"), "joints[0].body_b",
       "one of 2 bodies, got 2"},
      {withJoint(R"("body_a": "a", "body_b": "a", "anchor": [1, 0, 0])"), "joints[0]",
       "two different bodies"},
      {withJoint(R"("body_a": "a", "anchor": [1, 0, 0])"), "joints[0]", "\"body_b\""},
      {withJoint(R"("body_a": "a", "body_b": "b")"), "joints[0]", "\"anchor\""},
      {withJoint(R"("body_a": "a", "body_b": "b", "anchor": [0, 0, 0], "anchor_a": [0, 0, 0])"),
       "joints[0].anchor", "got both"},
      {withJoint(R"("body_a": "a", "body_b": "b", "anchor": [0, 0, 0], "stiffness": "soft")"),
       "joints[0].stiffness", "\"hard\""},
      {withJoint(R"("body_a": "a", "body_b": "b", "anchor": [0, 0, 0], "break_force": 0)"),
       "joints[0].break_force", "\"never\""},
      {withJoint(R"("body_a": "a", "body_b": "b", "anchor": [0, 0, 0], "collide": 1)"), "joints[0].collide",
       "true or false"},
      {withTwo(R"("events": [{"remove": ["a"]}])"), "events[0]", "\"step\""},
      {withTwo(R"("events": [{"step": -1}])"), "events[0].step", "at least 0"},
      {withTwo(R"("events": [{"step": 1, "remove": ["c"]}])"), "events[0].remove[0]", "the name of a body"},
      {withTwo(R"("events": [{"step": 1, "remove": ["brick*"]}])"), "events[0].remove[0]", "got \"brick*\""},
      {withTwo(R"("events": [{"step": 1, "remove_joints": ["j"]}])"), "events[0].remove_joints[0]",
       "the name of a joint"},
      {withTwo(R"("events": [{"step": 1, "set_velocity": [{"body": "c"}]}])"),
       "events[0].set_velocity[0].body", "the name of a body"},
      {withTwo(R"("events": [{"step": 1, "add": [{"shape": {"type": "sphere", "radius": 0}}]}])"),
       "events[0].add[0].shape.radius", "above 0"},
      {withTwo(R"("verdict": [{"metric": "x"}])"), "verdict[0]", "\"min\", \"max\" or both"},
      {withTwo(R"("verdict": [{"metric": "x", "min": 2, "max": 1}])"), "verdict[0]", "min of at most max"},
      {withTwo(R"("camera": {"eye": [1, 1, 1], "target": [1, 1, 1]})"), "camera", "away from the target"},
      {withTwo(R"("camera": {"eye": [1, 1, 1]})"), "camera", "\"target\""},
      {withTwo(R"("sun": [0, 0, 0])"), "sun", "a direction of some length"},
      {withTwo(R"("sun": {"direction": [0, 0, 0]})"), "sun.direction", "a direction of some length"},
      {withTwo(R"("sun": {"color": [1, 2, 0]})"), "sun.color[1]", "from 0 to 1, got 2"},
      {withTwo(R"("sun": {"strength": -1})"), "sun.strength", "a number of at least 0, got -1"},
      {withTwo(R"("sun": {"strenth": 1})"), "sun.strenth", "did you mean \"strength\"?"},
      {withTwo(R"("sky": -1)"), "sky", "a number of at least 0, got -1"},
      {withTwo(R"("lights": [{"intensity": 1}])"), "lights[0]", "\"position\""},
      {withTwo(R"("lights": [{"position": [0, 0, 1], "intensity": 0}])"), "lights[0].intensity",
       "an intensity above 0 [m2], got 0"},
      {withTwo(R"("lights": [)" + manyLights(17) + "]"), "lights[16]", "at most 16 lights"},
  };
  return files;
}

TEST(SceneJson, EveryBadFileSaysWhereAndWhat) {
  for (const BadFile& bad : badFiles()) {
    const std::vector<Fault> faults = faultsOf(bad.text);
    ASSERT_FALSE(faults.empty()) << bad.text;
    EXPECT_EQ(faults.front().path, bad.path) << bad.text << "\n" << faults.front().text();
    EXPECT_NE(faults.front().message.find(bad.message), std::string::npos) << bad.text << "\n"
                                                                           << faults.front().text();
  }
}

TEST(SceneJson, AllFaultsAreCollected) {
  const std::vector<Fault> faults = faultsOf(
      R"({"bodies": [{"shape": {"type": "box", "size": [1, -1, 0]}, "mass": -2, "tint": 1}], "speed": 3})");
  std::vector<std::string> paths;
  for (const Fault& fault : faults) paths.push_back(fault.path);
  EXPECT_EQ(paths, (std::vector<std::string>{"bodies[0].shape.size[1]", "bodies[0].shape.size[2]",
                                             "bodies[0].mass", "bodies[0].tint", "speed"}));
}

TEST(SceneJson, SyntaxFaultsHaveLineAndColumn) {
  const std::vector<Fault> faults = faultsOf("{\n  \"bodies\": [\n    {\"mass\": }\n  ]\n}\n");
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].line, 3);
  EXPECT_EQ(faults[0].column, 14);
  EXPECT_EQ(faults[0].text().rfind("line 3, column 14: ", 0), 0u);
}

TEST(SceneJson, TextThatIsCutOffAnywhereIsAFault) {
  std::ifstream in(std::string(RUBBLE_SOURCE_DIR) + "/scenes/files/pendulum.json");
  std::ostringstream text;
  text << in.rdbuf();
  const std::string whole = text.str().substr(0, text.str().rfind('}') + 1);
  ASSERT_TRUE(faultsOf(whole).empty());
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(faultsOf(whole.substr(0, size)).empty()) << size;
}

TEST(SceneJson, DeepNestingIsAFaultAndNoCrash) {
  EXPECT_FALSE(faultsOf(std::string(200000, '[')).empty());
  EXPECT_FALSE(faultsOf(R"({"bodies": )" + std::string(50000, '[') + std::string(50000, ']') + "}").empty());
}

TEST(SceneJson, AuthorsShorthands) {
  std::vector<Fault> faults;
  const SceneFile file = parseScene(R"({
    "materials": {"ice": {"static_friction": 0.05}},
    "bodies": [
      {"name": "ground", "shape": {"type": "plane"}},
      {"name": "a", "shape": {"type": "box", "size": [1, 2, 3]}, "material": "ice", "position": [0, 0, 1]},
      {"name": "b", "shape": {"type": "capsule", "radius": 0.1, "length": 2}, "position": [2, 0, 1],
       "orientation": {"axis": [0, 0, 2], "degrees": 90}}
    ],
    "joints": [{"type": "fixed", "body_a": "a", "body_b": 2, "anchor": [1, 0, 1]}]})",
                                    faults);
  ASSERT_TRUE(faults.empty()) << faults.front().text();
  const Scene& scene = file.scene;
  EXPECT_EQ(scene.bodies[0].motion, Motion::Static);
  EXPECT_EQ(scene.bodies[1].shape.halfExtents, (Vec3{.5, 1, 1.5}));
  EXPECT_EQ(scene.bodies[1].material.dynamicFriction, .05);
  EXPECT_EQ(scene.bodies[2].shape.halfLength, 1);
  const JointDef& joint = scene.joints[0];
  EXPECT_EQ(joint.stiffness, kHard);
  EXPECT_NEAR(length(joint.anchorA - Vec3{1, 0, 0}), 0, 1e-15);
  EXPECT_NEAR(length(joint.anchorB - Vec3{0, 1, 0}), 0, 1e-15);
  // Wanted: q_B^-1 q_A, a quarter turn back about z.
  EXPECT_NEAR(joint.orientationAtoB.s, std::sqrt(.5), 1e-15);
  EXPECT_NEAR(joint.orientationAtoB.v.z, -std::sqrt(.5), 1e-15);
}

/// Hinges "shaft" of a on b and "arm" of b on the world, a slider "guide" of c on b, and this joint.
std::string withMachine(const std::string& joint) {
  return R"({"bodies": [{"name": "a", "shape": {"type": "sphere", "radius": 1}}, {"name": "b",
    "shape": {"type": "sphere", "radius": 1}, "position": [3, 0, 0]},
                        {"name": "c", "shape": {"type": "sphere", "radius": 1}, "position": [0, 3, 0]}],
             "joints": [{"name": "shaft", "type": "hinge", "body_a": "a", "body_b": "b",
               "anchor": [0, 0, 0], "axis": [0, 0, 1]},
                        {"name": "arm", "type": "hinge", "body_a": "b", "body_b": "world",
                          "anchor": [0, 0, 0], "axis": [0, 0, 1]},
                        {"name": "guide", "type": "slider", "body_a": "c", "body_b": "b",
                          "anchor": [0, 3, 0], "axis": [0, 1, 0]},)" +
         joint + "]}";
}

TEST(SceneJson, AGearIsOfTwoHingesAndARackOfAHingeAndASlider) {
  std::vector<Fault> faults;
  const SceneFile gears = parseScene(
      withMachine(
          R"({"name": "mesh", "type": "gear", "joint_a": "shaft", "joint_b": "arm", "ratio": 3,
            "break_torque": 5})"),
      faults);
  ASSERT_TRUE(faults.empty()) << faults[0].message;
  const JointDef& gear = gears.scene.joints[3];
  EXPECT_EQ(gear.name, "mesh");
  EXPECT_EQ(gear.bodyA, 0);
  EXPECT_EQ(gear.frameBodyA, 1);
  EXPECT_EQ(gear.bodyB, 1);
  EXPECT_EQ(gear.frameBodyB, kWorld);
  EXPECT_EQ(gear.ratio, 3);
  EXPECT_EQ(gear.breakTorque, 5);
  const SceneFile racks = parseScene(
      withMachine(R"({"type": "rack", "joint_a": "shaft", "joint_b": "guide", "ratio": 0.2})"), faults);
  ASSERT_TRUE(faults.empty()) << faults[0].message;
  EXPECT_EQ(racks.scene.joints[3].bodyB, 2);
  EXPECT_EQ(racks.scene.joints[3].frameBodyB, 1);
  EXPECT_LT(length(rotate(racks.scene.joints[3].frameB, Vec3{1, 0, 0}) - Vec3{0, 1, 0}), 1e-12);
  EXPECT_NO_THROW(validate(racks.scene));

  const auto fault = [](const std::string& joint) {
    const std::vector<Fault> all = faultsOf(withMachine(joint));
    return all.empty() ? "" : all[0].path + ": " + all[0].message;
  };
  EXPECT_NE(fault(R"({"type": "gear", "joint_a": "shaft", "joint_b": "guide"})")
                .find("joints[3].joint_b: expected the name of a hinge further up"),
            std::string::npos);
  EXPECT_NE(fault(R"({"type": "gear", "joint_a": "shaft"})").find("\"joint_b\""), std::string::npos);
  EXPECT_NE(
      fault(R"({"type": "ball", "joint_a": "shaft", "joint_b": "arm"})").find("only for a gear or a rack"),
      std::string::npos);
  EXPECT_NE(fault(R"({"type": "gear", "joint_a": "shaft", "joint_b": "arm", "body_a": "a"})").find("body_a"),
            std::string::npos);
}

TEST(SceneJson, ReadSceneNamesTheFile) {
  try {
    readScene("/nowhere/at/all.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/at/all.json"), std::string::npos);
  }
}

TEST(SceneDepth, OfListsObjectsAndCompoundsIsBounded) {
  std::string lists, objects, compounds = R"({"bodies": [{"shape": )";
  for (int i = 0; i < 200000; ++i) {
    lists += "[";
    objects += R"({"name": )";
    compounds += R"({"type": "compound", "parts": [{"shape": )";
  }
  for (const std::string& text : {lists, objects, compounds, R"({"bodies": )" + lists}) {
    const std::vector<Fault> faults = faultsOf(text);
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_NE(faults[0].message.find("expected at most 64 lists and objects within one another"),
              std::string::npos)
        << faults[0].text();
  }
  EXPECT_EQ(faultsOf(compounds)[0].path.rfind("bodies[0].shape.parts[0].shape.parts[0].shape", 0), 0u);
}

TEST(SceneDepth, OfWhatIsWellFormedIsBoundedToo) {
  const auto nested = [](int levels) {
    std::string text = R"({"type": "sphere", "radius": 1})";
    for (int i = 0; i < levels; ++i) text = R"({"type": "compound", "parts": [{"shape": )" + text + "}]}";
    return R"({"bodies": [{"shape": )" + text + "}]}";
  };
  EXPECT_TRUE(faultsOf(nested(1)).empty());
  EXPECT_NE(faultsOf(nested(2))[0].message.find(
                "bodies[0].shape.parts[0].shape: expected a convex solid, got a compound"),
            std::string::npos);
  EXPECT_NE(faultsOf(nested(2000))[0].message.find("within one another"), std::string::npos);
}

TEST(SceneJson, LightsComeBack) {
  SceneFile file;
  file.appearance.daylight = {Vec3{0, 0.6, 0.8}, {1, 0.5, 0.25}, 0, 0.1};
  file.appearance.lights = {{{1, 2, 3}, {0.25, 1, 0}, 20}, {{0, 0, 4}, {1, 1, 1}, 0.5}};
  std::vector<Fault> faults;
  const SceneFile back = parseScene(toJson(file), faults);
  EXPECT_TRUE(faults.empty());
  const Daylight& day = back.appearance.daylight;
  EXPECT_EQ(day.toSun, (Vec3{0, 0.6, 0.8}));
  EXPECT_EQ(day.sunColor, (Vec3{1, 0.5, 0.25}));
  EXPECT_EQ(day.sunStrength, 0);
  EXPECT_EQ(day.skyStrength, 0.1);
  const std::vector<PointLight>& lights = back.appearance.lights;
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[0].position, (Vec3{1, 2, 3}));
  EXPECT_EQ(lights[0].color, (Vec3{0.25, 1, 0}));
  EXPECT_EQ(lights[0].intensity, 20);
  EXPECT_EQ(lights[1].intensity, 0.5);
  // a scene without lights of its own says nothing of them
  const std::string usual = toJson(SceneFile{});
  for (const char* key : {"\"sun\"", "\"sky\"", "\"lights\""})
    EXPECT_EQ(usual.find(key), std::string::npos) << key;
}

}  // namespace
}  // namespace rubble::io
