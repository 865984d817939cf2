#pragma once
/// Small scenes for tests of whole steps. z is up and gravity is 10 unless said otherwise.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <rubble/rubble.h>

namespace rubble::test {

inline constexpr double kGravity = 10;  ///< of emptyScene() [m/s2]
inline constexpr double kDt = 1. / 60;  ///< step of Params [s]

inline Scene emptyScene(const Vec3& gravity = {0, 0, -kGravity}) {
  Scene scene;
  scene.gravity = gravity;
  return scene;
}

inline BodyDef body(const Shape& shape, const Vec3& position, double friction = .6) {
  BodyDef def;
  def.shape = shape;
  def.position = position;
  def.material.staticFriction = def.material.dynamicFriction = friction;
  return def;
}

/// A cube of edge 1 m and 1 kg.
inline BodyDef unitCube(const Vec3& position, double friction = .6) {
  BodyDef def = body(Shape::box({.5, .5, .5}), position, friction);
  def.mass = 1;
  return def;
}

inline BodyDef ground(double friction = .6) {
  BodyDef def = body(Shape::plane(), {}, friction);
  def.motion = Motion::Static;
  return def;
}

inline JointDef ball(int a, const Vec3& anchorA, int b, const Vec3& anchorB) {
  JointDef joint;
  joint.bodyA = a, joint.bodyB = b;
  joint.anchorA = anchorA, joint.anchorB = anchorB;
  return joint;
}

/// A column of unit cubes on the ground; body 0 is the ground.
inline Scene tower(int height) {
  Scene scene = emptyScene();
  scene.bodies.push_back(ground());
  for (int i = 0; i < height; ++i) scene.bodies.push_back(unitCube({0, 0, .5 + i}));
  return scene;
}

/// A loose heap of boxes, spheres and capsules that falls on the ground, with a chain in it.
inline Scene heap(int layers) {
  Scene scene = emptyScene();
  scene.bodies.push_back(ground());
  for (int z = 0; z < layers; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) {
        const int kind = (x + 2 * y + 3 * z) % 4;
        const Shape shape = kind == 0   ? Shape::sphere(.3)
                            : kind == 1 ? Shape::capsule(.2, .25)
                                        : Shape::box({.3, .25, .2});
        BodyDef def = body(shape, {.7 * x + .05 * z, .7 * y - .03 * z, .5 + .8 * z});
        def.orientation = fromAxisAngle(normalize(Vec3{1., .3 * x, .2 * y}), .4 * (x + y + z));
        scene.bodies.push_back(def);
      }
  for (int i = 1; i < 4; ++i) scene.joints.push_back(ball(4 * i + 1, {.35, 0, 0}, 4 * i + 2, {-.35, 0, 0}));
  return scene;
}

inline WorldOptions options(int iterations = 10, const std::string& backend = "cpu", int threads = 1) {
  WorldOptions out;
  out.backend = backend;
  out.threads = threads;
  out.params.iterations = iterations;
  return out;
}

/// Steps a world so many times; returns the last report.
inline StepReport run(World& world, int steps) {
  StepReport report;
  for (int i = 0; i < steps; ++i) report = world.step();
  return report;
}

/// World::hash() after each of `steps` steps, with `before` called before each of them.
inline std::vector<std::uint64_t> hashes(World& world, int steps, const std::function<void()>& before = {}) {
  std::vector<std::uint64_t> out;
  for (int i = 0; i < steps; ++i) {
    if (before) before();
    world.step();
    out.push_back(world.hash());
  }
  return out;
}

/// Largest distance of any body between two worlds of one scene, over `steps` [m].
inline double worstDistance(const Scene& scene, const WorldOptions& a, const WorldOptions& b, int steps) {
  World first(scene, a), second(scene, b);
  double worst = 0;
  for (int i = 0; i < steps; ++i) {
    first.step(), second.step();
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
      const BodyId id = first.bodyAt(static_cast<int>(k));
      worst = std::max(worst, length(first.state(id).position - second.state(id).position));
    }
  }
  return worst;
}

}  // namespace rubble::test
