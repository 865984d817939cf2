/// What every joint makes of its rows: warm start, stamps, dual update, breakage.
#include "tests/forces/joint_cases.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

const JointBody kLight{2, {.1, .2, .3}}, kHeavy{200, {10, 20, 30}}, kFixedBody{0, {0, 0, 0}};

template <class F> Joint<F> jointOf(const typename F::Data& data) {
  Joint<F> joint{};
  joint.data = data;
  joint.a = 0, joint.b = 1;
  joint.alive = true;
  for (Real& bound : joint.bound) bound = 1e30;
  return joint;
}

template <class F> Joint<F> begun(const JointCase<F>& x, const StepConstants& c, Real compliance = 0) {
  Joint<F> joint = jointOf<F>(x.data);
  for (Real& own : joint.compliance) own = compliance;
  beginJoint(c, joint, x.a, x.b, kLight, kHeavy, .5);
  return joint;
}

StepConstants unlimited() {
  StepConstants c = testConstants();
  c.maxMultiplier = 1e30;
  return c;
}

TEST(Joint, StartsWithTheMassOfTheLighterBodyAndItsInertiaWithLever) {
  Random random(1);
  const StepConstants c = unlimited();
  const JointCase<FixedJoint> x = randomJointCase<FixedJoint>(random);
  const Joint<FixedJoint> joint = begun(x, c);
  EXPECT_NEAR(joint.group[0].k, 2 * 3600, 1e-6);
  EXPECT_NEAR(joint.group[1].k, (.1 + 2 * lengthSquared(x.data.anchorA) / 3) * 3600, 1e-6);
}

TEST(Joint, IgnoresTheInertiaOfABodyThatDoesNotMove) {
  Random random(2);
  const StepConstants c = unlimited();
  const JointCase<BallJoint> x = randomJointCase<BallJoint>(random);
  Joint<BallJoint> joint = jointOf<BallJoint>(x.data);
  beginJoint(c, joint, x.a, x.b, kFixedBody, kHeavy, .5);
  EXPECT_NEAR(joint.group[0].k, 200 * 3600, 1e-6);
}

TEST(Joint, LeavesAlphaOfTheErrorAtTheStartOfTheStepAlone) {
  Random random(3);
  const StepConstants c = unlimited();
  const JointCase<FixedJoint> x = randomJointCase<FixedJoint>(random);
  const Joint<FixedJoint> hard = begun(x, c), soft = begun(x, c, 1e-3);
  Real whole[6], atHard[6], atSoft[6];
  FixedJoint::constraint(x.data, x.a, x.b, whole);
  regularisedError(hard, x.a, x.b, atHard);
  regularisedError(soft, x.a, x.b, atSoft);
  for (int row = 0; row < 6; ++row) {
    EXPECT_NEAR(atHard[row], .05 * whole[row], 1e-14);
    // a spring stretched is no error
    EXPECT_EQ(atSoft[row], whole[row]);
  }
}

TEST(Joint, WarmStartsMultiplierAndStiffness) {
  Random random(4);
  const StepConstants c = unlimited();
  const JointCase<BallJoint> x = closedJointCase<BallJoint>(random);
  Joint<BallJoint> joint = begun(x, c);
  const Real k0 = joint.group[0].k;
  joint.lambda[0] = 100;
  joint.group[0].k = 7 * k0;
  endJoint(joint);
  beginJoint(c, joint, x.a, x.b, kLight, kHeavy, .5);
  EXPECT_NEAR(joint.lambda[0], 100 * .95 * .99, 1e-10);
  EXPECT_NEAR(joint.group[0].k, 7 * .99 * k0, 1e-6);
}

TEST(Joint, StampsTheForceThatItsEnergyGives) {
  // at C0 = 0: E = k |C|^2 / 2 + lambda . C, differentiated along the retraction
  Random random(5);
  for (int n = 0; n < 20; ++n) {
    const StepConstants c = unlimited();
    const JointCase<FixedJoint> x = randomJointCase<FixedJoint>(random);
    Joint<FixedJoint> joint = begun(x, c);
    for (Real& c0 : joint.c0) c0 = 0;
    for (Real& lambda : joint.lambda) lambda = random.uniform(-50, 50);
    joint.group[0].k = 30, joint.group[1].k = 20;
    const auto energy = [&](const Pose& a, const Pose& b) {
      Real error[6], sum = 0;
      regularisedError(joint, a, b, error);
      for (int row = 0; row < 6; ++row) sum += augmentedEnergy(joint.group[row / 3].k, joint.lambda[row], error[row]);
      return sum;
    };
    for (int side = 0; side < 2; ++side) {
      Block6 block;
      stampJoint(joint, x.a, x.b, side, block);
      const Vec6 force{block.fl, block.fa};
      constexpr Real h = 1e-5;
      for (int i = 0; i < 6; ++i) {
        const auto at = [&](Real s) {
          const Vec6 dx = (s * h) * unitVec6(i);
          return side == 0 ? energy(retract(x.a, dx), x.b) : energy(x.a, retract(x.b, dx));
        };
        EXPECT_NEAR(component(force, i), -(at(1) - at(-1)) / (2 * h), 1e-5) << side << " " << i;
      }
    }
  }
}

TEST(Joint, NeverTransmitsMoreThanItsThresholdAndBreaksThere) {
  const StepConstants c = unlimited();
  JointCase<BallJoint> x{{{0, 0, 0}, {0, 0, 0}}, {{0, 0, 0}, Quat{}}, {{0, 0, 0}, Quat{}}};
  Joint<BallJoint> joint = jointOf<BallJoint>(x.data);
  joint.bound[0] = 50;
  beginJoint(c, joint, x.a, x.b, kLight, kHeavy, .5);
  x.a.p = {49 / joint.group[0].k, 0, 0};
  updateJointDuals(joint, x.a, x.b);
  EXPECT_NEAR(joint.lambda[0], 49, 1e-9);
  EXPECT_FALSE(endJoint(joint));
  EXPECT_FALSE(joint.broken);
  x.a.p = {1, 1, 0};
  updateJointDuals(joint, x.a, x.b);
  EXPECT_NEAR(length(Vec3{joint.lambda[0], joint.lambda[1], joint.lambda[2]}), 50, 1e-9);
  Block6 block;
  stampJoint(joint, x.a, x.b, 0, block);
  EXPECT_NEAR(length(block.fl), 50, 1e-9);
  EXPECT_TRUE(endJoint(joint));
  EXPECT_TRUE(joint.broken);
}

TEST(Joint, BreaksByTorqueToo) {
  const StepConstants c = unlimited();
  JointCase<FixedJoint> x{{{0, 0, 0}, {0, 0, 0}, Quat{}}, {{0, 0, 0}, Quat{}}, {{0, 0, 0}, Quat{}}};
  Joint<FixedJoint> joint = jointOf<FixedJoint>(x.data);
  joint.bound[1] = 3;
  beginJoint(c, joint, x.a, x.b, kLight, kHeavy, .5);
  x.a.q = expRotation({0, 0, .5});
  updateJointDuals(joint, x.a, x.b);
  EXPECT_NEAR(joint.lambda[5], 3, 1e-9);
  EXPECT_TRUE(endJoint(joint));
}

TEST(Joint, WithFiniteStiffnessConvergesToHookesLaw) {
  StepConstants c = unlimited();
  JointCase<BallJoint> x{{{0, 0, 0}, {0, 0, 0}}, {{.02, 0, 0}, Quat{}}, {{0, 0, 0}, Quat{}}};
  Joint<BallJoint> joint = begun(x, c, 1. / 500);
  for (int i = 0; i < 200; ++i) updateJointDuals(joint, x.a, x.b);
  EXPECT_NEAR(joint.lambda[0], 10, 1e-6);
  c.compliantRows = false;
  Joint<BallJoint> ramp = begun(x, c, 1. / 500);
  for (int i = 0; i < 200; ++i) updateJointDuals(ramp, x.a, x.b);
  EXPECT_EQ(ramp.lambda[0], 0);
  EXPECT_NEAR(ramp.group[0].k, 500, 1e-9);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
