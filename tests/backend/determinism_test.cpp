/// The same bits at any number of threads, and the lockstep that proves it.
#include <backend/lockstep/lockstep_engine.h>

#include <rubble/info.h>

#include "tables/clean_copy.h"
#include "tests/support/core_world.h"
#include "tests/support/many_threads.h"
#include "tests/support/scenes.h"
#include "tests/support/worlds_claims.h"

namespace rubble {
namespace {

constexpr int kManySteps = 120;

/// More threads than this machine may have cores.
const test::ManyThreads kManyThreads(8);

std::vector<std::uint64_t> hashes(int threads, const std::string& backend) {
  World world(test::heap(8), test::options(4, backend, threads));
  std::vector<std::uint64_t> out;
  for (int i = 0; i < kManySteps; ++i) {
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

TEST(Determinism, AFallingPileHasTheSameBitsWithEveryInstructionSet) {
  const auto run = [](const std::string& set, const std::string& backend, int threads) {
    WorldOptions options = test::options(4, backend, threads);
    options.instructionSet = set, options.ranks.count = 2;
    World world(test::heap(8), options);
    test::run(world, kManySteps);
    return world.hash();
  };
  const std::uint64_t expected = run("baseline", "cpu", 1);
  for (const std::string& set : instructionSets())
    for (const auto& [backend, threads] : {std::pair{"cpu", 1}, {"cpu", 3}, {"distributed", 2}})
      EXPECT_EQ(run(set, backend, threads), expected) << set << " " << backend << " " << threads;
}

TEST(Determinism, RandomWorldsHaveTheSameBitsWithLoopsThatRunBackward) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Scene scene = test::randomWorld(seed);
    World forward(scene, test::worldsOptions("cpu")), backward(scene, test::worldsOptions("backward"));
    test::run(forward, 20), test::run(backward, 20);
    ASSERT_EQ(backward.hash(), forward.hash()) << seed;
    ASSERT_EQ(test::stateOf(backward), test::stateOf(forward)) << seed;
  }
}

TEST(Determinism, RandomWorldsHaveTheSameBitsAtAnyNumberOfThreads) {
  for (std::uint64_t seed = 100; seed < 140; ++seed) {
    const Scene scene = test::randomWorld(seed);
    World one(scene, test::worldsOptions("cpu", 1)), five(scene, test::worldsOptions("cpu", 5));
    test::run(one, 20), test::run(five, 20);
    ASSERT_EQ(five.hash(), one.hash()) << seed;
  }
}

/// Boxes in a trough whose floor and walls are each 0.2 m inside of them.
TEST(Determinism, BodiesPressedByThreeWallsHaveTheSameBitsAtAnyNumberOfThreads) {
  Scene scene;
  const auto add = [&](const Vec3& half, const Vec3& position, Motion motion) {
    BodyDef& body = scene.bodies.emplace_back();
    body.shape = Shape::box(half), body.position = position, body.motion = motion;
  };
  add({100, 1, 1}, {0, 0, -1.3}, Motion::Static);
  for (const double side : {-1.3, 1.3}) add({100, 1, 2}, {0, side, 0}, Motion::Static);
  for (int k = 0; k < 63; ++k) add({.5, .5, .5}, {1.1 * k - 34, 0, 0}, Motion::Dynamic);
  const auto hashAt = [&](int threads) {
    World world(scene, test::options(4, "cpu", threads));
    test::run(world, 10);
    return world.hash();
  };
  const std::uint64_t one = hashAt(1);
  for (const int threads : {2, 5, 7}) EXPECT_EQ(hashAt(threads), one) << threads;
}

TEST(Determinism, TheReferenceHasTheSameBitsAtAnyNumberOfThreads) {
  EXPECT_EQ(hashes(3, "reference"), hashes(1, "reference"));
}

TEST(Determinism, LockstepFindsNoDifferenceAndHasTheBitsOfTheCpu) {
  World lockstep(test::heap(8), test::options(4, "lockstep", 3)),
      cpu(test::heap(8), test::options(4, "cpu", 1));
  for (int i = 0; i < kManySteps; ++i) {
    lockstep.step(), cpu.step();
    ASSERT_EQ(lockstep.firstDifference(), "") << i;
  }
  EXPECT_EQ(lockstep.hash(), cpu.hash());
}

TEST(Determinism, EditsWhileRunningKeepTheBits) {
  const auto run = [](int threads) {
    World world(test::heap(4), test::options(4, "cpu", threads));
    test::run(world, 30);
    world.removeBody(world.bodyAt(5));
    world.removeBody(world.bodyAt(9));
    for (int i = 0; i < 10; ++i) {
      world.addBody(test::unitCube({.2 * i, 0, 6. + 1.2 * i}));
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

/// Two engines with the same falling cubes.
class Lockstep : public ::testing::Test {
 protected:
  static constexpr int kBodies = 300;

  Lockstep() {
    settings_.gravity = {0, 0, -10};
    lockstep_.configure(settings_);
    const Shape cube = Shape::box({.5, .5, .5});
    const CookedShape cooked = cook(cube);
    for (int i = 0; i < kBodies; ++i) {
      EngineBody body;
      body.kind = 3;
      body.shape = cooked.shape, body.radius = cooked.radius;
      const MassProperties mass = massProperties(cube, 1);
      body.mass = mass.mass, body.inertia = mass.inertia;
      body.state.position = {1. * (i % 10), 1. * (i / 10 % 10), 1. * (i / 100)};
      body.state.velocity = {0, 0, i >= 100 ? -1. : 0.};
      static_cast<Engine&>(lockstep_).apply(SetBody{i, body});
    }
  }

  std::string step() {
    StepReport report;
    report.step = step_++;
    lockstep_.step(report);
    return report.difference;
  }
  /// A step whose settings in the second engine are others.
  template <class Change> std::string stepWith(Change&& change) {
    EngineSettings other = settings_;
    change(other);
    b_->configure(other);
    return step();
  }
  SolverData& b() { return b_->tables().view(); }

  CpuEngine* const b_ = new CpuEngine({.threads = 2, .timings = false});
  LockstepEngine lockstep_{std::make_unique<CpuEngine>(CpuOptions{.threads = 1, .timings = false}),
                           std::unique_ptr<CpuEngine>(b_)};
  EngineSettings settings_;
  int step_ = 0;
};

/// A compiler's fault: behind an array of more than 64 bytes members were cleared as padding.
TEST(CleanCopy, ClearsPaddingAndNothingElse) {
  struct Point {
    double x = 0, y = 0, z = 0;
  };
  struct Element {
    Point point[3];
    int head = 0;
    double tail[8] = {};
    char last = 0;
  } element;
  std::memset(static_cast<void*>(&element), 0x5a, sizeof element);
  std::vector<std::byte> copy(sizeof element);
  copyClean(copy.data(), &element, sizeof element);
  const auto mask = valueMask<Element>();
  for (std::size_t i = 0; i < sizeof element; ++i) {
    const bool isPadding = (i >= offsetof(Element, head) + sizeof(int) && i < offsetof(Element, tail)) ||
                           i > offsetof(Element, last);
    EXPECT_EQ(copy[i], isPadding ? std::byte{0} : std::byte{0x5a}) << i;
    EXPECT_EQ(mask[i], isPadding ? std::byte{0} : std::byte{0xff}) << i;
  }
}

/// What compilers without __builtin_clear_padding clear, on records with much of it.
TEST(CleanCopy, ClearsTheSamePaddingWithEveryCompiler) {
  using namespace RUBBLE_CORE;
  const auto check = []<class T>(const T*) {
    std::vector<std::byte> ones(sizeof(T), std::byte{0xff}), copy(sizeof(T));
    alignas(T) std::byte element[sizeof(T)];
    std::memcpy(element, ones.data(), sizeof(T));
    copyClean(copy.data(), reinterpret_cast<const T*>(element), sizeof(T));
    const auto mask = valueMask<T>();
    EXPECT_TRUE(std::equal(mask.begin(), mask.end(), copy.begin()));
    EXPECT_TRUE(std::ranges::count(mask, std::byte{0}) > 0);
  };
  check(static_cast<const Joint<HingeJoint>*>(nullptr)),
      check(static_cast<const JointSpec<BallJoint>*>(nullptr));
  check(static_cast<const Tetrahedron*>(nullptr)), check(static_cast<const Attachment*>(nullptr));
}

TEST_F(Lockstep, FindsNothingWhereThereIsNothing) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(step(), "");
}

TEST_F(Lockstep, NamesStepTableAndElementOfAPlantedDifference) {
  EXPECT_EQ(step(), "");
  b().color[7] += 1;
  EXPECT_EQ(step(),
            "step 1, stage bounds, kernel ComputeBounds, table color, element 7, byte 0: 00000001 beside "
            "00000002");
}

TEST_F(Lockstep, NamesTheKernelThatFirstDiffers) {
  // gravity is no table: the inertial targets are the first to see it
  const std::string found = stepWith([](EngineSettings& s) { s.gravity.z = -9; });
  EXPECT_TRUE(
      found.starts_with("step 0, stage predict, kernel PredictBodies, table target, element 0, byte "))
      << found;
}

TEST_F(Lockstep, NamesADifferenceInTheSolveByItsBody) {
  EXPECT_EQ(step(), "");
  // the second step begins with other multipliers
  const std::string found = stepWith([](EngineSettings& s) { s.params.tuning.warmStartDecay = .5; });
  EXPECT_NE(found.find("step 1, stage "), std::string::npos) << found;
  EXPECT_NE(found.find(", table "), std::string::npos) << found;
  EXPECT_NE(found.find(", element "), std::string::npos) << found;
}

TEST_F(Lockstep, NamesKernelsThatOnlyOneRuns) {
  const std::string found = stepWith([](EngineSettings& s) { s.params.tuning.coarseCorrection = false; });
  EXPECT_EQ(found.find("step 0, stage "), 0u) << found;
  EXPECT_NE(found.find(" beside "), std::string::npos) << found;
}

TEST_F(Lockstep, KeepsTheFirstDifference) {
  const std::string first = stepWith([](EngineSettings& s) { s.gravity.z = -9; });
  b().velocity[3].y += 1;
  EXPECT_EQ(step(), first);
}

}  // namespace
}  // namespace RUBBLE_CORE
}  // namespace rubble
