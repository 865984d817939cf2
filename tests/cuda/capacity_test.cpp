// The device detects overflow of its tables. Such a step runs again with larger tables and gives the same
// result.
#include <set>

#include "tests/cuda/cuda_scenes.h"

namespace rubble::test {
namespace {

class CudaCapacity : public CudaTest {};

/// A world in its first step has tables without room. A world that has run the same scene and was reset has
/// room for all.
TEST_F(CudaCapacity, OverflowDoesNotChangeTheResult) {
  World ample(mixedScene(), optionsFor("cuda"));
  const Snapshot start = ample.snapshot();
  run(ample, 90);
  ample.restore(start);
  World scarce(mixedScene(), optionsFor("cuda"));
  int scarceRestarts = 0, ampleRestarts = 0;
  for (int i = 0; i < 90; ++i) {
    scarceRestarts += scarce.step().restarts;
    ampleRestarts += ample.step().restarts;
    ASSERT_TRUE(sameStates(ample, scarce)) << "after step " << i;
  }
  EXPECT_GT(scarceRestarts, 2);
  EXPECT_LT(ampleRestarts, scarceRestarts);
}

using Kinds = std::set<std::string>;
const Kinds kKinds = {"pairs",  "activePairs", "manifolds", "incidences",
                      "colors", "aggregates",  "slices",    "boundary"};
/// A world with room for all kinds but these, which begin with one element.
World worldBut(const Kinds& scarce, const Scene& scene = mixedScene()) {
  World world(scene, optionsFor("cuda"));
  for (const std::string& kind : kKinds)
    if (scarce.count(kind) == 0) world.reserve(kind, 100'000);
  return world;
}

TEST_F(CudaCapacity, OverflowOfEachTableIsReportedAndChangesNoResult) {
  World ample = worldBut({});
  std::vector<std::uint64_t> wanted;
  for (int i = 0; i < 40; ++i) {
    EXPECT_TRUE(ample.step().grown.empty()) << i;
    wanted.push_back(ample.hash());
  }
  for (const std::string& kind : kKinds) {
    World scarce = worldBut({kind});
    int growths = 0;
    for (int i = 0; i < 40; ++i) {
      const StepReport report = scarce.step();
      EXPECT_EQ(report.restarts, static_cast<int>(report.grown.size()));
      for (const Growth& growth : report.grown) EXPECT_EQ(growth.what, kind) << i;
      growths += report.restarts;
      ASSERT_EQ(scarce.hash(), wanted[static_cast<std::size_t>(i)]) << kind << " after step " << i;
    }
    EXPECT_GT(growths, 0) << kind;
  }
}

/// Incidences and colors are listed beside slices and boundaries. All begin with one element and need room
/// for hundreds in one step, which has become a graph by then: pairs of boxes meet all at once.
TEST_F(CudaCapacity, OverflowOfTablesFilledSideBySideChangesNoResult) {
  Scene scene;
  scene.gravity = {0, 0, 0};
  for (int i = 0; i < 400; ++i) {
    scene.bodies.push_back(boxAt({3. * (i % 20), 3. * (i / 20), 0}));
    scene.bodies.push_back(boxAt({3. * (i % 20), 3. * (i / 20), 1.3}));
    scene.bodies.back().velocity = {0, 0, -1};
  }
  World ample = worldBut({}, scene), scarce = worldBut({"incidences", "colors", "slices", "boundary"}, scene);
  constexpr int kApart = 8;  // first steps, in which no boxes meet: 0.3 m at 1 m/s
  int restarts = 0;
  for (int i = 0; i < 60; ++i) {
    ample.step();
    const StepReport report = scarce.step();
    if (i > kApart) restarts += report.restarts;
    ASSERT_TRUE(sameStates(ample, scarce)) << "after step " << i;
  }
  EXPECT_GT(restarts, 0);
}

TEST_F(CudaCapacity, SettledScenesDoNotRestart) {
  World world(brickPile(4, 4), optionsFor("cuda"));
  run(world, 30);
  int restarts = 0;
  for (int i = 0; i < 100; ++i) restarts += world.step().restarts;
  EXPECT_EQ(restarts, 0);
}

/// Bodies rain into a box: pairs, manifolds, incidences and slots all grow again and again.
TEST_F(CudaCapacity, GrowsWithTheScene) {
  World cpu(plane(), optionsFor("cpu")), cuda(plane(), optionsFor("cuda"));
  int restarts = 0;
  for (int i = 0; i < 40; ++i) {
    for (World* world : {&cpu, &cuda})
      for (int k = 0; k < 8; ++k) world->addBody(boxAt({1.5 * k, 1.5 * (i % 8), .6 + 1.1 * (i / 8)}));
    const StepReport a = cpu.step(), b = cuda.step();
    restarts += b.restarts;
    ASSERT_EQ(a.bodies, b.bodies);
    EXPECT_EQ(b.clashes, 0);
    EXPECT_EQ(b.quarantined, 0);
  }
  EXPECT_GT(restarts, 4);
  // impacts part worlds that round differently, but not by much of a box in so short a time
  EXPECT_LT(distance(cpu, cuda), .3);
}

/// More colors than there are launches for at first: one ground box that all others touch, and a clique of
/// overlapping boxes.
TEST_F(CudaCapacity, FindsAsManyColorsAsItTakes) {
  Scene scene = plane();
  constexpr int kClique = 40;
  for (int i = 0; i < kClique; ++i) scene.bodies.push_back(boxAt({.001 * i, .0013 * i, 3 + .0017 * i}));
  World cpu(scene, optionsFor("cpu")), cuda(scene, optionsFor("cuda"));
  const StepReport a = cpu.step(), b = cuda.step();
  // the first of the boxes owns more pairs than it has slots for: its partners are searched twice
  EXPECT_GE(b.pairs, kClique * (kClique - 1) / 2);
  EXPECT_EQ(a.pairs, b.pairs);
  EXPECT_GE(b.colors, kClique);
  EXPECT_GT(a.colorRounds, 16);
  EXPECT_EQ(a.colorRounds, b.colorRounds);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(b.clashes, 0);
}

}  // namespace
}  // namespace rubble::test
