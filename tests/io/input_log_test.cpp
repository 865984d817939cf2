/// A log of inputs replays to the same bits, and shows where something differs.
#include <gtest/gtest.h>

#include "io/input_log.h"
#include "tests/support/files.h"
#include "tests/support/scenes.h"

namespace rubble::io {
namespace {

Scene sceneOfAll() {
  Scene scene = test::heap(2);
  scene.bodies[3].name = "named";
  scene.deformables.emplace_back(clothSheet({5, 0, 1}, {1, 0, 0}, {0, 1, 0}, 2, 2));
  return scene;
}

/// Every call that changes a world, with steps between.
void changeInEveryWay(World& world) {
  const DeformableId cloth = world.deformableAt(0);
  const std::vector<BodyId> ids = world.bodies();
  const auto step = [&] { test::run(world, 2); };
  step();
  BodyDef pusher = test::body(Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), {-2, 1. / 3, 1});
  pusher.motion = Motion::Kinematic;
  const BodyId kinematic = world.addBody(pusher);
  world.setTarget(kinematic, {-1.9, .3, 1}, fromAxisAngle({0, 0, 1}, .1));
  step();
  const Snapshot snapshot = world.snapshot();
  world.removeBodies(std::vector<BodyId>{ids[5], ids[9]});
  world.setCollide(ids[1], ids[2], false);
  world.setState(ids[4], {{0, 0, 7}, normalize(Quat{1, {.1, .2, .3}}), {1, 0, 0}, {0, 1. / 7, 0}});
  world.applyForceAt(ids[6], {0, 0, 9}, {.1, 0, 0});
  world.applyImpulse(ids[7], {1, 2, 3});
  world.wake(ids[7]);
  world.setMass(ids[10], 1. / 3);
  world.setShape(ids[11],
                 Shape::compound({{Shape::sphere(.2), {.1, 0, 0}, {}}, {Shape::box({.1, .2, .1}), {}, {}}}));
  world.setMotion(ids[12], Motion::Kinematic);
  world.applyImpulseAt(ids[13], {1, 2, 3}, {0, 0, 1});
  Material ice = world.definition(ids[14]).material;
  ice.name = "ice", ice.oneWay = {0, 0, 1};
  world.setMaterial(ids[14], ice);
  world.setMaterialPair({"ice", "snow", 0.1, {}, 1. / 3});
  world.setMaterialPair({"ice", "ice", 0.1});
  world.removeMaterialPair("snow", "ice");
  Deformable stiffer = world.definition(cloth);
  std::get<ClothDef>(stiffer).youngsModulus = 1e6 / 3;
  world.setDefinition(cloth, stiffer);
  world.sortBodies();
  step();
  JointDef hinge = test::ball(0, {.5, 0, 0}, 0, {-.5, 0, 0});
  hinge.type = JointType::Hinge;
  hinge.frameA = normalize(Quat{1, {.2, 0, .1}});
  hinge.axes[0].min = -1. / 3;
  const JointId joint = world.addJoint(hinge, ids[6], ids[7]);
  const JointId drag = world.addDragJoint(ids[8], {0, 0, 1}, 50);
  step();
  world.setLimits(joint, 0, -.2, .7);
  BodyDef lighter = world.definition(kinematic), slick = world.definition(ids[6]);
  lighter.filter.layers = 6, slick.mass = 0.7, slick.material.dynamicFriction = 0.1;
  world.setDefinition(kinematic, lighter), world.setDefinition(ids[6], slick);
  world.setDragTarget(drag, {1, 1, 2});
  world.removeJoint(world.joints().front());
  const DeformableId cable = world.addDeformable(straightCable({6, 0, 2}, {7, 0, 2}, 4));
  AttachmentDef tie;
  tie.vertices = {0};
  const AttachmentId attachment = world.addAttachment(tie, cable, ids[8]);
  world.addAttachment(tie, cloth, {});
  world.applyVertexForce(cloth, 3, {0, 0, 1});
  step();
  world.removeAttachment(attachment);
  std::vector<Vec3> places = world.positions(cloth);
  for (Vec3& place : places) place.z += .1;
  world.setVertices(cloth, places, places);
  world.setGravity({0, .1, -9});
  Params params = world.params();
  params.iterations = 5;
  world.setParams(params);
  const std::int32_t row[] = {4};
  const float velocity[] = {.1f, .2f, .3f};
  world.scatter(StateArray::Velocity, packedArray(row, 1), packedArray(velocity, 1, 3));
  const std::int32_t axis[] = {0};
  world.scatter(JointArray::AppliedForce, packedArray(axis, 1), packedArray(velocity, 1));
  world.scatter(JointArray::TargetSpeed, packedArray(axis, 1), packedArray(velocity, 1));
  step();
  world.removeDeformable(cable);
  step();
  world.restore(snapshot);
  step();
}

/// The lines of a log of all of it.
std::vector<std::string> logged(const std::string& file, std::uint64_t& hash) {
  const Scene scene = sceneOfAll();
  const WorldOptions options = test::options(4);
  World world(scene, options);
  InputLog log(file, scene, options, world);
  changeInEveryWay(world);
  log.finish();
  hash = world.hash();
  world.step();  // is not logged any more
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

Replay replayOf(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  const test::TemporaryFile file(".inputs", text);
  return replayInputs(file.path);
}

TEST(InputLog, ReplaysEveryCallToTheSameBits) {
  const test::TemporaryFile file(".inputs");
  std::uint64_t hash = 0;
  std::set<std::string> calls;
  for (const std::string& line : logged(file.path, hash)) {
    const auto json = nlohmann::json::parse(line);
    if (json.contains("call")) calls.insert(json["call"]);
  }
  EXPECT_EQ(calls.size(), std::variant_size_v<inputs::Call>);
  const Replay replay = replayInputs(file.path);
  EXPECT_FALSE(replay.difference) << replay.difference->table << " after " << replay.difference->step;
  EXPECT_EQ(replay.steps, 16);
  EXPECT_EQ(replay.hash, hash);
}

TEST(InputLog, OfAReplayHasTheSameBytes) {
  const test::TemporaryFile file(".inputs"), again(".inputs");
  std::uint64_t hash = 0;
  logged(file.path, hash);
  EXPECT_EQ(replayInputs(file.path, {.threads = 3, .record = again.path}).hash, hash);
  EXPECT_TRUE(test::contentOf(again.path) == test::contentOf(file.path));
}

TEST(InputLog, ShowsTheFirstStepAndTableThatDiffer) {
  const test::TemporaryFile file(".inputs");
  std::uint64_t hash = 0;
  std::vector<std::string> lines = logged(file.path, hash);
  const auto replace = [&](const std::string& call, const std::string& from, const std::string& to) {
    std::vector<std::string> changed = lines;
    for (std::string& line : changed)
      if (line.find("\"" + call + "\"") != std::string::npos)
        if (const auto at = line.find(from); at != std::string::npos) {
          line.replace(at, from.size(), to);
          return changed;
        }
    ADD_FAILURE() << "no " << from << " in " << call;
    return changed;
  };
  // an impulse of the fifth step
  const Replay pushed = replayOf(replace("apply_impulses", "[1.0,2.0,3.0]", "[1.0,2.0,3.1]"));
  ASSERT_TRUE(pushed.difference);
  EXPECT_EQ(pushed.difference->step, 5);
  EXPECT_EQ(pushed.difference->table, "position");
  // a scene that is another from the start
  std::vector<std::string> heavier = lines;
  const auto at = heavier[0].find("\"radius\":0.3");
  ASSERT_NE(at, std::string::npos);
  heavier[0].replace(at, 12, "\"radius\":0.31");
  const Replay other = replayOf(heavier);
  ASSERT_TRUE(other.difference);
  EXPECT_EQ(other.difference->step, 0);
  EXPECT_EQ(other.difference->table, "authored params");
}

TEST(InputLog, ThatIsDamagedIsAnErrorWithItsLine) {
  const test::TemporaryFile file(".inputs");
  std::uint64_t hash = 0;
  const std::vector<std::string> lines = logged(file.path, hash);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    std::vector<std::string> damaged(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(k) + 1);
    damaged.back() = damaged.back().substr(0, damaged.back().size() / 2);
    try {
      replayOf(damaged);
      ADD_FAILURE() << k;
    } catch (const Error& error) {
      EXPECT_TRUE(error.path().ends_with("line " + std::to_string(k + 1))) << error.what();
    }
  }
  EXPECT_THROW(replayOf({"{\"format\":\"another\"}"}), Error);
  EXPECT_THROW(replayInputs("no such file"), Error);
}

/// What a replay of the head and this line says.
std::string faultOf(const std::vector<std::string>& lines, const std::string& line) {
  try {
    replayOf({lines.front(), line});
  } catch (const Error& error) {
    const std::size_t at = error.path().find(", line 2: ");
    EXPECT_NE(at, std::string::npos) << error.what();
    return error.path().substr(at + 10) + ": " + error.expected() + ", got " + error.found();
  }
  return "";
}

TEST(InputLog, WithACallThatCannotBeIsAnErrorWithItsLineAndItsValue) {
  const test::TemporaryFile file(".inputs");
  std::uint64_t hash = 0;
  const std::vector<std::string> lines = logged(file.path, hash);
  const auto fault = [&](const std::string& line) { return faultOf(lines, line); };
  // whole numbers that are none, or too large
  EXPECT_EQ(fault(R"({"call":"wake","id":[1e30,0]})"), "id: a whole number of 32 bits, got 1e+30");
  EXPECT_EQ(fault(R"({"call":"wake","id":[0.5,0]})"), "id: a whole number of 32 bits, got 0.5");
  EXPECT_EQ(fault(R"({"call":"wake","id":[3000000000,0]})"), "id: a whole number of 32 bits, got 3000000000");
  EXPECT_EQ(fault(R"({"call":"wake","id":[1,-1]})"), "id: a whole number of 32 bits, got -1");
  EXPECT_EQ(fault(R"({"call":"restore","snapshot":0})"), "snapshot: one of the 0 that were taken, got 0");
  // lists that are too short or too long
  EXPECT_EQ(fault(R"({"call":"wake","id":[1,0,0]})"), "id: a list of 2, got array");
  EXPECT_EQ(fault(R"({"call":"add_joint","joint":{"type":"hinge"},"bodies":[[1,0]]})"),
            "bodies: a list of 4, got array");
  EXPECT_EQ(fault(R"({"call":"set_gravity","gravity":[0,0]})"), "vector: a list of 3, got array");
  EXPECT_EQ(fault(R"({"call":"scatter","array":2,"rows":[1],"values":[1,2,3,4]})"),
            "values: 3 numbers per row, got 4");
  // what the world refuses
  EXPECT_EQ(fault(R"({"call":"wake","id":[1000,0]})").substr(0, 5), "body:");
  EXPECT_EQ(fault(R"({"call":"dance"})"), "call: one of the calls of inputs.h, got \"dance\"");
  // what reads a line calls itself for each level
  const std::size_t deep = 1000000;
  EXPECT_NE(fault(R"({"call":"add_bodies","bodies":)" + std::string(deep, '[') + std::string(deep, ']') + "}")
                .find("lists and objects within one another"),
            std::string::npos);
}

TEST(InputLog, TakesNamesThatAreNoUnicode) {
  const test::TemporaryFile file(".inputs");
  const Scene scene = test::tower(1);
  World world(scene, test::options(1));
  InputLog log(file.path, scene, test::options(1), world);
  world.setMaterialPair({"\xe9tain", "ice", 0.1});
  world.step();
  log.finish();
  EXPECT_FALSE(replayInputs(file.path).difference);
}

TEST(InputLog, HasNoForceThatItsReplayRefuses) {
  const test::TemporaryFile file(".inputs");
  const Scene scene = test::tower(1);
  World world(scene, test::options(1));
  InputLog log(file.path, scene, test::options(1), world);
  EXPECT_THROW(world.applyForceAt(world.bodyAt(1), {0, 1e17, 0}, {1e3, 0, 0}), Error);
  world.applyForceAt(world.bodyAt(1), {0, 1e15, 0}, {1e2, 0, 0});
  world.step();
  log.finish();
  EXPECT_FALSE(replayInputs(file.path).difference);
}

TEST(InputLog, ThatIsNotFinishedLeavesNoFile) {
  const test::TemporaryFolder folder;
  const Scene scene = test::tower(1);
  World world(scene, test::options());
  { const InputLog log((folder.path / "log").string(), scene, test::options(), world); }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
  EXPECT_NO_THROW(world.step());
}

}  // namespace
}  // namespace rubble::io
