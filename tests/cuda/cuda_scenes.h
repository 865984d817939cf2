#pragma once
/// Small scenes for the tests of the CUDA backend, and comparisons of two worlds.
#include "tests/cuda/cuda_test.h"
#include "tests/support/scenes.h"

namespace rubble::test {

inline WorldOptions optionsFor(const std::string& backend) {
  WorldOptions options;
  options.backend = backend;
  options.params.iterations = 4;
  return options;
}

inline BodyDef boxAt(const Vec3& position, double halfEdge = .5) {
  BodyDef box;
  box.shape = Shape::box({halfEdge, halfEdge, halfEdge});
  box.position = position;
  return box;
}

inline Scene plane() {
  Scene scene;
  BodyDef plane;
  plane.motion = Motion::Static;
  plane.shape = Shape::plane();
  scene.bodies.push_back(plane);
  return scene;
}

/// Bricks in layers of width x width that overlap those below by half a brick, resting on a plane.
inline Scene brickPile(int width, int height) {
  Scene scene = plane();
  for (int k = 0; k < height; ++k)
    for (int i = 0; i < width; ++i)
      for (int j = 0; j < width; ++j)
        scene.bodies.push_back(boxAt({i + .5 * (k % 2), j + .5 * (k / 2 % 2), k + .5}));
  return scene;
}

/// A pile that a fast ball runs into, beside a chain of balls on joints and a capsule that rolls.
inline Scene mixedScene() {
  Scene scene = brickPile(4, 6);
  BodyDef ball;
  ball.shape = Shape::sphere(1);
  ball.position = {-6, 1.5, 2};
  ball.velocity = {20, 0, 0};
  scene.bodies.push_back(ball);
  BodyDef capsule;
  capsule.shape = Shape::capsule(.3, .5);
  capsule.position = {0, -4, .35};
  capsule.velocity = {1, 0, 0};
  scene.bodies.push_back(capsule);
  int last = kWorld;
  for (int i = 0; i < 6; ++i) {
    BodyDef link;
    link.shape = Shape::sphere(.2);
    link.position = {12.0 + i, 0, 8};
    scene.bodies.push_back(link);
    JointDef joint;
    joint.type = i % 2 ? JointType::Fixed : JointType::Ball;
    joint.bodyA = static_cast<int>(scene.bodies.size()) - 1;
    joint.bodyB = last;
    joint.anchorA = {-.5, 0, 0};
    joint.anchorB = last == kWorld ? Vec3{11.5, 0, 8} : Vec3{.5, 0, 0};
    scene.joints.push_back(joint);
    last = joint.bodyA;
  }
  return scene;
}

/// Largest distance [m] between the two places of a body.
inline double distance(const World& a, const World& b) {
  double largest = 0;
  for (const BodyId id : a.bodies()) {
    const double d = length(a.state(id).position - b.state(id).position);
    if (!(d <= largest)) largest = d;
  }
  return largest;
}

/// Every state of every body, bit for bit.
inline testing::AssertionResult sameStates(const World& a, const World& b) {
  for (const BodyId id : a.bodies()) {
    const BodyState s = a.state(id), t = b.state(id);
    if (s.position != t.position || s.orientation != t.orientation || s.velocity != t.velocity ||
        s.angularVelocity != t.angularVelocity)
      return testing::AssertionFailure()
             << "body " << id.index << " differs by " << length(s.position - t.position) << " m";
  }
  return testing::AssertionSuccess();
}

}  // namespace rubble::test
