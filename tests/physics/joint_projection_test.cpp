/// Joint projection moves bodies, but not into what they touch.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::Random;

/// Two thin bodies of up to 100 times one another's mass, joined, that are thrown at the ground.
Scene thrownPair(Random& random, bool onPlane) {
  constexpr std::array kTypes = {JointType::Ball, JointType::Fixed, JointType::Hinge, JointType::Universal,
                                 JointType::SwingTwist};
  Scene scene = test::emptyScene({0, 0, -10});
  BodyDef floor = test::body(onPlane ? Shape::plane() : Shape::box({5, 5, .5}), {0, 0, onPlane ? 0 : -.5});
  floor.motion = Motion::Static;
  scene.bodies.push_back(floor);
  const double size = random.logUniform(.01, .2), speed = random.uniform(2, 20);
  const double spin = random.logUniform(1, 50);
  for (int k = 0; k < 2; ++k) {
    const double own = size * random.uniform(.3, 1);
    const Vec3 half = own / 2 * Vec3{1, random.uniform(.15, 1), random.uniform(.1, .4)};
    BodyDef def = test::body(Shape::box(half), {1.2 * size * k, 0, 1.5 * size + random.uniform(0, 1)});
    def.position.z = k == 0 ? def.position.z : scene.bodies.back().position.z;
    def.orientation = random.rotation();
    def.density = 1000 * random.logUniform(.1, 10);
    def.velocity = {random.uniform(-1, 1), random.uniform(-1, 1), -speed};
    def.angularVelocity = spin * random.direction();
    scene.bodies.push_back(def);
  }
  const Vec3 point = (scene.bodies[1].position + scene.bodies[2].position) * .5;
  const JointType type = kTypes[static_cast<std::size_t>(random.below(static_cast<int>(kTypes.size())))];
  scene.joints.push_back(jointAt(scene, type, 1, 2, point, random.rotation()));
  return scene;
}

TEST(JointProjection, PushesNoneThroughTheGround) {
  for (int seed = 0; seed < 400; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const double dt = random.below(2) ? 1. / 60 : 1. / 30;
    WorldOptions o = test::options(random.below(2) ? 4 : 10);
    o.params.dt = dt;
    World world(thrownPair(random, random.below(2) == 0), o);
    double lowest = 0;
    for (int i = 0; i < static_cast<int>(std::lround(2 / dt)); ++i) {
      world.step();
      for (int k = 1; k <= 2; ++k) lowest = std::min(lowest, world.state(world.bodyAt(k)).position.z);
    }
    EXPECT_EQ(lowest, 0) << "seed " << seed;
  }
}

}  // namespace
}  // namespace rubble
