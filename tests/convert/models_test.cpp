/// The models of tests/convert/models: they import, become files, run, and survive mutation.
#include <chrono>
#include <cmath>
#include <random>
#include <sstream>

#include <rubble/world.h>

#include "io/scene_json.h"
#include "tests/convert/model_file.h"

namespace rubble {
namespace {

namespace fs = std::filesystem;

const fs::path kModels = fs::path(RUBBLE_SOURCE_DIR) / "tests/convert/models";
const std::vector<std::string> kNames{"pendulum.xml",
                                      "double_pendulum.xml",
                                      "fourbar.xml",
                                      "two_hinges.xml",
                                      "reach.xml",
                                      "arm.xml",
                                      "quadruped.xml",
                                      "humanoid.xml",
                                      "every_tag.xml",
                                      "arm.urdf",
                                      "finger.xml",
                                      "armature_pendulum.xml",
                                      "geared.xml",
                                      "standing_humanoid.xml",
                                      "standing_quadruped.xml",
                                      "machine.usda",
                                      "gate.gltf",
                                      "cable.xml",
                                      "composite_cable.xml",
                                      "wrapped.xml",
                                      "attached.xml",
                                      "drone.xml",
                                      "gripper.xml",
                                      "soft_limits.xml",
                                      "telescope.xml",
                                      "two_tendons.xml",
                                      "gimbals.xml",
                                      "muscle_arm.xml",
                                      "rotors.xml",
                                      "compound.xml"};

std::string contentOf(const fs::path& file) {
  std::ostringstream out;
  out << std::ifstream(file, std::ios::binary).rdbuf();
  return out.str();
}

TEST(Models, EachIsTheSameSceneAfterAFile) {
  for (const std::string& name : kNames) {
    SCOPED_TRACE(name);
    const convert::Import model = convert::importModel((kModels / name).string());
    const std::string text = io::toJson(model.file);
    std::vector<io::Fault> faults;
    const io::SceneFile again = io::parseScene(text, faults);
    EXPECT_TRUE(faults.empty()) << io::faultText(name, faults);
    EXPECT_EQ(io::toJson(again), text);
  }
}

TEST(Models, EachRunsAndStaysFinite) {
  for (const std::string& name : kNames) {
    SCOPED_TRACE(name);
    const convert::Import model = convert::importModel((kModels / name).string());
    WorldOptions options;
    options.threads = 1;
    options.params.dt = model.file.dt;
    options.params.iterations = model.file.iterations;
    World world(model.file.scene, options);
    for (int step = 0; step < 60; ++step) world.step();
    for (const BodyId id : world.bodies()) {
      const BodyState state = world.state(id);
      EXPECT_TRUE(std::isfinite(length(state.position) + length(state.velocity)));
      EXPECT_LT(length(state.velocity), 50);
    }
    for (const JointId id : world.joints()) EXPECT_LT(world.state(id).gap, 5e-3) << world.definition(id).name;
  }
}

/// Robots with position drives hold the pose of their keyframe on the ground: 4 iterations, the time step of
/// the model, anchors together to 0.1 mm.
void standFor(double seconds) {
  for (const char* name : {"standing_humanoid.xml", "standing_quadruped.xml"}) {
    SCOPED_TRACE(name);
    convert::ImportOptions importing;
    importing.key = "stand";
    const convert::Import model = convert::importModel((kModels / name).string(), importing);
    ASSERT_GE(model.file.scene.joints.size(), 13u);
    WorldOptions options;
    options.threads = 1;
    options.params.dt = model.file.dt;
    options.params.iterations = 4;
    World world(model.file.scene, options);
    std::vector<BodyState> before;
    for (const BodyId id : world.bodies()) before.push_back(world.state(id));
    double gap = 0;
    for (int step = 0; step < std::lround(seconds / model.file.dt); ++step) {
      world.step();
      for (const JointId id : world.joints()) gap = std::max(gap, world.state(id).gap);
    }
    EXPECT_LT(gap, 1e-4);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const BodyState now = world.state(world.bodies()[i]);
      EXPECT_LT(length(now.position - before[i].position), 0.1) << i;
      EXPECT_GT(std::fabs(dot(now.orientation.v, before[i].orientation.v) +
                          now.orientation.s * before[i].orientation.s),
                0.99)
          << i;
    }
  }
}
TEST(Models, StandingRobotsHoldTheirPose) { standFor(1.5); }
TEST(LongModels, StandingRobotsHoldTheirPoseForTenSeconds) { standFor(10); }

/// One random change of a text.
void mutate(std::string& text, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  static const std::vector<std::string> kPieces{"-1",
                                                "0",
                                                "1e308",
                                                "nan",
                                                "inf",
                                                "\"",
                                                "<",
                                                ">",
                                                "/>",
                                                "&#0;",
                                                "1 2 3 4 5 6 7",
                                                "<body>",
                                                "</body>",
                                                "name=\"a\"",
                                                "<joint/>",
                                                "<geom/>",
                                                "type=\"mesh\"",
                                                " ",
                                                "\xff",
                                                "<replicate count=\"3\">",
                                                "-",
                                                "{",
                                                "}",
                                                "[",
                                                "]",
                                                "(",
                                                ")",
                                                "=",
                                                ",",
                                                "@",
                                                "@a.usda@",
                                                "</Machine>",
                                                "def \"a\"",
                                                "None",
                                                "0.5,",
                                                "\"\"\"",
                                                "references = </Machine/Lift>",
                                                "prepend apiSchemas = [\"PhysicsRigidBodyAPI\"]",
                                                "99999999999999999999",
                                                "<tendon>",
                                                "<site site=\"s1\"/>",
                                                "<flexcomp/>",
                                                "\"children\":[0],",
                                                "null",
                                                "true",
                                                "{}",
                                                "[]"};
  const std::size_t at = below(text.size()), count = std::min(text.size() - at, 1 + below(12));
  switch (below(6)) {
    case 0:
      text.erase(at, count);
      break;
    case 1:
      text.insert(at, kPieces[below(kPieces.size())]);
      break;
    case 2:
      text.replace(at, count, kPieces[below(kPieces.size())]);
      break;
    case 3:
      text[at] = static_cast<char>(below(256));
      break;
    case 4: {  // an entry of a crate of 32 bits
      const std::uint32_t value = below(2) ? static_cast<std::uint32_t>(below(300))
                                           : static_cast<std::uint32_t>(random());
      if (text.size() > at + 4) text.replace(at, 4, reinterpret_cast<const char*>(&value), 4);
      break;
    }
    default:
      text.insert(below(text.size()), text.substr(at, count));
  }
}

/// Imports `rounds` mutated models from memory: an Error is a correct answer. Each ends within ten seconds.
void importMutated(int rounds, unsigned seed) {
  std::vector<std::string> texts;
  for (const std::string& name : kNames) texts.push_back(contentOf(kModels / name));
  texts.push_back(contentOf(fs::path(RUBBLE_SOURCE_DIR) / "tests/fuzz/corpus/model/machine.usdc"));
  std::mt19937 random(seed);
  int imported = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string text = texts[static_cast<std::size_t>(round) % texts.size()];
    const int changes = 1 + round % 4;
    for (int k = 0; k < changes && !text.empty(); ++k) mutate(text, random);
    const auto started = std::chrono::steady_clock::now();
    try {
      const convert::Import model = convert::importContent(text, "model");
      EXPECT_FALSE(convert::jsonOf(model.report).empty());
      ++imported;
    } catch (const Error&) {
    }
    EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(10)) << text;
  }
  EXPECT_GT(imported, rounds / 50);
  EXPECT_LT(imported, rounds);
}

TEST(Models, MutatedOnesImportOrFailWithAnError) { importMutated(2000, 20240607); }
/// A million cases take half an hour of one core.
TEST(LongModels, AMillionMutatedOnesImportOrFailWithAnError) { importMutated(1000000, 20240608); }

}  // namespace
}  // namespace rubble
