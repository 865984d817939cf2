/// Gears and racks with frame bodies, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::options;

BodyDef wheel(const Vec3& position, double radius, double mass) {
  BodyDef def = test::body(Shape::cylinder(radius, .05), position);
  def.mass = mass;
  return def;
}
void motor(JointDef& hinge, double speed, double most = kHard) {
  hinge.axes[0].targetSpeed = speed;
  hinge.axes[0].driveDamping = kHard;
  hinge.axes[0].maxDriveForce = most;
}
const Quat kUp = frameAlong({0, 0, 1});

/// A housing with two wheels 2 : 1 about z and a motor on the first. All of it is rotated and spins about an
/// axis of its own.
Scene floatingGearbox(const Quat& turn, const Vec3& spin) {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies = {test::body(Shape::box({.6, .4, .1}), {}), wheel({-.3, 0, .2}, .1, 2),
                  wheel({.3, 0, .2}, .2, 6)};
  scene.bodies[0].mass = 20;
  for (int i = 1; i <= 2; ++i)
    scene.joints.push_back(
        jointAt(scene, JointType::Hinge, i, 0, scene.bodies[static_cast<std::size_t>(i)].position, kUp));
  motor(scene.joints[0], 20, 5);
  scene.joints.push_back(gearBetween(scene, 0, 1, 2));
  for (BodyDef& body : scene.bodies) {
    body.position = rotate(turn, body.position);
    body.orientation = turn;
    body.velocity = cross(spin, body.position) + Vec3{.5, -1, .2};
    body.angularVelocity = spin;
  }
  return scene;
}
struct Momentum {
  Vec3 linear, angular;
};
Momentum momentum(const World& world) {
  Momentum sum;
  for (const BodyId id : world.bodies()) {
    const BodyState s = world.state(id);
    const MassProperties m = world.massOf(id);
    const Quat q = s.orientation * m.axes;
    sum.linear += m.mass * s.velocity;
    sum.angular += m.mass * cross(s.position, s.velocity) +
                   rotate(q, mul(m.inertia, rotateInverse(q, s.angularVelocity)));
  }
  return sum;
}
double angle(const World& world, int joint) {
  return world.state(world.joints()[static_cast<std::size_t>(joint)]).axes[0].position;
}

struct Tumble {
  double linear, angular;  ///< change of the momenta over 2 s
  double slack = 0;        ///< largest error of the teeth [rad]
};
Tumble tumble(int stepsPerSecond) {
  WorldOptions at = options(4);
  at.params.dt = 1. / stepsPerSecond;
  World world(floatingGearbox(fromAxisAngle(normalize(Vec3{1, 2, -1}), 1.1), {.4, .7, -.3}), at);
  const Momentum before = momentum(world);
  Tumble result{};
  for (int i = 0; i < 2 * stepsPerSecond; ++i) {
    world.step();
    result.slack = std::max(result.slack, std::fabs(angle(world, 0) + 2 * angle(world, 1)));
  }
  const Momentum after = momentum(world);
  result.linear = length(after.linear - before.linear),
  result.angular = length(after.angular - before.angular);
  EXPECT_NEAR(world.state(world.joints()[0]).axes[0].speed, 20, .2);
  EXPECT_NEAR(world.state(world.joints()[1]).axes[0].speed, -10, .1);
  return result;
}

TEST(Gear, InAHousingThatTumblesKeepsRatioAndMomentum) {
  const Tumble coarse = tumble(60), fine = tumble(480);
  EXPECT_LT(coarse.slack, .02);
  EXPECT_LT(fine.slack, .02);
  // what the motor drives has 1.4 N m s
  EXPECT_LT(coarse.linear, 1e-3);
  EXPECT_LT(coarse.angular, .45);
  // implicit Euler loses orbital momentum in proportion to the time step; a gear with a reaction on the world
  // would not improve with the step
  EXPECT_LT(fine.angular, coarse.angular / 5);
}

TEST(Gear, BetweenPlanetAndArmHasTheRatioOfWillis) {
  // sun 24 teeth, planet 18, ring 60: the world
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies = {wheel({0, 0, 0}, .24, 3), wheel({0, 0, -.2}, .5, 4), wheel({.42, 0, 0}, .18, 2)};
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 0, kWorld, {}, kUp));
  motor(scene.joints[0], 7);
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 1, kWorld, {}, kUp));
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 2, 1, {.42, 0, 0}, kUp));
  for (const bool ring : {false, true}) {
    JointDef gear = jointAt(scene, JointType::Gear, ring ? 2 : 0, ring ? kWorld : 2, {}, kUp);
    gear.frameBodyA = gear.frameBodyB = 1;
    gear.ratio = ring ? -60. / 18 : 18. / 24;
    scene.joints.push_back(gear);
  }
  World world(scene, options(4));
  test::run(world, 120);
  EXPECT_NEAR(world.state(world.bodyAt(1)).angularVelocity.z, 7 / (1 + 60. / 24), .01);
  EXPECT_NEAR(angle(world, 1) * (1 + 60. / 24), angle(world, 0), .02);
}

TEST(Gear, FollowsItsFrameBody) {
  Scene scene = floatingGearbox({}, {});
  World world(scene, options(4));
  const JointId gear = world.joints()[2];
  EXPECT_EQ(world.frameBodiesOf(gear)[0], world.bodyAt(0));
  EXPECT_EQ(world.frameBodiesOf(gear)[1], world.bodyAt(0));
  world.removeBody(world.bodyAt(0));
  EXPECT_FALSE(world.alive(gear));
  world.step();
}

TEST(Gear, OfHingesThatTheWorldOwnsTurnsTheRightWay) {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies = {wheel({0, 0, 0}, .2, 3), wheel({.5, 0, 0}, .2, 3)};
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 0, kWorld, {}, kUp));
  motor(scene.joints[0], 3);
  // its A is the world
  scene.joints.push_back(jointAt(scene, JointType::Hinge, kWorld, 1, {.5, 0, 0}, kUp));
  scene.joints.push_back(gearBetween(scene, 0, 1, 1.5));
  World world(scene, options(4));
  test::run(world, 60);
  EXPECT_NEAR(angle(world, 0) + 1.5 * angle(world, 1), 0, .01);
  EXPECT_NEAR(angle(world, 1), -2, .02);
}

TEST(Rack, InAFrameThatFliesKeepsMomentumAndMesh) {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies = {test::body(Shape::box({.5, .1, .5}), {0, -.3, 0}), wheel({0, 0, 0}, .2, 4),
                  test::body(Shape::box({.4, .05, .05}), {0, 0, .3})};
  scene.bodies[0].mass = 15, scene.bodies[2].mass = 3;
  const Quat across = frameAlong({0, 1, 0});
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 1, 0, {}, across));
  motor(scene.joints[0], 4, 10);
  scene.joints.push_back(jointAt(scene, JointType::Slider, 2, 0, {0, 0, .3}, frameAlong({1, 0, 0})));
  scene.joints.push_back(rackBetween(scene, 0, 1, .2));
  const Vec3 spin{.6, .2, .9};
  for (BodyDef& body : scene.bodies)
    body.velocity = cross(spin, body.position) + Vec3{0, 0, 1}, body.angularVelocity = spin;
  World world(scene, options(4));
  const Momentum before = momentum(world);
  for (int i = 0; i < 40; ++i) {
    world.step();
    // it starts from rest within a step
    EXPECT_LT(std::fabs(.2 * angle(world, 0) - angle(world, 1)), i < 20 ? 6e-3 : 1.5e-3) << i;
  }
  const Momentum after = momentum(world);
  EXPECT_GT(angle(world, 1), .3);
  EXPECT_LT(length(after.linear - before.linear), 1e-4 * length(before.linear));
  EXPECT_LT(length(after.angular - before.angular), .02 * length(before.angular));
}

TEST(Gear, OfAMovingFrameBodyIsCheckedFieldByField) {
  Scene scene = floatingGearbox({}, {});
  scene.joints[2].frameBodyA = 1;
  EXPECT_THROW(validate(scene), Error);
  scene.joints[2].frameBodyA = 9;
  EXPECT_THROW(validate(scene), Error);
  scene.joints[2].frameBodyA = 0;
  EXPECT_NO_THROW(validate(scene));
  scene.joints[0].frameBodyB = 2;
  EXPECT_THROW(validate(scene), Error);
  EXPECT_THROW(gearBetween(scene, 0, 2, 1), Error);
  EXPECT_THROW(rackBetween(scene, 0, 1, 1), Error);
  EXPECT_THROW(gearBetween(scene, 0, 7, 1), Error);
}

}  // namespace
}  // namespace rubble
