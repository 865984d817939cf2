// Room is found out on the device: a step that lacks it goes on with more, and nobody can tell from the result.
#include "tests/cuda/cuda_scenes.h"

namespace rubble::test {
namespace {

class CudaCapacity : public CudaTest {};

/// A world in its first step has room for nothing; one that has run the same scene before and was set back has room for all.
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

TEST_F(CudaCapacity, SettledScenesDoNotRestart) {
  World world(brickPile(4, 4), optionsFor("cuda"));
  run(world, 30);
  int restarts = 0;
  for (int i = 0; i < 100; ++i) restarts += world.step().restarts;
  EXPECT_EQ(restarts, 0);
}

/// Bodies rain into a box: pairs, manifolds, entries and slots all grow again and again.
TEST_F(CudaCapacity, GrowsWithTheScene) {
  World cpu(ground(), optionsFor("cpu")), cuda(ground(), optionsFor("cuda"));
  int restarts = 0;
  for (int i = 0; i < 40; ++i) {
    for (World* world : {&cpu, &cuda})
      for (int k = 0; k < 8; ++k) world->add(boxAt({1.5 * k, 1.5 * (i % 8), .6 + 1.1 * (i / 8)}));
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

/// More colours than there are launches for at first: one ground box that all others touch, and a clique of overlapping boxes.
TEST_F(CudaCapacity, FindsAsManyColorsAsItTakes) {
  Scene scene = ground();
  constexpr int kClique = 40;
  for (int i = 0; i < kClique; ++i) scene.bodies.push_back(boxAt({.001 * i, .0013 * i, 3 + .0017 * i}));
  World cpu(scene, optionsFor("cpu")), cuda(scene, optionsFor("cuda"));
  const StepReport a = cpu.step(), b = cuda.step();
  EXPECT_GE(b.colors, kClique);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(b.clashes, 0);
}

}  // namespace
}  // namespace rubble::test
