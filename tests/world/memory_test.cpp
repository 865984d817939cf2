/// A step that cannot allocate its tables throws Error, and the world stays usable.
#include <gtest/gtest.h>

#include <fstream>

#if defined(__linux__)

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/support/sanitizer.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

/// Large blocks go back to the system when they are freed, from the first test of the program on: none is
/// found again under the limit.
[[maybe_unused]] const int kLargeBlocksGoBack = mallopt(M_MMAP_THRESHOLD, 1 << 17);

/// The address space of this program may grow by so many bytes while it lives.
class LittleMemory {
 public:
  explicit LittleMemory(std::size_t more) {
    getrlimit(RLIMIT_AS, &limit_);
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlimit low{pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + more, limit_.rlim_max};
    setrlimit(RLIMIT_AS, &low);
  }
  ~LittleMemory() { setrlimit(RLIMIT_AS, &limit_); }

 private:
  rlimit limit_{};
};

class OutOfMemory : public ::testing::TestWithParam<const char*> {
 protected:
  static constexpr int kSide = 24;
  void SetUp() override {
#if defined(RUBBLE_HAS_SANITIZER)
    GTEST_SKIP() << "the sanitizer needs an address space without bound";
#endif
    const LittleMemory little(1 << 20);
    constexpr std::size_t kMuch = 1 << 28;  // many times what the limit leaves
    void* const much = mmap(nullptr, kMuch, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (much == MAP_FAILED) return;
    munmap(much, kMuch);
    GTEST_SKIP() << "this system, an emulator, does not bound the address space";
  }
  /// Balls far from one another.
  World apart() const {
    Scene scene = test::emptyScene();
    for (int i = 0; i < kSide * kSide * kSide; ++i)
      scene.bodies.push_back(test::body(Shape::sphere(.5), {3. * i, 0, 0}));
    World world(scene, test::options(2, GetParam()));
    test::run(world, 2);
    return world;
  }
  /// The same in a block, each in touch with six others.
  static void bringTogether(World& world) {
    std::vector<BodyState> states;
    for (int i = 0; i < kSide * kSide * kSide; ++i)
      states.push_back(
          {{.99 * (i % kSide), .99 * (i / kSide % kSide), .99 * (i / (kSide * kSide))}, {}, {}, {}});
    world.setStates(world.bodies(), states);
  }
};

TEST_P(OutOfMemory, InAStepIsAnErrorAfterWhichItCanBeTakenAgain) {
  World world = apart(), other = apart();
  bringTogether(world), bringTogether(other);
  const std::uint64_t before = world.hash();
  const std::int64_t steps = world.stepCount();
  for (int tries = 0; tries < 3; ++tries) {
    const LittleMemory little(1 << 20);
    try {
      world.step();
      FAIL() << "there was enough";
    } catch (const Error& error) {
      EXPECT_EQ(error.path(), "step");
    }
    EXPECT_EQ(world.stepCount(), steps);
  }
  EXPECT_EQ(world.hash(), before) << "no body was in touch before";
  const Snapshot snapshot = world.snapshot();
  EXPECT_TRUE(world.contacts().empty());
  world.step(), other.step();
  EXPECT_GT(world.contacts().size(), 3u * (kSide - 1) * kSide * kSide - 1);
  EXPECT_EQ(world.hash(), other.hash());
  world.restore(snapshot);
  EXPECT_EQ(world.hash(), before);
}

TEST_P(OutOfMemory, AmongContactsForgetsThemAndNothingElse) {
  // half of them in touch already, so that there are contacts to lose
  World world = apart();
  bringTogether(world);
  test::run(world, 2);
  world.reserve("colors", 1000);
  const std::vector<BodyId> ids = world.bodies();
  // nearer to one another: many more pairs
  std::vector<BodyState> states;
  for (const BodyId id : ids) {
    BodyState state = world.state(id);
    state.position *= .55;
    states.push_back(state);
  }
  world.setStates(ids, states);
  std::vector<Vec3> places;
  for (const BodyId id : ids) places.push_back(world.state(id).position);
  {
    const LittleMemory little(1 << 20);
    EXPECT_THROW(world.step(), Error);
  }
  for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(world.state(ids[i]).position, places[i]);
  EXPECT_NE(world.hash(), 0u);
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_GT(world.step().contacts, 0);
}

INSTANTIATE_TEST_SUITE_P(Backends, OutOfMemory, ::testing::Values("cpu", "reference"));

}  // namespace
}  // namespace rubble

#endif
