#pragma once
/// A world with bodies added in random order, before and after a sort. The order in memory must not change
/// results.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/scenes.h"

namespace rubble::test {

inline constexpr int kTowers = 5, kTowerHeight = 3;  // towers along each side, cubes of each

/// Towers of cubes, a sensor around some of them and a hanging chain, in random order behind the ground,
/// which is body 0.
inline Scene shuffledTowers() {
  Scene scene = emptyScene();
  for (int x = 0; x < kTowers; ++x)
    for (int y = 0; y < kTowers; ++y)
      for (int z = 0; z < kTowerHeight; ++z) scene.bodies.push_back(unitCube({1.5 * x, 1.5 * y, .5 + z}));
  const int cubes = static_cast<int>(scene.bodies.size()), links = 6;
  for (int i = 0; i < links; ++i) scene.bodies.push_back(body(Shape::sphere(.2), {-4, 0, 8 - .5 * i}));
  scene.bodies.push_back(body(Shape::box({2, 2, 1}), {1, 1, 1}));
  scene.bodies.back().motion = Motion::Static;
  scene.bodies.back().sensor = true;

  std::vector<int> order(scene.bodies.size()), place(scene.bodies.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  Scene out = emptyScene();
  out.bodies.push_back(ground());
  for (const int i : order) {
    place[static_cast<std::size_t>(i)] = static_cast<int>(out.bodies.size());
    out.bodies.push_back(scene.bodies[static_cast<std::size_t>(i)]);
  }
  for (int i = 0; i < links; ++i) {
    const int link = place[static_cast<std::size_t>(cubes + i)];
    out.joints.push_back(i == 0 ? ball(kWorld, {-4, 0, 8.25}, link, {0, 0, .25})
                                : ball(out.joints.back().bodyB, {0, 0, -.25}, link, {0, 0, .25}));
  }
  return out;
}

/// They, so many steps old; then sorted, if it is, and one step older.
inline World towersAfter(const std::string& backend, int steps, bool sorted) {
  World world(shuffledTowers(), options(10, backend));
  run(world, steps);
  if (sorted) world.sortBodies();
  EXPECT_EQ(world.step().sorted, sorted);
  return world;
}

/// The first cubes of the scene, by height: index in Scene::bodies of one whose center is that of course z.
inline int cubeOfCourse(const Scene& scene, int z, int skip = 0) {
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const BodyDef& b = scene.bodies[i];
    if (b.shape.type == ShapeType::Box && !b.sensor && std::fabs(b.position.z - (.5 + z)) < .1 && skip-- == 0)
      return static_cast<int>(i);
  }
  return -1;
}

/// Largest distance of the places of a body in two worlds [m].
inline double apart(const World& a, const World& b) {
  double most = 0;
  for (const BodyId id : a.bodies())
    most = std::max(most, length(a.state(id).position - b.state(id).position));
  return most;
}

}  // namespace rubble::test
