#include <scenes/registry.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "overlap.h"

namespace rubble::scenes {
namespace {

Arguments testSize(const Spec& spec) { return resolve(spec, spec.testArguments); }

int dynamicCount(const Scene& scene) {
  int count = 0;
  for (const BodyDef& body : scene.bodies) count += body.motion == Motion::Dynamic;
  for (const Deformable& object : scene.deformables)
    count += static_cast<int>(common(object).vertices.size() - common(object).fixed.size());
  return count;
}

int bricks(const std::string& name, const Arguments& overrides = {}) {
  const Spec& spec = find(name);
  return dynamicCount(spec.build(resolve(spec, overrides)));
}

std::string names() {
  std::string all;
  for (const Spec& spec : registry()) all += spec.name + " ";
  return all;
}

TEST(Registry, NamesAndArgumentsAreUniqueAndDescribed) {
  std::set<std::string> seen;
  for (const Spec& spec : registry()) {
    SCOPED_TRACE(spec.name);
    EXPECT_TRUE(seen.insert(spec.name).second);
    EXPECT_FALSE(spec.doc.empty());
    EXPECT_EQ(spec.doc.back(), '.');
    EXPECT_FALSE(spec.tags.empty());
    EXPECT_GT(spec.steps, 0);
    EXPECT_GT(spec.iterations, 0);
    EXPECT_LT(spec.smashStep, spec.steps);
    std::set<std::string> argumentNames;
    for (const Argument& argument : spec.arguments) {
      SCOPED_TRACE(argument.name);
      EXPECT_TRUE(argumentNames.insert(argument.name).second);
      EXPECT_FALSE(argument.unit.empty());
      EXPECT_FALSE(argument.doc.empty());
      EXPECT_LE(argument.min, argument.value);
      EXPECT_LE(argument.value, argument.max);
    }
  }
}

TEST(Registry, EverySceneStandsInTheDocumentation) {
  std::ifstream file(RUBBLE_SOURCE_DIR "/docs/scenes.md");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  ASSERT_FALSE(text.empty());
  for (const Spec& spec : registry())
    EXPECT_NE(text.find("`" + spec.name + "`"), std::string::npos) << spec.name;
}

TEST(Registry, EveryStackHasASupportRemoval) {
  for (const char* name :
       {"tower", "mass", "pile", "wall", "walls", "ring", "gables", "pyramid", "stack-ratio"})
    EXPECT_NO_THROW(find(std::string(name) + "-removal")) << names();
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, BuildsAndIsValidAtTestSize) {
  const Spec& spec = find(GetParam());
  const Job job = prepare(spec, spec.testArguments);
  EXPECT_NO_THROW(validate(job.scene));
  EXPECT_EQ(job.scene.name, spec.name);
  EXPECT_GT(dynamicCount(job.scene), 0);
  EXPECT_LT(dynamicCount(job.scene), 2000) << "too large for a test";
  EXPECT_FALSE(job.probes.empty());
  EXPECT_FALSE(job.claims.empty());
  for (const Claim& claim : job.claims) {
    EXPECT_LE(claim.min, claim.max) << claim.metric;
    EXPECT_FALSE(claim.why.empty()) << claim.metric;
  }
}

TEST_P(EveryScene, EventsNameBodiesAndJointsOnce) {
  const Spec& spec = find(GetParam());
  const Scene scene = spec.build(testSize(spec));
  std::map<std::string, int> bodies, joints;
  for (const BodyDef& body : scene.bodies)
    if (!body.name.empty()) ++bodies[body.name];
  for (const Event& event : scene.events)
    for (const BodyDef& body : event.add) ++bodies[body.name];
  for (const JointDef& joint : scene.joints)
    if (!joint.name.empty()) ++joints[joint.name];
  for (const auto& [name, count] : bodies) EXPECT_EQ(count, 1) << name;
  for (const auto& [name, count] : joints) EXPECT_EQ(count, 1) << name;
  for (const Event& event : scene.events) {
    EXPECT_LT(event.step, spec.steps);
    for (const std::string& name : event.remove) EXPECT_EQ(bodies[name], 1) << name;
    for (const std::string& name : event.removeJoints) EXPECT_EQ(joints[name], 1) << name;
    for (const Event::Push& push : event.setVelocity) EXPECT_EQ(bodies[push.body], 1) << push.body;
  }
}

TEST_P(EveryScene, BodiesTouchButDoNotOverlap) {
  const Spec& spec = find(GetParam());
  EXPECT_LE(deepestOverlap(spec.build(testSize(spec))), 1e-6);
}

TEST_P(EveryScene, CameraSeesTheWholeFromOutside) {
  const Spec& spec = find(GetParam());
  const Arguments arguments = testSize(spec);
  const Scene scene = spec.build(arguments);
  const Camera camera = spec.camera(arguments, scene);
  const double distance = length(camera.eye - camera.target);
  ASSERT_TRUE(std::isfinite(distance));
  for (const BodyDef& body : scene.bodies)
    if (body.motion == Motion::Dynamic) {
      EXPECT_LT(length(body.position - camera.target), .6 * distance);
    }
}

TEST_P(EveryScene, JointAnchorsCoincideAtTheStart) {
  const Spec& spec = find(GetParam());
  const Scene scene = spec.build(testSize(spec));
  const auto anchor = [&](int body, const Vec3& local) {
    if (body == kWorld) return local;
    const BodyDef& def = scene.bodies[std::size_t(body)];
    return def.position + rotate(def.orientation, local);
  };
  const auto coincide = [](JointType type) {
    return type == JointType::Ball || type == JointType::Fixed || type == JointType::Hinge ||
           type == JointType::Universal || type == JointType::SwingTwist || type == JointType::Drag;
  };
  for (const JointDef& joint : scene.joints) {
    if (coincide(joint.type)) {
      EXPECT_LT(length(anchor(joint.bodyA, joint.anchorA) - anchor(joint.bodyB, joint.anchorB)), 1e-9)
          << joint.name;
    }
  }
}

std::vector<std::string> sceneNames() {
  std::vector<std::string> all;
  for (const Spec& spec : registry()) all.push_back(spec.name);
  return all;
}

std::string identifier(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn(sceneNames()), identifier);

TEST(Scenes, HaveTheirCountsOfBodies) {
  EXPECT_EQ(bricks("pile-1k"), 1'000);
  EXPECT_EQ(bricks("pile-10k"), 10'000);
  EXPECT_EQ(bricks("pile-110k"), 110'000);
  EXPECT_EQ(bricks("pile-510k"), 510'000);
  EXPECT_EQ(bricks("walls-110k"), 110'160);
  EXPECT_EQ(bricks("walls-510k"), 510'300);
  EXPECT_EQ(bricks("walls-1m"), 1'049'760);
  // of larger ones, a wall has as many
  EXPECT_EQ(1620 * resolve(find("walls-2m"), {}).at("walls"), 2'000'700);
  EXPECT_EQ(1620 * resolve(find("walls-4m"), {}).at("walls"), 4'001'400);
  EXPECT_EQ(bricks("ring-5k"), 5'000);
  EXPECT_EQ(bricks("ring-110k"), 110'000);
  EXPECT_EQ(bricks("gables-510k"), 505'920);
  EXPECT_EQ(bricks("pyramid-50"), 1'275);
  EXPECT_EQ(bricks("pyramid-100"), 5'050);
  EXPECT_EQ(bricks("many-pyramids"), 10'780);
  EXPECT_EQ(bricks("mass-1000"), 11);
  EXPECT_EQ(bricks("chain-100-1000"), 100);
  EXPECT_EQ(bricks("heavy-wall"), 10 * 40 + 10 * 41);
  EXPECT_EQ(bricks("wall-40"), 20 * 20 + 20 * 21);
  EXPECT_EQ(bricks("drop-pyramid"), 136);
}

TEST(Scenes, JointGridHasEveryJointThatHoldsSomething) {
  const Spec& spec = find("joint-grid");
  // 19,800 less the 99 between two static spheres of the first row.
  EXPECT_EQ(spec.build(resolve(spec, {})).joints.size(), 19'701u);
}

TEST(Scenes, OfJointsHaveTheirCounts) {
  const auto scene = [](const char* name) { return find(name).build(resolve(find(name), {})); };
  const Scene quilts = scene("joints-35k"), chains = scene("chains-1000x50");
  EXPECT_EQ(quilts.bodies.size(), 34'993u);  // with the ground
  EXPECT_EQ(quilts.joints.size(), 71'984u);
  EXPECT_EQ(chains.bodies.size(), 50'000u);
  EXPECT_EQ(chains.joints.size(), 50'000u);
}

TEST(Scenes, DoNotOverlapAtFullSize) {
  for (const char* name :
       {"pile-10k", "ring-5k", "ring-110k", "walls", "heavy-wall", "wall-40", "gables", "pyramid-50",
        "many-pyramids", "card-tower", "tower-40", "mass-1000", "stack-ratio", "corbel-arch", "dominoes",
        "bridge", "heavy-rope", "swing-100-1000"}) {
    const Spec& spec = find(name);
    EXPECT_LE(deepestOverlap(spec.build(resolve(spec, {}))), 1e-6) << name;
  }
}

TEST(Scenes, SmashesBeginClearOfTheStack) {
  for (const Spec& spec : registry()) {
    if (spec.smashStep < 0) continue;
    Scene scene = spec.build(testSize(spec));
    for (const Event& event : scene.events)
      scene.bodies.insert(scene.bodies.end(), event.add.begin(), event.add.end());
    EXPECT_LE(deepestOverlap(scene), 1e-6) << spec.name;
  }
}

TEST(Scenes, ScaleChangesLengthsAndDensitiesAlone) {
  for (const Spec& spec : registry()) {
    if (!spec.testArguments.contains("length_scale") && resolve(spec, {}).count("length_scale") == 0)
      continue;
    SCOPED_TRACE(spec.name);
    Arguments scaled = testSize(spec);
    const Scene plain = spec.build(scaled);
    scaled["length_scale"] *= 4;
    scaled["density"] *= 10;
    const Scene large = spec.build(scaled);
    ASSERT_EQ(plain.bodies.size(), large.bodies.size());
    for (std::size_t i = 0; i < plain.bodies.size(); ++i) {
      const BodyDef &a = plain.bodies[i], &b = large.bodies[i];
      EXPECT_LT(length(4.0 * a.position - b.position), 1e-9);
      if (a.motion != Motion::Dynamic) continue;
      EXPECT_LT(length(4.0 * a.shape.halfExtents - b.shape.halfExtents), 1e-9);
      EXPECT_DOUBLE_EQ(10 * a.density, b.density);
      if (a.mass) {
        EXPECT_NEAR(*b.mass / *a.mass, 640, 1e-9);
      }
    }
    for (std::size_t i = 0; i < plain.events.size(); ++i)
      for (std::size_t j = 0; j < plain.events[i].add.size(); ++j)
        EXPECT_LT(length(2.0 * plain.events[i].add[j].velocity - large.events[i].add[j].velocity), 1e-9);
  }
}

TEST(Prepare, LeavesOutTheSmashPhaseWithTheBall) {
  const Spec& spec = find("pile");
  EXPECT_EQ(prepare(spec, spec.testArguments).smashStep, 120);
  Arguments hold = spec.testArguments;
  hold["smash"] = 0;
  EXPECT_EQ(prepare(spec, hold).smashStep, -1);
}

void expectError(const std::function<void()>& call, const std::vector<std::string>& parts) {
  try {
    call();
    FAIL() << "no error";
  } catch (const Error& error) {
    for (const std::string& part : parts)
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << error.what() << " does not say " << part;
  }
}

TEST(Find, SuggestsSimilarNames) {
  EXPECT_EQ(find("pile-10k").name, "pile-10k");
  expectError([] { find("piles-10k"); }, {"pile-10k", "\"piles-10k\""});
  expectError([] { find("ring110k"); }, {"ring-110k"});
  expectError([] { find("zzzzzzzzzz"); }, {"rubble info scenes"});
}

TEST(Resolve, TakesDefaultsAndOverrides) {
  const Spec& spec = find("pile");
  EXPECT_EQ(resolve(spec, {}).at("levels"), 40);
  const Arguments resolved = resolve(spec, {{"levels", 7}, {"density", .5}});
  EXPECT_EQ(resolved.at("levels"), 7);
  EXPECT_EQ(resolved.at("density"), .5);
  EXPECT_EQ(resolved.at("nx"), 5);
}

TEST(Resolve, NamesTheArgumentThatIsWrong) {
  const Spec& spec = find("pile");
  expectError([&] { resolve(spec, {{"level", 3}}); }, {"pile", "levels", "\"level\""});
  expectError([&] { resolve(spec, {{"levels", 0}}); }, {"pile", "argument levels", "[1, 200]", "0"});
  expectError([&] { resolve(spec, {{"levels", 2.5}}); }, {"argument levels", "whole number", "2.5"});
  expectError([&] { resolve(spec, {{"density", std::nan("")}}); }, {"argument density"});
  expectError([&] { resolve(find("drop"), {{"height", 1}}); }, {"drop", "\"height\""});
}

TEST(Judge, HoldsInsideTheBoundsOnly) {
  const std::vector<Claim> claims{{"a", 0, 1, "in range"}};
  EXPECT_TRUE(judge(claims, {{"a", 0}}).holds);
  EXPECT_TRUE(judge(claims, {{"a", 1}}).holds);
  EXPECT_FALSE(judge(claims, {{"a", 1.01}}).holds);
  EXPECT_FALSE(judge(claims, {{"a", -.01}}).holds);
  EXPECT_TRUE(judge({}, {}).holds);
}

TEST(Judge, FailsForWhatIsMissingOrNotFinite) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<Claim> claims{{"a", -inf, inf, "anything"}, {"b", 0, 1, "in range"}};
  const Verdict missing = judge(claims, {{"b", .5}});
  ASSERT_EQ(missing.results.size(), 2u);
  EXPECT_FALSE(missing.holds);
  EXPECT_FALSE(missing.results[0].holds);
  EXPECT_TRUE(missing.results[1].holds);
  EXPECT_EQ(missing.results[1].value, .5);
  EXPECT_FALSE(judge(claims, {{"a", std::nan("")}, {"b", .5}}).holds);
  EXPECT_FALSE(judge(claims, {{"a", inf}, {"b", .5}}).holds);
}

}  // namespace
}  // namespace rubble::scenes
