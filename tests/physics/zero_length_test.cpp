/// Distance joints, ropes and springs whose anchors coincide at rest: a distance of zero has no direction,
/// and no energy may come from that.
#include <gtest/gtest.h>

#include <array>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using namespace test;

Scene coupled(JointType type, double stiffness) {
  Scene scene = emptyScene({0, 0, 0});
  for (const int i : {0, 1}) {
    BodyDef def = body(Shape::box({.2, .1, .15}), {0, 0, .5 * i});
    def.mass = 1 + i;
    def.velocity = {6. * i - 3, .5 * i, 1. * i}, def.angularVelocity = {1. * i, 4, 2};
    def.filter.mask = 0;
    scene.bodies.push_back(def);
  }
  JointDef joint;
  joint.type = type, joint.bodyA = 0, joint.bodyB = 1;
  joint.anchorA = {0, 0, .25}, joint.anchorB = {0, 0, -.25};
  joint.stiffness = stiffness;
  scene.joints.push_back(joint);
  return scene;
}

/// Largest sum of kinetic and elastic energy in three seconds, over that at the start.
double largestEnergy(JointType type, double stiffness, double dt, int iterations) {
  WorldOptions how = options(iterations);
  how.params.dt = dt;
  World world(coupled(type, stiffness), how);
  const JointId joint = world.joints()[0];
  const double start = world.quality().kineticEnergy;
  double largest = 0;
  for (int i = 0; i < 3 / dt; ++i) {
    world.step();
    const double stretch = world.state(joint).axes[0].position;
    const double elastic = stiffness < kHard ? stiffness * stretch * stretch / 2 : 0;
    largest = std::max(largest, world.quality().kineticEnergy + elastic);
  }
  return largest / start;
}

TEST(ZeroLength, GainsNoEnergyAtAnyStiffnessAndTimeStep) {
  for (const JointType type : {JointType::Distance, JointType::Rope, JointType::Spring})
    for (const double stiffness : {1e2, 1e4, 1e6, 1e8, kHard})
      for (const double dt : {1. / 30, 1. / 60, 1. / 240})
        for (const int iterations : {4, 10}) {
          if (type == JointType::Spring && stiffness == kHard) continue;
          EXPECT_LT(largestEnergy(type, stiffness, dt, iterations), 1.001)
              << static_cast<int>(type) << ", " << stiffness << " N/m, 1/" << 1 / dt << " s, " << iterations
              << " iterations";
        }
}

TEST(ZeroLength, GainsNoEnergyWhereALengthIsShortBesideWhatAStepMoves) {
  constexpr int kIterations[] = {4, 6, 8, 10, 20};
  for (unsigned seed = 0; seed < 120; ++seed) {
    Random random(seed);
    const int iterations = kIterations[random.below(5)];
    const double dt = 1 / random.logUniform(30, 240), speed = random.uniform(.5, 6),
                 span = random.logUniform(1e-4, .5) * speed * dt;
    const JointType type = std::array{JointType::Distance, JointType::Rope,
                                      JointType::Spring}[static_cast<std::size_t>(random.below(3))];
    // ropes that go slack and taut in a step still gain some (docs/joints.md)
    if (type == JointType::Rope) continue;
    const double stiffness = type == JointType::Spring || random.below(2) == 0 ? random.logUniform(1e2, 1e9)
                                                                               : kHard;
    Scene scene = emptyScene({0, 0, 0});
    for (const int i : {0, 1}) {
      BodyDef def = body(Shape::box({.2, .1, .15}), {0, 0, .5 * i});
      def.mass = random.logUniform(.1, 10), def.filter.mask = 0;
      def.velocity = random.direction() * speed, def.angularVelocity = random.vector(4);
      scene.bodies.push_back(def);
    }
    JointDef joint;
    joint.type = type, joint.bodyA = 0, joint.bodyB = 1, joint.stiffness = stiffness, joint.length = span;
    joint.anchorA = {0, 0, .25}, joint.anchorB = Vec3{0, 0, -.25} + span * random.direction();
    scene.joints.push_back(joint);
    WorldOptions how = options(iterations);
    how.params.dt = dt;
    World world(scene, how);
    const double start = world.quality().kineticEnergy;
    double largest = 0;
    for (int i = 0; i < 2 / dt; ++i) {
      world.step();
      largest = std::max(largest, world.quality().kineticEnergy);
    }
    EXPECT_LT(largest, 1.001 * start)
        << "seed " << seed << ": type " << static_cast<int>(type) << ", " << span / (speed * dt)
        << " of the way, " << stiffness << " N/m, " << iterations << " iterations";
  }
}

TEST(ZeroLength, ASpringOfNoLengthSwingsAsHookesLawSays) {
  Scene scene = emptyScene({0, 0, 0});
  BodyDef ball = body(Shape::sphere(.1), {.1, 0, 0});
  ball.mass = 1;
  scene.bodies.push_back(ball);
  JointDef spring;
  spring.type = JointType::Spring, spring.bodyA = 0, spring.bodyB = kWorld, spring.stiffness = 100,
  spring.length = 0;
  scene.joints.push_back(spring);
  WorldOptions how = options(4);
  how.params.dt = 1e-3;
  World world(scene, how);
  // half a period of 2 pi / 10 s: it has passed through its rest, where a distance turns round
  run(world, 314);
  EXPECT_NEAR(world.state(world.bodies()[0]).position.x, -.1, .02 * .1 + .1 * .016);
}

TEST(ZeroLength, ALengthCanBeGivenAndTakenLater) {
  World world(coupled(JointType::Distance, kHard), options(10));
  const JointId joint = world.joints()[0];
  run(world, 30);
  EXPECT_LT(world.state(joint).axes[0].position, 2e-3);
  world.setLength(joint, .1);
  run(world, 120);
  EXPECT_NEAR(world.state(joint).axes[0].position, .1, 2e-3);
  world.setLength(joint, 0);
  run(world, 120);
  EXPECT_LT(world.state(joint).axes[0].position, 2e-3);
}

}  // namespace
}  // namespace rubble
