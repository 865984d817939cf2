#pragma once
/// Claims of sensors of many worlds, on any backend.
#include <gtest/gtest.h>
#include <rubble/sensors.h>

#include "tests/support/worlds_claims.h"

namespace rubble::test {

/// A ground, an arm on a hinge, and a crate that falls beside it.
inline Scene sensedScene() {
  Scene scene = emptyScene({0, 0, -10});
  scene.bodies.push_back(ground());
  scene.bodies.push_back(body(Shape::box({0.5, 0.1, 0.1}), {0.5, 0, 2}));
  scene.bodies.push_back(body(Shape::box({0.5, 0.5, 0.5}), {4, 0, 0.52}));
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 1, kWorld, {0, 0, 2}));
  return scene;
}

inline std::vector<SensorDef> sensorsOfScene() {
  std::vector<SensorDef> all;
  for (const SensorType type :
       {SensorType::Position, SensorType::Acceleration, SensorType::AngularRate, SensorType::LinearVelocity,
        SensorType::Range, SensorType::Force, SensorType::Torque, SensorType::JointPosition,
        SensorType::JointSpeed, SensorType::Time}) {
    SensorDef& sensor = all.emplace_back();
    sensor.type = type, sensor.body = 1, sensor.joint = 0, sensor.position = {0.25, 0, 0};
    if (type == SensorType::Range) sensor.orientation = {0, 0, 1, 0};  // downward
  }
  SensorDef& touch = all.emplace_back();
  touch.type = SensorType::Touch, touch.body = 2, touch.volume = Shape::sphere(1), touch.cutoff = 1e4;
  return all;
}

/// World i differs from the others, and reads what it reads alone.
inline void expectSensorsAlone(const WorldOptions& options, int count) {
  const auto change = [](World& world, int w) {
    world.setVelocity(world.bodyAt(2), {0.25 * w, 0, 0}, {0, 0.5, 0});
    world.setMass(world.bodyAt(1), 1 + w);
  };
  Worlds worlds(options);
  worlds.addCopies(sensedScene(), count);
  for (int w = 0; w < count; ++w) change(worlds[w], w);
  Sensors all(sensorsOfScene(), worlds);
  ASSERT_EQ(all.worlds(), count);
  constexpr int kSteps = 40;
  for (int k = 0; k < kSteps; ++k) worlds.step(1), all.update(worlds);
  bool touched = false, near = false;
  for (const int w : {0, 1, count - 1}) {
    Worlds batch(options);
    const bool isBatch = options.backend == "cuda";  // there a world alone is a batch of one
    if (isBatch) batch.add(sensedScene());
    World single(sensedScene(), options);
    World& world = isBatch ? batch[0] : single;
    change(world, w);
    Sensors own = isBatch ? Sensors(sensorsOfScene(), batch) : Sensors(sensorsOfScene(), world);
    for (int k = 0; k < kSteps; ++k) {
      if (isBatch)
        batch.step(1), own.update(batch);
      else
        world.step(), own.update(world);
    }
    for (std::size_t i = 0; i < own.definitions().size(); ++i) {
      const std::span<const double> there = all.values(i, w), here = own.values(i);
      EXPECT_TRUE(std::equal(there.begin(), there.end(), here.begin(), here.end()))
          << "world " << w << ", sensor " << keyword(own.definitions()[i].type);
    }
    near |= own.values(4)[0] > 0, touched |= own.values(10)[0] > 1;
  }
  EXPECT_TRUE(near) << "a ray meets the ground";
  EXPECT_TRUE(touched) << "the crate stands";
}

}  // namespace rubble::test
