/// If any table overflows, the step grows it, reports this and gives the result of a world with room for
/// all.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kSteps = 12;
constexpr int kAmple = 100'000;
const std::vector<std::string> kKinds = {"pairs",      "activePairs", "manifolds", "incidences", "colors",
                                         "aggregates", "slices",      "boundary",  "freeIslands"};
const std::vector<std::string> kGeneralKinds = {"rollers", "pointPairs", "pointIncidences", "nearFeatures"};
const std::vector<std::string> kColumnKinds = {"columnNodes"};

/// Two soft cubes, one falls on the other, and balls with rolling friction.
Scene softAndRolling() {
  Scene scene = test::emptyScene();
  scene.bodies = {test::ground()};
  for (int k = 0; k < 4; ++k) scene.bodies.push_back(test::body(Shape::sphere(.1), {1, .5 * k, .1}));
  for (BodyDef& b : scene.bodies) b.material.rollingFriction = .01;
  scene.deformables = {tetBox({-.2, -.2, .01}, {.4, .4, .4}, {3, 3, 3}),
                       tetBox({-.18, -.15, .45}, {.4, .4, .4}, {3, 3, 3})};
  return scene;
}

std::vector<std::uint64_t> hashesOf(World& world, std::vector<std::string>& grown) {
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < kSteps; ++i) {
    for (const Growth& growth : world.step().grown) {
      EXPECT_GT(growth.needed, 1) << growth.what;
      if (std::find(grown.begin(), grown.end(), growth.what) == grown.end()) grown.push_back(growth.what);
    }
    hashes.push_back(world.hash());
  }
  std::sort(grown.begin(), grown.end());
  return hashes;
}

class Overflow : public ::testing::TestWithParam<const char*> {
 protected:
  /// A world with room for everything but `scarce`, whose tables begin with one element.
  World worldBut(const std::string& scarce, const Scene& scene = test::heap(6)) const {
    World world(scene, test::options(4, GetParam(), 2));
    for (const std::vector<std::string>* kinds : {&kKinds, &kGeneralKinds, &kColumnKinds})
      for (const std::string& kind : *kinds)
        if (kind != scarce && scarce != "all") world.reserve(kind, kAmple);
    return world;
  }
  void expectEachReported(const Scene& scene, const std::vector<std::string>& kinds) const {
    World ample = worldBut("", scene);
    std::vector<std::string> grown;
    const std::vector<std::uint64_t> wanted = hashesOf(ample, grown);
    EXPECT_TRUE(grown.empty());
    for (const std::string& kind : kinds) {
      World scarce = worldBut(kind, scene);
      grown.clear();
      EXPECT_EQ(hashesOf(scarce, grown), wanted) << kind;
      EXPECT_EQ(grown, std::vector<std::string>{kind});
    }
  }
};

TEST_P(Overflow, OfEachTableIsReportedAndChangesNoResult) { expectEachReported(test::heap(6), kKinds); }

TEST_P(Overflow, OfTablesOfVerticesAndRollingBodiesIsReportedAndChangesNoResult) {
  expectEachReported(softAndRolling(), kGeneralKinds);
}

TEST_P(Overflow, OfTheTableOfColumnsIsReportedAndChangesNoResult) {
  constexpr int kLevels = 20;
  expectEachReported(test::tower(kLevels), kColumnKinds);
}

TEST_P(Overflow, OfAllTablesAtOnceIsReportedAndChangesNoResult) {
  World ample = worldBut(""), scarce = worldBut("all");
  std::vector<std::string> none, grown, all = kKinds;
  std::sort(all.begin(), all.end());
  EXPECT_EQ(hashesOf(scarce, grown), hashesOf(ample, none));
  EXPECT_EQ(grown, all);
}

INSTANTIATE_TEST_SUITE_P(Backends, Overflow, ::testing::Values("cpu", "reference", "lockstep"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Reserve, RefusesKindsThatThereAreNot) {
  World world(test::tower(1), test::options());
  EXPECT_THROW(world.reserve("bricks", 5), Error);
  EXPECT_THROW(world.reserve("pairs", -1), Error);
}

}  // namespace
}  // namespace rubble
