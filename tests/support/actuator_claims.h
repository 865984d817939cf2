#pragma once
/// Claims of actuators in batches of worlds, on any backend.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <rubble/actuators.h>
#include <rubble/worlds.h>

#include "tests/support/scenes.h"

namespace rubble::test {

/// An arm of two hinges that stands on the world, and a box on a floor that can be pulled down.
inline Scene actuatedScene() {
  Scene scene = emptyScene({0, 0, -10});
  for (int i = 0; i < 2; ++i) scene.bodies.push_back(body(Shape::capsule(0.05, 0.2), {0, 0, 2.25 + 0.5 * i}));
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 0, kWorld, {0, 0, 2}));
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 1, 0, {0, 0, 2.5}));
  scene.joints[0].axes[0].driveStiffness = 50, scene.joints[0].axes[0].driveDamping = 5;
  scene.bodies.push_back(unitCube({2, 0, -0.5}));
  scene.bodies[2].motion = Motion::Static;
  scene.bodies.push_back(unitCube({2, 0, 0.5}));
  return scene;
}

/// One of each type.
inline std::vector<ActuatorDef> actuatorsOf() {
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
inline double controlOf(int w, std::size_t actuator, int step) {
  return std::sin(0.1 * step + w) * (actuator == 3 ? 3 : 1) * (actuator == 2 ? 2 : 1);
}
inline void setControls(std::span<double> controls, int w, int step) {
  for (std::size_t k = 0; k < 4; ++k) controls[k] = controlOf(w, k, step);
}
inline std::span<double> rowOf(std::span<double> all, int row) {
  const std::size_t count = actuatorsOf().size();
  return all.subspan(static_cast<std::size_t>(row) * count, count);
}
inline std::vector<double> copyOf(std::span<const double> values) { return {values.begin(), values.end()}; }

/// World w of `all` has the bits of `alone`: states, activations and forces. Advances `stepped`, a World or a
/// batch of one, whose world is `alone`.
template <class Stepped>
void expectActuatorsOf(Stepped& stepped, const World& alone, const Worlds& worlds, Actuators& all, int w,
                       int steps) {
  Actuators own(actuatorsOf(), stepped);
  for (int step = 0; step < steps; ++step) {
    setControls(own.controls(), w, step);
    own.apply(stepped), stepped.step();
  }
  EXPECT_EQ(copyOf(rowOf(all.activations(), w)), copyOf(own.activations())) << w;
  for (std::size_t k = 0; k < own.forces().size(); ++k)
    EXPECT_EQ(all.forces()[static_cast<std::size_t>(w) * own.forces().size() + k], own.forces()[k]) << w;
  for (const BodyId id : alone.bodies()) {
    const BodyState one = alone.state(id), other = worlds[w].state(id);
    EXPECT_EQ(one.position, other.position) << w << ", body " << id.index;
    EXPECT_EQ(one.velocity, other.velocity) << w << ", body " << id.index;
  }
}

/// Worlds of a batch have the bits that they have in a batch of one, and with `asWorld` in a World.
inline void expectActuatorsAlone(const WorldOptions& options, int count, bool asWorld) {
  constexpr int kSteps = 20;
  Worlds worlds(options);
  worlds.addCopies(actuatedScene(), count);
  Actuators all(actuatorsOf(), worlds);
  ASSERT_EQ(all.worlds(), count);
  ASSERT_EQ(all.controls().size(), static_cast<std::size_t>(count) * actuatorsOf().size());
  for (int step = 0; step < kSteps; ++step) {
    for (int w = 0; w < count; ++w) setControls(rowOf(all.controls(), w), w, step);
    all.apply(worlds), worlds.step();
  }
  for (const int w : {0, count / 5, count - 1}) {
    Worlds batch(options);
    batch.addCopies(actuatedScene(), 1);
    expectActuatorsOf(batch, batch[0], worlds, all, w, kSteps);
    if (!asWorld) continue;
    World world(actuatedScene(), options);
    expectActuatorsOf(world, world, worlds, all, w, kSteps);
  }
}

/// Resets set controls and activations to those of the snapshot, also in another world.
inline void expectActuatorsGoBack(const WorldOptions& options) {
  Worlds worlds(options);
  worlds.addCopies(actuatedScene(), 3);
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

}  // namespace rubble::test
