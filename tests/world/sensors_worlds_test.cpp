/// Sensors of a scene in batches of worlds.
#include <gtest/gtest.h>
#include <rubble/sensors.h>

#include "tests/support/sensor_claims.h"

namespace rubble {
namespace {

TEST(SensorsOfWorlds, HaveInEachWorldTheReadingsThatTheyHaveAlone) {
  for (const char* backend : {"cpu", "reference"})
    test::expectSensorsAlone(test::worldsOptions(backend, 2),
                             35);  // more than one engine of a processor holds
}

TEST(SensorsOfWorlds, KeepReadingsOfWorldsThatAreNotActive) {
  Worlds worlds(test::worldsOptions());
  worlds.addCopies(test::sensedScene(), 3);
  Sensors some(test::sensorsOfScene(), worlds, 1);
  ASSERT_EQ(some.worlds(), 2);
  ASSERT_EQ(some.values().size(), 2 * some.width());
  worlds.step(1);
  some.update(worlds, std::vector<char>{1, 0, 1});
  for (const double value : some.values().first(some.width())) EXPECT_EQ(value, 0);
  EXPECT_NEAR(some.values(0, 1)[2], worlds[2].state(worlds[2].bodyAt(1)).position.z, 1e-6);
}

TEST(SensorsOfWorlds, NameWhatTheyCannotMeasure) {
  Worlds worlds(test::worldsOptions());
  worlds.addCopies(test::sensedScene(), 2);
  World world(test::sensedScene(), test::worldsOptions());
  EXPECT_THROW(Sensors(test::sensorsOfScene(), worlds, 3), Error);
  EXPECT_THROW(Sensors(test::sensorsOfScene(), worlds, 1, 2), Error);
  Sensors all(test::sensorsOfScene(), worlds), one(test::sensorsOfScene(), world);
  EXPECT_THROW(all.update(world), Error);
  EXPECT_THROW(one.update(worlds), Error);
  EXPECT_THROW(all.update(worlds, std::vector<char>{1}), Error);
  EXPECT_THROW(all.values(0, 2), Error);
}

}  // namespace
}  // namespace rubble
