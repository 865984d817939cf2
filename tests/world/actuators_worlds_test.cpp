/// Actuators in batches of worlds, and in snapshots.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <rubble/actuators.h>
#include <rubble/worlds.h>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::options;

/// An arm of two hinges that stands on the world, and a box on a floor that can be pulled down.
Scene machine() {
  Scene scene = test::emptyScene({0, 0, -10});
  for (int i = 0; i < 2; ++i)
    scene.bodies.push_back(test::body(Shape::capsule(0.05, 0.2), {0, 0, 2.25 + 0.5 * i}));
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 0, kWorld, {0, 0, 2}));
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 1, 0, {0, 0, 2.5}));
  scene.joints[0].axes[0].driveStiffness = 50, scene.joints[0].axes[0].driveDamping = 5;
  scene.bodies.push_back(test::unitCube({2, 0, -0.5}));
  scene.bodies[2].motion = Motion::Static;
  scene.bodies.push_back(test::unitCube({2, 0, 0.5}));
  return scene;
}

/// One of each type.
std::vector<ActuatorDef> actuatorsOf() {
  std::vector<ActuatorDef> out(5);
  out[0].type = ActuatorType::Position, out[0].joint = 0;
  out[1].type = ActuatorType::Muscle, out[1].joint = 1, out[1].offset = 0.75, out[1].gear = 0.1;
  out[1].muscle.peakForce = 40, out[1].dynamics = ActuatorDynamics::Muscle, out[1].activation = 0.1;
  out[2].joint = 1, out[2].dynamics = ActuatorDynamics::Filter, out[2].timeConstant = 0.2;
  out[3].type = ActuatorType::Wrench, out[3].body = 1, out[3].force = {1, 0, 0};
  out[3].dynamics = ActuatorDynamics::Integrator, out[3].activation = 0.3;
  out[4].type = ActuatorType::Adhesion, out[4].body = 3, out[4].gain = {20, 0, 0}, out[4].control = 1;
  return out;
}

/// Control of an actuator of world w in a step.
double controlOf(int w, std::size_t actuator, int step) {
  return std::sin(0.1 * step + w) * (actuator == 3 ? 3 : 1) * (actuator == 2 ? 2 : 1);
}
void setControls(std::span<double> controls, int w, int step) {
  for (std::size_t k = 0; k < 4; ++k) controls[k] = controlOf(w, k, step);
}
std::span<double> rowOf(std::span<double> all, int row) {
  const std::size_t count = actuatorsOf().size();
  return all.subspan(static_cast<std::size_t>(row) * count, count);
}
std::vector<double> copyOf(std::span<const double> values) { return {values.begin(), values.end()}; }

TEST(ActuatorsOfWorlds, HaveInEachWorldTheBitsThatTheyHaveAlone) {
  constexpr int kWorlds = 35, kSteps = 20;  // more than one engine of a processor holds
  Worlds worlds(options(4, "cpu"));
  worlds.addCopies(machine(), kWorlds);
  Actuators all(actuatorsOf(), worlds);
  ASSERT_EQ(all.worlds(), kWorlds);
  ASSERT_EQ(all.controls().size(), kWorlds * actuatorsOf().size());
  for (int step = 0; step < kSteps; ++step) {
    for (int w = 0; w < kWorlds; ++w) setControls(rowOf(all.controls(), w), w, step);
    all.apply(worlds), worlds.step();
  }
  for (const int w : {0, 7, 34}) {
    World alone(machine(), options(4, "cpu"));
    Actuators own(actuatorsOf(), alone);
    for (int step = 0; step < kSteps; ++step) {
      setControls(own.controls(), w, step);
      own.apply(alone), alone.step();
    }
    EXPECT_EQ(copyOf(rowOf(all.activations(), w)), copyOf(own.activations())) << w;
    for (std::size_t k = 0; k < own.forces().size(); ++k)
      EXPECT_EQ(all.forces()[static_cast<std::size_t>(w) * own.forces().size() + k], own.forces()[k]) << w;
    for (std::size_t b = 0; b < alone.bodies().size(); ++b) {
      const BodyState one = alone.state(alone.bodies()[b]), other = worlds[w].state(worlds[w].bodies()[b]);
      EXPECT_EQ(one.position, other.position) << w << ", body " << b;
      EXPECT_EQ(one.velocity, other.velocity) << w << ", body " << b;
    }
  }
}

TEST(ActuatorsOfWorlds, LeaveWorldsAloneThatAreNotActive) {
  Worlds worlds(options(4, "cpu"));
  worlds.addCopies(machine(), 3);
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

TEST(ActuatorsOfWorlds, GoBackWithTheSnapshotsOfTheirWorlds) {
  Worlds worlds(options(4, "cpu"));
  worlds.addCopies(machine(), 3);
  const Snapshot unaware = worlds[0].snapshot();
  Actuators all(actuatorsOf(), worlds);
  const auto advance = [&](int steps) {
    for (int step = 0; step < steps; ++step) {
      for (int w = 0; w < 3; ++w) setControls(rowOf(all.controls(), w), w, step);
      all.apply(worlds), worlds.step();
    }
  };
  advance(5);
  const Snapshot middle = worlds[1].snapshot();
  const std::vector<double> activations = copyOf(rowOf(all.activations(), 1)),
                            controls = copyOf(rowOf(all.controls(), 1));
  advance(10);
  const std::vector<double> end = copyOf(rowOf(all.activations(), 1)),
                            other = copyOf(rowOf(all.activations(), 0));
  ASSERT_NE(end, activations);
  // into its own world and into another one
  worlds.reset(std::vector{1, 2}, std::vector{middle});
  for (const int w : {1, 2}) {
    EXPECT_EQ(copyOf(rowOf(all.activations(), w)), activations) << w;
    EXPECT_EQ(copyOf(rowOf(all.controls(), w)), controls) << w;
  }
  EXPECT_EQ(copyOf(rowOf(all.activations(), 0)), other);
  advance(10);
  EXPECT_EQ(copyOf(rowOf(all.activations(), 1)), end);
  // a snapshot that was taken before they were made
  worlds.reset(std::vector{0}, std::vector{unaware});
  for (std::size_t k = 0; k < actuatorsOf().size(); ++k) {
    EXPECT_EQ(all.activations()[k], actuatorsOf()[k].activation) << k;
    EXPECT_EQ(all.controls()[k], actuatorsOf()[k].control) << k;
  }
}

TEST(Actuators, GoOnFromTheBytesOfASnapshot) {
  World world(machine(), options(4, "cpu"));
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
  World next(machine(), options(4, "cpu"));
  Actuators loaded(actuatorsOf(), next);
  next.restore(Snapshot::fromBytes(bytes));
  std::swap(world, next), std::swap(own, loaded);
  advance(8, 16);
  EXPECT_EQ(copyOf(own.activations()), end);
  EXPECT_EQ(world.hash(), hash);
}

TEST(ActuatorsOfWorlds, NameWhatTheyCannotActOn) {
  Worlds worlds(options(4, "cpu"));
  worlds.addCopies(machine(), 2);
  World world(machine(), options(4, "cpu"));
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
