/// Bodies on several hinges whose axes pass one another at a distance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::Random;

/// Offsets of up to `distance` and tilts of up to 0.5 rad.
GimbalFields randomFields(Random& random, double distance) {
  GimbalFields fields;
  fields.offsetB = random.vector(distance), fields.offsetA = random.vector(distance);
  fields.tiltB = random.uniform(-0.5, 0.5), fields.tiltA = random.uniform(-0.5, 0.5);
  return fields;
}

/// A gimbal whose first axis is z of `frame` through a point of the world, between bodies that are not
/// turned.
JointDef gimbal(const Scene& scene, int a, int b, const Vec3& point, const Quat& frame,
                const GimbalFields& fields) {
  const auto position = [&](int body) {
    return body == kWorld ? Vec3{} : scene.bodies[static_cast<std::size_t>(body)].position;
  };
  JointDef joint;
  joint.type = jointType("gimbal"), joint.own = fields;
  joint.bodyA = a, joint.bodyB = b;
  joint.anchorB = point - position(b);
  joint.anchorA = point + rotate(frame, fields.offsetB + fields.offsetA) - position(a);
  joint.frameB = frame;
  joint.frameA = frame * fromAxisAngle({1, 0, 0}, fields.tiltB) * fromAxisAngle({0, 0, 1}, fields.tiltA);
  for (std::size_t k = 0; k < 3; ++k) joint.axes[k].min = joint.axes[k].max = 0;
  return joint;
}

/// Distance of anchor A from where the hinges have it [m].
double gapOf(const World& world, JointId joint) {
  const JointState state = world.state(joint);
  return std::hypot(state.axes[0].position, state.axes[1].position, state.axes[2].position);
}

class Gimbals : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Backends, Gimbals, ::testing::Values("cpu", "reference"));

/// Limbs with the masses of a human one swing from a level position.
TEST_P(Gimbals, KeepTheirAxesInPlaceUnderLoad) {
  constexpr double kMasses[] = {8, 4, 1.5, 20};
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    Random random(seed);
    Scene scene = test::emptyScene();
    for (int k = 0; k < 4; ++k) {
      scene.bodies.push_back(test::body(Shape::capsule(0.06, 0.15), {0.4 * k + 0.2, 0, 0}));
      scene.bodies.back().mass = kMasses[k];
      const Quat frame = random.rotation();
      JointDef joint = gimbal(scene, k, k - 1 < 0 ? kWorld : k - 1, {0.4 * k, 0, 0}, frame,
                              randomFields(random, 0.03));
      for (std::size_t axis = 3; axis < 6; ++axis)
        joint.axes[axis].min = -1, joint.axes[axis].max = 1, joint.axes[axis].damping = 0.5;
      if (k % 2 == 1) joint.axes[4].min = joint.axes[4].max = 0;  // two hinges
      scene.joints.push_back(joint);
    }
    World world(scene, test::options(4, GetParam()));
    constexpr int kSteps = 120;
    double sum = 0, largest = 0;
    for (int step = 0; step < kSteps; ++step) {
      world.step();
      for (const JointId joint : world.joints()) {
        const double gap = gapOf(world, joint);
        sum += gap / (kSteps * 4), largest = std::max(largest, gap);
      }
    }
    EXPECT_LT(sum, 1e-4) << seed;
    EXPECT_LT(largest, 5e-3) << seed;
  }
}

TEST_P(Gimbals, EndAtTheLimitsOfTheirAngles) {
  Random random(1);
  Scene scene = test::emptyScene({});
  for (int k = 0; k < 3; ++k) {
    scene.bodies.push_back(test::body(Shape::box({0.1, 0.05, 0.2}), {2. * k, 0, 0}));
    scene.bodies.back().mass = 2;
    JointDef joint = gimbal(scene, k, kWorld, {2. * k, 0, 0.2}, random.rotation(), randomFields(random, 0.1));
    for (std::size_t axis = 3; axis < 6; ++axis) {
      joint.axes[axis].min = -0.5 - 0.1 * k, joint.axes[axis].max = 0.4 + 0.1 * k;
      joint.axes[axis].motorForce = (static_cast<int>(axis) + k) % 2 == 0 ? 3 : -3;
      joint.axes[axis].damping = 0.2;
    }
    scene.joints.push_back(joint);
  }
  World world(scene, test::options(4, GetParam()));
  test::run(world, 240);
  for (int k = 0; k < 3; ++k) {
    const JointState state = world.state(world.joints()[static_cast<std::size_t>(k)]);
    for (int axis = 3; axis < 6; ++axis)
      EXPECT_NEAR(state.axes[static_cast<std::size_t>(axis)].position,
                  (axis + k) % 2 == 0 ? 0.4 + 0.1 * k : -0.5 - 0.1 * k, 1e-3)
          << k << ", axis " << axis;
  }
}

/// Rotors of angles that depend on one another exchange energy with the body and lose none.
TEST_P(Gimbals, KeepTheEnergyOfTheirRotors) {
  Scene scene = test::emptyScene({});
  scene.bodies.push_back(test::body(Shape::box({0.1, 0.15, 0.2}), {}));
  scene.bodies[0].mass = 3;
  scene.bodies[0].angularVelocity = {2, -1, 3};
  scene.joints.push_back(gimbal(scene, 0, kWorld, {}, {}, {}));
  constexpr double kArmature[] = {0.03, 0.06, 0.02};
  for (std::size_t k = 0; k < 3; ++k) scene.joints[0].axes[3 + k].armature = kArmature[k];
  WorldOptions options = test::options(4, GetParam());
  options.params.dt = 1e-3;
  World world(scene, options);
  const Vec3 inertia = massProperties(scene.bodies[0].shape, 3 / (8 * 0.1 * 0.15 * 0.2)).inertia;
  const auto energy = [&] {
    const BodyState body = world.state(world.bodyAt(0));
    const Vec3 w = rotateInverse(body.orientation, body.angularVelocity);
    double sum = inertia.x * w.x * w.x + inertia.y * w.y * w.y + inertia.z * w.z * w.z;
    const JointState joint = world.state(world.joints()[0]);
    for (std::size_t k = 0; k < 3; ++k)
      sum += kArmature[k] * joint.axes[3 + k].speed * joint.axes[3 + k].speed;
    return sum / 2;
  };
  world.step();
  const double before = energy();
  test::run(world, 300);
  EXPECT_GT(std::fabs(world.state(world.joints()[0]).axes[4].position), 0.3)
      << "the axes are where they were";
  EXPECT_NEAR(energy() / before, 1, 0.01);
}

/// Joint projection translates the bodies of a tree. A chain of balls and gimbals that is thrown at the
/// ground needs it, and its gimbals are open no further than its balls.
TEST_P(Gimbals, AreNotTornByJointProjection) {
  double balls = 0, gimbals = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::ground());
    for (int k = 0; k < 5; ++k) {
      scene.bodies.push_back(test::body(Shape::box({0.09, 0.02, 0.03}), {0.2 * k, 0, 1}));
      scene.bodies.back().velocity = {0, 0, -15};
      scene.bodies.back().angularVelocity = {0, random.uniform(-30, 30), 0};
      if (k == 0) continue;
      const Vec3 point{0.2 * k - 0.1, 0, 1};
      scene.joints.push_back(
          k % 2 == 0 ? jointAt(scene, JointType::Ball, k + 1, k, point)
                     : gimbal(scene, k + 1, k, point, random.rotation(), randomFields(random, 0.03)));
    }
    World world(scene, test::options(4, GetParam()));
    for (int step = 0; step < 40; ++step) {
      world.step();
      for (const JointId id : world.joints()) {
        const JointDef& joint = world.definition(id);
        if (joint.type != JointType::Ball) {
          gimbals = std::max(gimbals, gapOf(world, id));
          continue;
        }
        const auto anchor = [&](int body, const Vec3& at) {
          const BodyState state = world.state(world.bodyAt(body));
          return state.position + rotate(state.orientation, at);
        };
        balls = std::max(balls,
                         length(anchor(joint.bodyA, joint.anchorA) - anchor(joint.bodyB, joint.anchorB)));
      }
    }
  }
  EXPECT_LT(gimbals, 2 * balls);
}

}  // namespace
}  // namespace rubble
