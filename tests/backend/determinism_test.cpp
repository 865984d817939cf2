/// The same bits at any number of threads, and the lockstep that proves it.
#include <backend/lockstep/lockstep_pair.h>

#include <tbb/global_control.h>

#include "tests/support/core_world.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kSteps = 120;

/// More threads than this machine may have cores.
const tbb::global_control kManyThreads(tbb::global_control::max_allowed_parallelism, 8);

std::vector<std::uint64_t> hashes(int threads, const std::string& backend) {
  World world(test::heap(8), test::options(4, backend, threads));
  std::vector<std::uint64_t> out;
  for (int i = 0; i < kSteps; ++i) {
    world.step();
    out.push_back(world.hash());
  }
  return out;
}

TEST(Determinism, AFallingPileHasTheSameBitsAtAnyNumberOfThreads) {
  const auto one = hashes(1, "cpu");
  // the pile moves: no two states are alike
  EXPECT_EQ(std::set<std::uint64_t>(one.begin(), one.end()).size(), one.size());
  for (const int threads : {2, 3, 5}) EXPECT_EQ(hashes(threads, "cpu"), one) << threads;
}

TEST(Determinism, TheReferenceHasTheSameBitsAtAnyNumberOfThreads) {
  EXPECT_EQ(hashes(3, "reference"), hashes(1, "reference"));
}

TEST(Determinism, LockstepFindsNoDifferenceAndHasTheBitsOfTheCpu) {
  World lockstep(test::heap(8), test::options(4, "lockstep", 3)),
      cpu(test::heap(8), test::options(4, "cpu", 1));
  for (int i = 0; i < kSteps; ++i) {
    lockstep.step(), cpu.step();
    ASSERT_EQ(lockstep.firstDifference(), "") << i;
  }
  EXPECT_EQ(lockstep.hash(), cpu.hash());
}

TEST(Determinism, EditsWhileRunningKeepTheBits) {
  const auto run = [](int threads) {
    World world(test::heap(4), test::options(4, "cpu", threads));
    test::run(world, 30);
    world.remove(world.bodyAt(5));
    world.remove(world.bodyAt(9));
    for (int i = 0; i < 10; ++i) {
      world.add(test::unitCube({.2 * i, 0, 6. + 1.2 * i}));
      test::run(world, 3);
    }
    world.applyImpulse(world.bodyAt(20), {1, 2, 3});
    test::run(world, 30);
    return world.hash();
  };
  EXPECT_EQ(run(1), run(4));
}

}  // namespace

namespace RUBBLE_CORE {
namespace {

/// Two executors with the same falling cubes.
class Lockstep : public ::testing::Test {
 protected:
  static constexpr int kBodies = 300;

  Lockstep() {
    settings_.gravity = {0, 0, -10};
    both([](HostTables& t) {
      setBodyCount(t, kBodies);
      for (int i = 0; i < kBodies; ++i) {
        EngineBody body;
        body.kind = 3;
        const Shape cube = Shape::box({.5, .5, .5});
        const CookedShape cooked = cook(cube);
        body.shape = cooked.shape, body.radius = cooked.radius;
        body.mass = massProperties(cube, 1);
        body.state.position = {1. * (i % 10), 1. * (i / 10 % 10), 1. * (i / 100)};
        body.state.velocity = {0, 0, i >= 100 ? -1. : 0.};
        setBody(t, i, body);
      }
      setPlanes(t, {});
    });
  }

  template <class F> void both(F&& f) {
    f(pair_.a().tables());
    f(pair_.b().tables());
  }
  SolverData& b() { return pair_.b().view(); }

  template <class Plant> std::string stepWith(Plant&& plant) {
    both([&](HostTables& t) { beginStep(t.view(), settings_, step_ > 0 ? 1. / 60 : 0); });
    plant();
    pair_.step(step_++);
    return pair_.firstDifference();
  }
  std::string plainStep() {
    return stepWith([] {});
  }

  LockstepPair pair_{1, 2};
  EngineSettings settings_;
  int step_ = 0;
};

TEST_F(Lockstep, FindsNothingWhereThereIsNothing) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(plainStep(), "");
}

TEST_F(Lockstep, NamesStepTableAndElementOfAPlantedDifference) {
  EXPECT_EQ(plainStep(), "");
  EXPECT_EQ(plainStep(), "");
  const std::string found = stepWith([&] { b().velocity[7].x = std::nextafter(b().velocity[7].x, 1.); });
  EXPECT_EQ(found, "step 2, stage between steps, table velocity, element 7");
}

TEST_F(Lockstep, NamesTheStageThatFirstDiffers) {
  // gravity is no table: the inertial targets are the first to see it
  const std::string found = stepWith([&] { b().step->gravity.z = -9; });
  EXPECT_EQ(found, "step 0, stage predict, table target, element 0");
}

TEST_F(Lockstep, NamesADifferenceInTheSolveByItsBody) {
  EXPECT_EQ(plainStep(), "");
  // the second step begins with other multipliers
  const std::string found = stepWith([&] { b().step->gamma = .5; });
  EXPECT_NE(found.find("step 1, stage "), std::string::npos) << found;
  EXPECT_NE(found.find(", table "), std::string::npos) << found;
  EXPECT_NE(found.find(", element "), std::string::npos) << found;
}

TEST_F(Lockstep, NamesStagesWhereOnlyOneRunsThem) {
  const std::string found = stepWith([&] { b().plan.coarseCorrection = false; });
  EXPECT_EQ(found, "step 0, stage aggregates beside incidence");
}

TEST_F(Lockstep, KeepsTheFirstDifference) {
  const std::string first = stepWith([&] { b().step->gravity.z = -9; });
  b().velocity[3].y += 1;
  EXPECT_EQ(plainStep(), first);
}

}  // namespace
}  // namespace RUBBLE_CORE
}  // namespace rubble
