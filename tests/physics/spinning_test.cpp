/// Bodies that spin fast under torques of joints and springs, against the steady precession of a
/// heavy symmetric top.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

using std::numbers::pi;
using test::options;

constexpr double kSeconds = 10;
constexpr Vec3 kVertical{0, 0, 1};

enum class Mount { Joint, Spring };

/// A body of 1 kg whose axis of symmetry is its z, over a point of it.
struct Top {
  Shape shape;
  double lever;   ///< from the point to the center of mass [m]
  double center;  ///< z of the center of mass in the frame of the shape [m]
  double inclination, spin, gravity;
  Mount mount;

  Vec3 inertia() const {
    const MassProperties m = massProperties(shape, 1000);
    return m.inertia / m.mass;
  }
  /// The slow root of I1 p^2 cos(a) - I3 w p + m g l = 0, with I1 about the point. [rad/s]
  double precession() const {
    const double load = gravity * lever, momentum = inertia().z * spin,
                 across = (inertia().x + lever * lever) * std::cos(inclination);
    return 2 * load / (momentum + std::sqrt(momentum * momentum - 4 * across * load));
  }
  BodyDef body() const {
    BodyDef def = test::body(shape, {}, 1);
    def.mass = 1;
    def.orientation = fromAxisAngle(Vec3{0, 1, 0}, inclination);
    const Vec3 axis = rotate(def.orientation, kVertical);
    def.position = (lever - center) * axis;
    def.angularVelocity = precession() * kVertical + (spin - precession() * std::cos(inclination)) * axis;
    def.velocity = cross(def.angularVelocity, lever * axis);
    return def;
  }
  Scene scene() const {
    Scene out = test::emptyScene({0, 0, -gravity});
    out.bodies.push_back(body());
    JointDef joint = test::ball(0, {0, 0, center - lever}, kWorld, {});
    // 0.01 mm under the weight
    if (mount == Mount::Spring) joint.stiffness = 1e5 * gravity, joint.dampingRatio = .1;
    out.joints.push_back(joint);
    return out;
  }
};

/// What a top has done in ten seconds.
struct Path {
  double tilt = 0;   ///< largest change of its inclination [rad]
  double ratio = 0;  ///< of its precession to the closed form
};
Path pathOf(const Top& top, double dt, int iterations = 4) {
  WorldOptions o = options(iterations);
  o.params.dt = dt;
  World world(top.scene(), o);
  Path out;
  double angle = 0, last = 0;
  const int steps = static_cast<int>(std::lround(kSeconds / dt));
  for (int i = 0; i < steps; ++i) {
    world.step();
    const Vec3 axis = rotate(world.state(world.bodyAt(0)).orientation, kVertical);
    out.tilt = std::max(out.tilt, std::fabs(std::acos(axis.z) - top.inclination));
    const double now = std::atan2(axis.y, axis.x);
    angle += std::remainder(now - last, 2 * pi), last = now;
  }
  out.ratio = angle / (steps * dt) / top.precession();
  return out;
}
void expectPrecession(const Top& top, double dt) {
  const Path m = pathOf(top, dt);
  EXPECT_LT(m.tilt, pi / 180) << "inclination " << top.inclination << ", spin " << top.spin << ", precession "
                              << top.precession();
  EXPECT_NEAR(m.ratio, 1, .01) << "inclination " << top.inclination << ", spin " << top.spin
                               << ", precession " << top.precession();
}

/// Of little load: implicit Euler takes p^2 dt / 2 of a precession p in a second, 0.1 % here.
struct Kind {
  Shape shape;
  double lever, center;
};
const std::vector<Kind> kKinds = {{Shape::cylinder(.3, .02), .05, 0},
                                  {Shape::box({.25, .25, .04}), .05, 0},
                                  {Shape::cone(.4, .1), .06, -.05},
                                  {Shape::sphere(.3), .03, 0},
                                  {Shape::cylinder(.2, .2), .02, 0}};
constexpr double kInclinations[] = {25, 60, 90, 120};

struct Pace {
  double spin, dt;
};
class TopAt : public ::testing::TestWithParam<Pace> {};

TEST_P(TopAt, PrecessesOnAJointAndDoesNotFall) {
  for (const Kind& kind : kKinds)
    for (const double degrees : kInclinations)
      expectPrecession(
          {kind.shape, kind.lever, kind.center, degrees * pi / 180, GetParam().spin, 9.81, Mount::Joint},
          GetParam().dt);
}
TEST_P(TopAt, PrecessesOnASpringAndDoesNotFall) {
  for (const Kind& kind : kKinds)
    for (const double degrees : kInclinations)
      expectPrecession(
          {kind.shape, kind.lever, kind.center, degrees * pi / 180, GetParam().spin, 9.81, Mount::Spring},
          GetParam().dt);
}
INSTANTIATE_TEST_SUITE_P(All, TopAt,
                         ::testing::Values(Pace{40, 1. / 60}, Pace{40, 1. / 240}, Pace{100, 1. / 240}),
                         [](const auto& info) {
                           return std::to_string(int(info.param.spin)) + "_" +
                                  std::to_string(int(std::lround(1 / info.param.dt)));
                         });

TEST(Spinning, AnAxleThatIsTurnedBearsTheGyroscopicTorque) {
  // I3 w p, about the axis that is square to spin and turn
  constexpr double kSpin = 30, kTurn = 1;
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::body(Shape::box({.1, .1, .1}), {0, 0, -1}));
  scene.bodies[0].motion = Motion::Kinematic;
  scene.bodies[0].angularVelocity = {0, 0, kTurn};
  BodyDef wheel = test::body(Shape::cylinder(.3, .05), {});
  wheel.mass = 2;
  wheel.orientation = fromAxisAngle(Vec3{0, 1, 0}, pi / 2);
  wheel.angularVelocity = {kSpin, 0, kTurn};
  scene.bodies.push_back(wheel);
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 1, 0, {}));
  World world(scene, options(4));
  const double moment = world.massOf(world.bodyAt(1)).inertia.z;
  double sum = 0;
  test::run(world, 60);
  constexpr int kSteps = 60;
  for (int i = 0; i < kSteps; ++i) {
    world.step();
    sum += length(world.state(world.joints()[0]).torque);
    const BodyState state = world.state(world.bodyAt(1));
    EXPECT_NEAR(rotate(state.orientation, kVertical).z, 0, 1e-3);
  }
  EXPECT_NEAR(sum / kSteps, moment * kSpin * kTurn, .02 * moment * kSpin * kTurn);
}

}  // namespace
}  // namespace rubble
