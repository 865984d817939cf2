/// Actuators in batches of worlds, and in snapshots.
#include "tests/support/actuator_claims.h"

namespace rubble {
namespace {

using test::actuatedScene, test::actuatorsOf, test::copyOf, test::options, test::setControls;

TEST(ActuatorsOfWorlds, HaveInEachWorldTheBitsThatTheyHaveAlone) {
  test::expectActuatorsAlone(options(4, "cpu"), 35, true);  // more than one engine of a processor holds
}
TEST(ActuatorsOfWorlds, GoBackWithTheSnapshotsOfTheirWorlds) {
  test::expectActuatorsGoBack(options(4, "cpu"));
}

TEST(ActuatorsOfWorlds, LeaveWorldsAloneThatAreNotActive) {
  Worlds worlds(options(4, "cpu"));
  worlds.addCopies(actuatedScene(), 3);
  Actuators some(actuatorsOf(), worlds, 1);
  ASSERT_EQ(some.worlds(), 2);
  std::ranges::fill(some.controls(), 1);
  const std::vector<double> before = copyOf(some.activations());
  const std::vector<char> active{1, 0, 1};
  some.apply(worlds, active);
  EXPECT_TRUE(std::equal(before.begin(), before.begin() + 5, some.activations().begin()));
  EXPECT_FALSE(std::equal(before.begin() + 5, before.end(), some.activations().begin() + 5));
  worlds.step(1, active);
  EXPECT_EQ(worlds[0].definition(worlds[0].joints()[0]).axes[0].targetPosition, 0);
  EXPECT_EQ(worlds[1].definition(worlds[1].joints()[0]).axes[0].targetPosition, 0);
  EXPECT_EQ(worlds[2].definition(worlds[2].joints()[0]).axes[0].targetPosition, 1);
}

TEST(Actuators, GoOnFromTheBytesOfASnapshot) {
  World world(actuatedScene(), options(4, "cpu"));
  Actuators own(actuatorsOf(), world);
  const auto advance = [&](int from, int to) {
    for (int step = from; step < to; ++step) {
      setControls(own.controls(), 0, step);
      own.apply(world), world.step();
    }
  };
  advance(0, 8);
  const std::vector<std::byte> bytes = world.snapshot().bytes();
  advance(8, 16);
  const std::vector<double> end = copyOf(own.activations());
  const std::uint64_t hash = world.hash();
  World next(actuatedScene(), options(4, "cpu"));
  Actuators loaded(actuatorsOf(), next);
  next.restore(Snapshot::fromBytes(bytes));
  std::swap(world, next), std::swap(own, loaded);
  advance(8, 16);
  EXPECT_EQ(copyOf(own.activations()), end);
  EXPECT_EQ(world.hash(), hash);
}

TEST(ActuatorsOfWorlds, NameWhatTheyCannotActOn) {
  Worlds worlds(options(4, "cpu"));
  worlds.addCopies(actuatedScene(), 2);
  World world(actuatedScene(), options(4, "cpu"));
  EXPECT_THROW(Actuators(actuatorsOf(), worlds, 3), Error);
  EXPECT_THROW(Actuators(actuatorsOf(), worlds, 1, 2), Error);
  Actuators all(actuatorsOf(), worlds), one(actuatorsOf(), world);
  EXPECT_THROW(all.apply(world), Error);
  EXPECT_THROW(one.apply(worlds), Error);
  EXPECT_THROW(all.apply(worlds, std::vector<char>{1}), Error);
  all.controls()[7] = std::nan("");
  EXPECT_THROW(all.apply(worlds), Error);
}

}  // namespace
}  // namespace rubble
