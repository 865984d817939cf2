/// Authored values and random numbers of worlds.
#include <numeric>

#include <gtest/gtest.h>
#include <rubble/actuators.h>
#include <rubble/worlds.h>

#include "tests/support/worlds_claims.h"

namespace rubble {
namespace {

using test::body;
using test::worldsOptions;

/// A pole on a hinge to the world with a motor, a crate, a hanging cable, and materials with a rule.
Scene variedScene() {
  Scene scene = test::emptyScene({0, 0, -10});
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(body(Shape::capsule(0.1, 0.5), {0, 0, 2}));
  scene.bodies.push_back(body(Shape::box({0.5, 0.5, 0.5}), {3, 0, 0.5}));
  scene.bodies[0].name = "ground", scene.bodies[1].name = "pole", scene.bodies[2].name = "left.crate";
  scene.bodies[2].material.name = scene.bodies[0].material.name = "wood";
  scene.materialPairs.push_back({"wood", "wood", 0.9, 0.8});
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 1, kWorld, {0, 0, 2.5}));
  scene.joints[0].name = "hip";
  scene.joints[0].axes[0].driveStiffness = 2;
  scene.deformables.emplace_back(straightCable({6, 0, 3}, {7, 0, 3}, 4));
  common(scene.deformables[0]).name = "rope";
  AttachmentDef& hook = scene.attachments.emplace_back();
  hook.name = "hook", hook.vertices = {0};
  return scene;
}

std::vector<int> allOf(const Worlds& worlds) {
  std::vector<int> numbers(static_cast<std::size_t>(worlds.count()));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

void expectPath(const std::string& path, const std::function<void()>& call) {
  try {
    call();
    FAIL() << "no error at " << path;
  } catch (const Error& error) {
    EXPECT_EQ(error.path(), path) << error.what();
  }
}

/// Path, numbers of a value, and one that is allowed.
struct Authored {
  const char* path;
  std::vector<double> value;
};
const std::vector<Authored>& authoredValues() {
  static const std::vector<Authored> all{
      {"gravity", {0, 1, -9}},
      {"bodies.pole.mass", {3.5}},
      {"bodies[2].density", {700}},
      {"bodies[\"left.crate\"].linear_damping", {0.25}},
      {"bodies.pole.gravity_scale", {-0.5}},
      {"bodies[\"left.crate\"].material.friction", {0.375}},
      {"bodies[\"left.crate\"].material.rolling_friction", {0.125}},
      {"bodies[\"left.crate\"].shape.size", {1.5, 1, 0.75}},
      {"bodies[\"left.crate\"].position", {4, 0, 2}},
      {"bodies[\"left.crate\"].velocity", {0, 1, 0}},
      {"joints.hip.axes.0.drive_stiffness", {40}},
      {"joints[0].axes[0].max", {1.25}},
      {"joints.hip.break_force", {kHard}},
      {"deformables.rope.youngs_modulus", {2e6}},
      {"deformables.rope.material.friction", {0.25}},
      {"attachments.hook.stiffness", {500}},
      {"attachments.hook.anchor", {6, 0, 3.25}},
      {"materials.wood.restitution", {0.5}},
      {"material_pairs.wood.wood.friction", {0.375}},
      {"actuators.motor.gain", {2, 0, 0.5}},
      {"actuators[0].max_force", {12}},
  };
  return all;
}
std::vector<ActuatorDef> motor() {
  ActuatorDef def;
  def.name = "motor", def.joint = 0;
  return {def};
}

TEST(Values, OfEveryKindAreSetReadAndBroughtBackByAReset) {
  for (const char* backend : {"cpu", "reference"})
    for (const auto& [path, value] : authoredValues()) {
      Worlds worlds(worldsOptions(backend));
      worlds.addCopies(variedScene(), 3);
      Actuators actuators(motor(), worlds);
      worlds.step(2);
      const Snapshot start = worlds[0].snapshot();
      const std::vector<int> one{1}, others{0, 2};
      const std::vector<double> before = worlds.values(path, others);
      worlds.setValues(path, one, value);
      const std::vector<double> now = worlds.values(path, one);
      ASSERT_EQ(now.size(), value.size()) << path;
      for (std::size_t k = 0; k < now.size(); ++k)
        EXPECT_TRUE(now[k] == value[k] || std::fabs(now[k] - value[k]) < 1e-6) << path << ": " << now[k];
      EXPECT_EQ(worlds.values(path, others), before) << path;
      EXPECT_EQ(actuators.worlds(), 3);
      worlds.step(5);
      worlds.reset(allOf(worlds), {&start, 1});
      EXPECT_TRUE(test::stateOf(worlds[0]) == test::stateOf(worlds[1])) << backend << " " << path;
      worlds.step(20);
      EXPECT_TRUE(test::stateOf(worlds[0]) == test::stateOf(worlds[1])) << backend << " " << path;
      EXPECT_EQ(worlds.values(path, one), worlds.values(path, {others.data(), 1})) << path;
    }
}

/// A world of a batch with a changed value has the bits of a world that is authored so.
TEST(Values, GiveTheBitsOfASceneThatHasThem) {
  Scene wanted = variedScene();
  wanted.bodies[1].mass = 7, wanted.bodies[2].position = {3, 0, 2},
  wanted.joints[0].axes[0].driveStiffness = 30;
  wanted.joints[0].axes[0].driveDamping = 1;
  std::get<CableDef>(wanted.deformables[0]).density = 400;
  Worlds worlds(worldsOptions("cpu", 2));
  worlds.addCopies(variedScene(), 40);
  const std::vector<int> some{35, 3};
  worlds.setValues("bodies.pole.mass", some, std::vector<double>{7, 8});
  worlds.setValues("bodies[\"left.crate\"].position", some, std::vector<double>{3, 0, 2, 3, 0, 4});
  worlds.setValues("joints.hip.axes.0.drive_stiffness", some, std::vector<double>{30, 40});
  worlds.setValues("joints.hip.axes[0].drive_damping", some, std::vector<double>{1, 2});
  worlds.setValues("deformables.rope.density", some, std::vector<double>{400, 300});
  worlds.step(60);
  World alone(wanted, worldsOptions());
  test::run(alone, 60);
  EXPECT_EQ(test::stateOf(worlds[35]), test::stateOf(alone));
  EXPECT_NE(test::stateOf(worlds[3]), test::stateOf(alone));
}

TEST(Values, OfAMaterialAreThoseOfAllBodiesOfItsName) {
  Worlds worlds(worldsOptions());
  worlds.addCopies(variedScene(), 2);
  worlds.setValues("materials.wood.friction", std::vector<int>{1}, std::vector<double>{0.25});
  for (const int index : {0, 2}) {
    EXPECT_EQ(worlds[1].definition(worlds[1].bodyAt(index)).material.dynamicFriction, 0.25);
    EXPECT_EQ(worlds[0].definition(worlds[0].bodyAt(index)).material.dynamicFriction, 0.6);
  }
}

TEST(Values, AnAttachmentFollowsItsStiffnessAndAnchor) {
  Worlds worlds(worldsOptions());
  worlds.addCopies(variedScene(), 2);
  worlds.step(1);
  worlds.setValues("attachments.hook.anchor", std::vector<int>{1}, std::vector<double>{6, 0, 3.5});
  worlds.step(300);
  const auto top = [&](int w) { return worlds[w].positions(worlds[w].findDeformable("rope"))[0]; };
  EXPECT_NEAR(top(0).z, 3, 0.01);
  EXPECT_NEAR(top(1).z, 3.5, 0.01);
}

TEST(Values, ActuatorsOfAWorldHaveItsOwn) {
  Worlds worlds(worldsOptions());
  worlds.addCopies(variedScene(), 2);
  Actuators actuators(motor(), worlds);
  worlds.setValues("actuators.motor.gain", std::vector<int>{1}, std::vector<double>{5, 0, 0});
  std::ranges::fill(actuators.controls(), 1);
  actuators.apply(worlds);
  EXPECT_EQ(actuators.forces()[0], 1);
  EXPECT_EQ(actuators.forces()[1], 5);
}

TEST(Values, AnErrorNamesTheWorldAndChangesNothing) {
  Worlds worlds(worldsOptions("cpu", 2));
  worlds.addCopies(variedScene(), 70);
  const std::vector<int> all = allOf(worlds);
  const std::vector<std::uint64_t> before{worlds[0].hash(), worlds[69].hash()};
  std::vector<double> values(70, 2);
  values[68] = -1, values[69] = -2;
  expectPath("worlds[68].body.mass", [&] { worlds.setValues("bodies.pole.mass", all, values); });
  expectPath("worlds[68].joint.axes[0].driveStiffness",
             [&] { worlds.setValues("joints.hip.axes.0.drive_stiffness", all, values); });
  // the second body with that material, in the last world
  values[68] = 2, values[69] = std::nan("");
  expectPath("worlds[69].body.material.staticFriction",
             [&] { worlds.setValues("materials.wood.friction", all, values); });
  EXPECT_EQ(worlds.values("bodies.pole.mass", all),
            std::vector<double>(70, worlds.values("bodies.pole.mass", all)[5]));
  EXPECT_EQ((std::vector<std::uint64_t>{worlds[0].hash(), worlds[69].hash()}), before);
  const std::vector<int> one{0}, twice{0, 0}, beyond{70};
  const std::vector<double> three{1, 2, 3};
  expectPath("worlds", [&] { worlds.setValues("gravity", twice, std::vector<double>(6)); });
  expectPath("world", [&] { worlds.setValues("gravity", beyond, three); });
  worlds.setValues("gravity", {}, {});
  expectPath("values", [&] { worlds.setValues("gravity", one, {}); });
}

TEST(Values, APathThatNamesNothingIsAnError) {
  Worlds worlds(worldsOptions());
  worlds.addCopies(variedScene(), 1);
  const std::vector<int> one{0};
  const std::vector<double> number{1}, three{1, 2, 3};
  const auto set = [&](const std::string& path) {
    return [&worlds, &one, &number, path] { worlds.setValues(path, one, number); };
  };
  for (const char* path : {"", "bodies", "bodies.pole", "dt", "iterations", "bodys.pole.mass", "bodies..mass",
                           "gravity.x", "bodies[", "bodies[\"pole].mass", "bodies[x].mass"})
    expectPath("path", set(path));
  for (const char* path :
       {"bodies.pole.weight", "bodies.pole.mass.x", "bodies.pole.material", "bodies[9].mass",
        "joints.hip.axes.1.friction", "joints.hip.axes", "bodies.pole.shape.size",
        "deformables.rope.velocity", "deformables.rope.vertices", "attachments.hook.weights"})
    expectPath("worlds[0].path", set(path));
  expectPath("worlds[0].body", set("bodies.left.mass"));
  expectPath("worlds[0].joint", set("joints.knee.length"));
  expectPath("worlds[0].deformable", set("deformables.sheet.density"));
  expectPath("worlds[0].attachment", set("attachments.none.stiffness"));
  expectPath("worlds[0].actuator", set("actuators.motor.gear"));
  expectPath("worlds[0].material", set("materials.ice.friction"));
  expectPath("worlds[0].material_pairs", set("material_pairs.wood.ice.friction"));
  expectPath("worlds[0].values", [&] { worlds.setValues("bodies.pole.mass", one, three); });
}

TEST(RandomNumbers, OfAWorldDependOnItsSeedItsEpisodeAndTheirNumber) {
  Worlds few(worldsOptions()), many(worldsOptions());
  few.addCopies(test::tower(1), 2), many.setSeed(5), many.addCopies(test::tower(1), 40);
  few.setSeed(5);
  const std::vector<int> one{1}, two{0, 1}, thirty{30, 1};
  const std::vector<double> first = few.uniform(one, 3);
  const std::vector<double> both = many.uniform(thirty, 3);
  EXPECT_EQ(first, std::vector<double>(both.begin() + 3, both.end()));
  EXPECT_NE(first, std::vector<double>(both.begin(), both.begin() + 3));
  EXPECT_NE(few.uniform(one, 3), first) << "the next ones";
  // resets of one world are its own
  const Snapshot start = few[0].snapshot(), other = many[0].snapshot();
  few.reset(two, {&start, 1}), many.reset(one, {&other, 1}), many.reset(std::vector<int>{7}, {&other, 1});
  const std::vector<double> second = few.uniform(one, 5, -2, 4);
  EXPECT_EQ(second, many.uniform(one, 5, -2, 4));
  for (const double x : second) EXPECT_TRUE(x >= -2 && x < 4);
  const RandomState state = few.randomState(1);
  EXPECT_EQ(state.episode, 1);
  EXPECT_EQ(state.drawn, 5);
  many.setRandomState(30, state);
  EXPECT_EQ(many.uniform({thirty.data(), 1}, 4), few.uniform(one, 4));
  few.setSeed(5, one);
  EXPECT_EQ(few.uniform(one, 3), first);
}

TEST(RandomNumbers, AreSpreadEvenly) {
  Worlds worlds(worldsOptions());
  worlds.addCopies(test::tower(1), 64);
  const std::vector<double> numbers = worlds.uniform(allOf(worlds), 1000);
  std::array<int, 10> bins{};
  for (const double x : numbers) ++bins[static_cast<std::size_t>(x * 10)];
  for (const int count : bins) EXPECT_NEAR(count, 6400, 5 * std::sqrt(6400 * 0.9));
}

TEST(RandomNumbers, NameWhatIsInvalid) {
  Worlds worlds(worldsOptions());
  worlds.addCopies(test::tower(1), 2);
  const std::vector<int> one{0}, beyond{2};
  expectPath("world", [&] { worlds.uniform(beyond, 1); });
  expectPath("count", [&] { worlds.uniform(one, -1); });
  expectPath("high", [&] { worlds.uniform(one, 1, 1, 0); });
  expectPath("state.drawn", [&] { worlds.setRandomState(0, {1, 0, -1}); });
}

}  // namespace
}  // namespace rubble
