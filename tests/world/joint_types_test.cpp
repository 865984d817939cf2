/// Joints of every type in a world: what they hold, what they report, what can be set while it runs.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::options;

constexpr Vec3 kY{0, 1, 0}, kZ{0, 0, 1};

/// A unit cube of 1 kg at the origin.
Scene cube(const Vec3& gravity = {0, 0, -10}) {
  Scene scene = test::emptyScene(gravity);
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  return scene;
}
JointId only(const World& world) { return world.joints()[0]; }

void expectRejected(const JointDef& joint, const std::string& path) {
  try {
    validate(joint, "joint");
    FAIL() << "no error for " << path;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("joint" + path), std::string::npos) << error.what();
  }
}

TEST(Hinge, KeepsItsAnchorsTogetherUnderLoadAndReportsTheWrench) {
  Scene scene = cube();
  JointDef hinge = jointAt(scene, JointType::Hinge, 0, kWorld, {-.5, 0, 0}, frameAlong(kZ));
  scene.joints.push_back(hinge);
  World world(scene, options(20, "reference"));
  test::run(world, 240);
  const JointState state = world.state(only(world));
  EXPECT_LT(state.gap, 1e-4);
  EXPECT_LT(state.angle, 1e-3);
  // on the world, about the anchor: 10 N at 0.5 m
  EXPECT_TRUE(test::near(state.force, Vec3{0, 0, -10}, .05));
  EXPECT_TRUE(test::near(state.torque, Vec3{0, 5, 0}, .05));
  ASSERT_EQ(state.axes.size(), 1u);
  EXPECT_NEAR(state.axes[0].position, 0, 1e-6);
}

TEST(Hinge, CountsTurnsBeyondPiAndStopsAtALimitOfTwoTurns) {
  Scene scene = cube({});
  JointDef hinge = jointAt(scene, JointType::Hinge, 0, kWorld, {}, frameAlong(kY));
  hinge.axes[0].max = 4 * std::numbers::pi;
  scene.joints.push_back(hinge);
  scene.bodies[0].angularVelocity = {0, 7, 0};
  World world(scene, options(10));
  test::run(world, 60);
  EXPECT_NEAR(world.state(only(world)).axes[0].position, 7, .05);
  test::run(world, 120);
  EXPECT_NEAR(world.state(only(world)).axes[0].position, 4 * std::numbers::pi, .05);
}

/// A cube of 1 kg on a hinge through its center, with a motor of 2 N m, armature 0.5 kg m2 and damping
/// 0.4 N m s/rad: its speed follows T / D (1 - exp(-D t / (I + I_a))).
TEST(Hinge, TurnsAsTheInertiaOfItsBodyAndTheArmatureOfItsMotorSay) {
  for (const char* backend : {"reference", "cpu"}) {
    SCOPED_TRACE(backend);
    Scene scene = cube({});
    JointDef hinge = jointAt(scene, JointType::Hinge, 0, kWorld, {}, frameAlong(kY));
    hinge.axes[0].armature = .5, hinge.axes[0].damping = .4, hinge.axes[0].motorForce = 2;
    scene.joints.push_back(hinge);
    World world(scene, options(4, backend));
    const double inertia = 1. / 6 + .5, dt = world.params().dt;
    for (int k = 1; k <= 3; ++k) {
      test::run(world, 60);
      // implicit Euler
      const double expected = 2 / .4 * (1 - std::pow(1 + .4 * dt / inertia, -60. * k));
      EXPECT_NEAR(world.state(only(world)).axes[0].speed, expected, 1e-3 * expected);
    }
    world.setMotorForce(only(world), 0, 0);
    const double before = world.state(only(world)).axes[0].speed;
    test::run(world, 60);
    EXPECT_NEAR(world.state(only(world)).axes[0].speed, before * std::pow(1 + .4 * dt / inertia, -60.),
                1e-3 * before);
  }
}

/// A tendon over a point of the world holds two bodies of one mass, of which one hangs on two of its strands:
/// accelerations follow from the tension, a_A = T / m - g and a_B = 2 T / m - g with a_A = -2 a_B.
TEST(Tendon, SharesOneTensionAmongItsSegments) {
  Scene scene = test::emptyScene({0, 0, -10});
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  scene.bodies.push_back(test::unitCube({4, 0, 0}));
  JointDef tendon;
  tendon.type = jointType("tendon");
  tendon.bodyA = 0, tendon.bodyB = 1;
  TendonFields path;
  path.path = {0, 0,   0, .5, 1, 2, 0,  0, 20, 1, 2, 3.9, 0, 20, 1,
               1, -.1, 0, .5, 1, 1, .1, 0, .5, 1, 2, 4.1, 0, 20, 0};
  tendon.own = path;
  // length now: 19.5 + sqrt(3.9^2) + 2 strands
  tendon.axes[0].max = 19.5 + 3.9 + 2 * 19.5 + .2;
  scene.joints.push_back(tendon);
  World world(scene, options(20, "reference"));
  constexpr int kSteps = 30;
  test::run(world, kSteps);
  const double t = kSteps * world.params().dt, a = world.state(world.bodies()[0]).velocity.z / t,
               b = world.state(world.bodies()[1]).velocity.z / t;
  EXPECT_NEAR(b, 2, .04);  // T = 6 N
  EXPECT_NEAR(a, -4, .08);
  EXPECT_LT(world.state(world.joints()[0]).gap, 1e-3);
}

/// A tendon between two bodies goes over a peg of the world: two tangents and an arc.
TEST(Tendon, IsAsLongAsItsTangentsAndItsArc) {
  constexpr double kRadius = .5, kAside = 2, kOver = .1;
  const Vec3 peg{7, -3, 5};
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::unitCube(peg + Vec3{-kAside, 0, 0}));
  scene.bodies.push_back(test::unitCube(peg + Vec3{kAside, 0, 0}));
  JointDef tendon;
  tendon.type = jointType("tendon");
  tendon.bodyA = 0, tendon.bodyB = 1;
  TendonFields own;
  own.path = {0, 0, 0, kOver, 1, 1, 0, 0, kOver, 0};
  own.wraps = {0, 2, peg.x, peg.y, peg.z, 0, 1, 0, kRadius, 0, 0, 0, 0};
  tendon.own = own;
  scene.joints.push_back(tendon);
  World world(scene, options(4, "reference"));
  test::run(world, 1);
  const double away = std::hypot(kAside, kOver), between = std::numbers::pi - 2 * std::atan(kOver / kAside),
               tangent = std::sqrt(away * away - kRadius * kRadius);
  EXPECT_NEAR(world.state(only(world)).axes[0].position,
              2 * tangent + kRadius * (between - 2 * std::acos(kRadius / away)), 1e-5);
}

TEST(Hinge, RestsOnASoftLimitByHookesLaw) {
  Scene scene = cube();
  // a cube of 1 kg, its center 0.5 m from the hinge, falls onto a limit of 40 N m/rad
  JointDef hinge = jointAt(scene, JointType::Hinge, 0, kWorld, {-.5, 0, 0}, frameAlong(kY));
  hinge.axes[0].max = .2;
  hinge.axes[0].limitStiffness = 40, hinge.axes[0].limitDamping = 4;
  scene.joints.push_back(hinge);
  World world(scene, options(4));
  test::run(world, 600);
  const JointAxisState axis = world.state(only(world)).axes[0];
  EXPECT_NEAR(40 * (axis.position - .2), 10 * .5 * std::cos(axis.position), .02);
  EXPECT_NEAR(axis.limitForce, -40 * (axis.position - .2), .02);
  EXPECT_NEAR(axis.speed, 0, 1e-3);
}

TEST(Slider, MovesOnlyAlongItsAxisAndReachesItsDriveTarget) {
  Scene scene = cube();
  const Vec3 way = normalize(Vec3{1, 0, 1});
  JointDef slider = jointAt(scene, JointType::Slider, 0, kWorld, {.3, 0, 0}, frameAlong(way));
  slider.axes[0].driveStiffness = 500, slider.axes[0].driveDamping = 40;
  scene.joints.push_back(slider);
  World world(scene, options(10));
  test::run(world, 240);
  world.setTargetPosition(only(world), 0, .4);
  test::run(world, 240);
  const JointState state = world.state(only(world));
  // the weight along the way over the stiffness
  EXPECT_NEAR(state.axes[0].position, .4 - 10 * std::sqrt(.5) / 500, 1e-3);
  EXPECT_NEAR(state.axes[0].driveForce, 10 * std::sqrt(.5), .02);
  EXPECT_TRUE(test::near(world.state(world.bodyAt(0)).position, state.axes[0].position * way, 2e-3));
  EXPECT_LT(state.gap, 1e-3);
}

TEST(Distance, LengthCanBeChangedWhileItRuns) {
  Scene scene = cube();
  JointDef rod = jointAt(scene, JointType::Distance, 0, kWorld, {});
  rod.anchorB = {0, 0, 2};
  scene.joints.push_back(rod);
  World world(scene, options(10));
  test::run(world, 60);
  EXPECT_NEAR(world.state(only(world)).axes[0].position, 2, 1e-3);
  world.setLength(only(world), 1.5);
  test::run(world, 240);
  EXPECT_NEAR(world.state(only(world)).axes[0].position, 1.5, 5e-3);
  EXPECT_THROW(world.setLimits(only(world), 0, 0, 1), Error);
}

TEST(AngularSpring, TurnsABodyBackAndLeavesItsPlaceAlone) {
  Scene scene = cube({});
  JointDef spring = jointAt(scene, JointType::AngularSpring, 0, kWorld, {});
  spring.angularStiffness = 4;
  spring.angularDampingRatio = 1;
  scene.joints.push_back(spring);
  scene.bodies[0].orientation = fromAxisAngle(kY, .8);
  scene.bodies[0].velocity = {1, 0, 0};
  World world(scene, options(10));
  test::run(world, 180);
  EXPECT_LT(test::angleBetween(world.state(world.bodyAt(0)).orientation, Quat{}), .02);
  EXPECT_NEAR(world.state(world.bodyAt(0)).position.x, 3, 1e-3);
}

TEST(SwingTwist, DriveHoldsAnOrientationAgainstGravity) {
  Scene scene = cube();
  JointDef joint = jointAt(scene, JointType::SwingTwist, 0, kWorld, {-.5, 0, 0});
  joint.driveStiffness = 2000, joint.driveDamping = 50;
  scene.joints.push_back(joint);
  World world(scene, options(10));
  world.setDriveOrientation(only(world), fromAxisAngle(kZ, .5));
  test::run(world, 240);
  const JointState state = world.state(only(world));
  // sags by 5 N m / 2000
  EXPECT_TRUE(test::sameRotation(world.state(world.bodyAt(0)).orientation, fromAxisAngle(kZ, .5), .004));
  EXPECT_NEAR(length(state.torque), 5, .05);
}

TEST(Ball, FrictionHoldsABodyAgainstASmallMoment) {
  for (const double friction : {6., 3.}) {
    Scene scene = cube();
    JointDef joint = jointAt(scene, JointType::Ball, 0, kWorld, {-.5, 0, 0});
    joint.friction = friction;
    scene.joints.push_back(joint);
    World world(scene, options(10));
    test::run(world, 60);
    const double angle = test::angleBetween(world.state(world.bodyAt(0)).orientation, Quat{});
    if (friction > 5)
      EXPECT_LT(angle, .01);
    else
      EXPECT_GT(angle, .5);
  }
}

TEST(SixDof, CountsTheTurnOfItsOneFreeRotationWhicheverAxisItIs) {
  for (int free = 3; free < 6; ++free) {
    Scene scene = cube({});
    JointDef joint = jointAt(scene, JointType::SixDof, 0, kWorld, {});
    for (int i = 0; i < 6; ++i)
      if (i != free)
        joint.axes[static_cast<std::size_t>(i)].min = joint.axes[static_cast<std::size_t>(i)].max = 0;
    scene.joints.push_back(joint);
    Vec3 spin;
    spin[free - 3] = 4;
    scene.bodies[0].angularVelocity = spin;
    World world(scene, options(10));
    test::run(world, 120);
    const JointState state = world.state(only(world));
    for (int i = 0; i < 6; ++i) {
      EXPECT_NEAR(state.axes[static_cast<std::size_t>(i)].position, i == free ? 8 : 0, .01) << i;
      EXPECT_NEAR(state.axes[static_cast<std::size_t>(i)].speed, i == free ? 4 : 0, .01) << i;
    }
  }
}

TEST(Joint, ReportsTheOnesThatBrokeInTheStepAndLetsTheirBodiesCollide) {
  Scene scene = cube();
  scene.bodies[0].motion = Motion::Static;
  scene.bodies.push_back(test::unitCube({0, 0, .9}));
  JointDef joint = jointAt(scene, JointType::Fixed, 1, 0, {0, 0, .45});
  joint.breakForce = 5;
  scene.joints.push_back(joint);
  World world(scene, options(10));
  const JointId id = only(world);
  bool seen = false;
  for (int i = 0; i < 20 && !seen; ++i) {
    const StepReport report = world.step();
    EXPECT_EQ(report.broken.size(), static_cast<std::size_t>(report.brokenJoints));
    if (report.broken.empty()) {
      EXPECT_EQ(report.manifolds, 0);
      continue;
    }
    seen = true;
    EXPECT_EQ(report.broken[0], id);
  }
  ASSERT_TRUE(seen);
  EXPECT_EQ(world.step().manifolds, 1);
  EXPECT_TRUE(world.state(id).broken);
}

TEST(Joint, KeepsItsMultipliersThroughAnEdit) {
  Scene scene = cube();
  JointDef slider = jointAt(scene, JointType::Slider, 0, kWorld, {}, frameAlong(kZ));
  slider.axes[0].min = slider.axes[0].max = 0;
  scene.joints.push_back(slider);
  World world(scene, options(10));
  test::run(world, 120);
  const Vec3 before = world.state(only(world)).force;
  EXPECT_NEAR(before.z, -10, .1);
  world.setTargetSpeed(only(world), 0, 3);
  EXPECT_EQ(world.state(only(world)).force, before);
}

TEST(Joint, RestoresWithASnapshot) {
  Scene scene = cube();
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 0, kWorld, {-.5, 0, 0}, frameAlong(kY)));
  World world(scene, options(4));
  test::run(world, 100);
  const Snapshot snapshot = world.snapshot();
  test::run(world, 50);
  const std::uint64_t hash = world.hash();
  const double angle = world.state(only(world)).axes[0].position;
  world.restore(snapshot);
  test::run(world, 50);
  EXPECT_EQ(world.hash(), hash);
  EXPECT_EQ(world.state(only(world)).axes[0].position, angle);
}

TEST(DragJoint, DrawsABodyToAPointWithoutOvershootAndLetsGo) {
  Scene scene = cube({});
  World world(scene, options(10));
  const JointId drag = world.addDragJoint(world.bodyAt(0), {0, 0, 0}, 1000, 2);
  world.setDragTarget(drag, {1, 0, 0});
  double most = 0;
  for (int i = 0; i < 120; ++i) {
    world.step();
    most = std::max(most, world.state(world.bodyAt(0)).position.x);
  }
  EXPECT_NEAR(world.state(world.bodyAt(0)).position.x, 1, .01);
  EXPECT_LT(most, 1.01);
  world.removeJoint(drag);
  EXPECT_TRUE(world.joints().empty());
}

TEST(JointDef, IsCheckedFieldByField) {
  const auto with = [](auto&& edit) {
    JointDef joint;
    edit(joint);
    return joint;
  };
  expectRejected(with([](JointDef& j) { j.axes[2].min = 1, j.axes[2].max = 0; }), ".axes[2].min");
  expectRejected(with([](JointDef& j) { j.stiffness = 0; }), ".stiffness");
  expectRejected(with([](JointDef& j) { j.damping = -1; }), ".damping");
  expectRejected(with([](JointDef& j) { j.dampingRatio = 1; }), ".dampingRatio");
  expectRejected(with([](JointDef& j) { j.frameA = {2, 0, 0, 0}; }), ".frameA");
  expectRejected(with([](JointDef& j) { j.type = JointType::Spring; }), ".stiffness");
  expectRejected(with([](JointDef& j) { j.ratio = 0; }), ".ratio");
  expectRejected(with([](JointDef& j) { j.swingZ = 0; }), ".swingZ");
  expectRejected(with([](JointDef& j) { j.axes[0].friction = kHard; }), ".axes[0].friction");
  EXPECT_NO_THROW(validate(JointDef{}, "joint"));
}

TEST(JointAt, PutsFramesWithoutErrorBetweenTurnedBodies) {
  Scene scene = cube();
  scene.bodies[0].orientation = normalize(Quat{.3, .4, -.5, .6});
  for (int type = 0; type <= static_cast<int>(JointType::SixDof); ++type) {
    const JointType kind = static_cast<JointType>(type);
    if (kind == JointType::Spring) continue;
    scene.joints = {jointAt(scene, kind, 0, kWorld, {.2, .1, .4}, normalize(Quat{.5, .1, .7, -.2}))};
    World world(scene, options());
    const JointState state = world.state(only(world));
    EXPECT_LT(state.gap, 1e-6) << keyword(kind);
    EXPECT_LT(state.angle, 1e-5) << keyword(kind);
    for (const JointAxisState& axis : state.axes) EXPECT_NEAR(axis.position, 0, 2e-3) << keyword(kind);
  }
}

}  // namespace
}  // namespace rubble
