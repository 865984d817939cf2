/// Rows of all joints: warm start, accumulation, dual update, breakage.
#include "tests/forces/joint_cases.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

const JointBody kLight{2, {.1, .2, .3}, {}, {}}, kHeavy{200, {10, 20, 30}, {}, {}},
    kFixedBody{0, {0, 0, 0}, {}, {}};

template <class F>
void begin(const StepConstants& c, const JointSpec<F>& spec, Joint<F>& joint, const JointCase<F>& x,
           const JointBody& a = kLight, const JointBody& b = kHeavy) {
  joint.length = .5;
  const JointBody bodies[2] = {a, b};
  beginJointAt(c, spec, joint, x.a, x.b, bodies);
}
template <class F> Joint<F> begun(const JointCase<F>& x, const StepConstants& c, const JointSpec<F>& spec) {
  Joint<F> joint{};
  begin(c, spec, joint, x);
  return joint;
}
template <class F> Joint<F> begun(const JointCase<F>& x, const StepConstants& c) {
  return begun(x, c, specOf<F>(x.data));
}

StepConstants unlimited() {
  StepConstants c = testConstants();
  return c;
}

/// A ball joint at the origin, with A moved away.
JointCase<BallJoint> apart(const Vec3& gap) {
  return {{{0, 0, 0}, {0, 0, 0}}, {gap, Quat{}}, {{0, 0, 0}, Quat{}}};
}

TEST(Joint, StartsWithTheMassOfTheLighterBodyAndItsInertiaWithLever) {
  Random random(1);
  const JointCase<FixedJoint> x = randomJointCase<FixedJoint>(random);
  const Joint<FixedJoint> joint = begun(x, unlimited());
  EXPECT_NEAR(partOf<0>(joint.parts).state.k, 2 * 3600, 1e-6);
  EXPECT_NEAR(partOf<1>(joint.parts).state.k, (.1 + 2 * lengthSquared(x.data.anchorA) / 3) * 3600, 1e-6);
}

TEST(Joint, IgnoresTheInertiaOfABodyThatDoesNotMove) {
  Random random(2);
  const JointCase<BallJoint> x = randomJointCase<BallJoint>(random);
  Joint<BallJoint> joint{};
  begin(unlimited(), specOf<BallJoint>(x.data), joint, x, kFixedBody);
  EXPECT_NEAR(partOf<0>(joint.parts).state.k, 200 * 3600, 1e-6);
}

TEST(Joint, ScalesAnAngleWithTheMomentAboutItsAxisAndItsLever) {
  JointCase<HingeJoint> x{};
  x.data.anchorA = {.7, 0, 2};
  Joint<HingeJoint> joint{};
  begin(unlimited(), specOf<HingeJoint>(x.data), joint, x, kLight, kFixedBody);
  // about x: the lever is 2 along z
  EXPECT_NEAR(partOf<2>(joint.parts).start, (.1 + 2 * 4) * 3600, 1e-6);
}

TEST(Joint, LeavesAlphaOfTheErrorAtTheStartOfTheStepAlone) {
  Random random(3);
  const StepConstants c = unlimited();
  const JointCase<FixedJoint> x = randomJointCase<FixedJoint>(random);
  JointSpec<FixedJoint> spec = specOf<FixedJoint>(x.data);
  const Joint<FixedJoint> hard = begun(x, c, spec);
  partOf<0>(spec.parts).stiffness = partOf<1>(spec.parts).stiffness = 1e3;
  const Joint<FixedJoint> soft = begun(x, c, spec);
  const auto whole = constraintOf<AnchorRows>(x);
  for (int row = 0; row < 3; ++row) {
    EXPECT_NEAR(partOf<0>(hard.parts).shift[row], .95 * whole.c[row], 1e-14);
    // a spring stretched is no error
    EXPECT_EQ(partOf<0>(soft.parts).shift[row], 0);
  }
}

TEST(Joint, WarmStartsMultiplierAndStiffness) {
  const StepConstants c = unlimited();
  const JointCase<BallJoint> x = apart({});
  Joint<BallJoint> joint = begun(x, c);
  auto& rows = partOf<0>(joint.parts);
  const Real k0 = rows.state.k;
  rows.lambda[0] = 100;
  rows.state.k = 7 * k0;
  const JointSpec<BallJoint> spec = specOf<BallJoint>(x.data);
  endJoint(spec, joint);
  begin(c, spec, joint, x);
  EXPECT_NEAR(rows.lambda[0], 100 * .95 * .99, 1e-10);
  EXPECT_NEAR(rows.state.k, 7 * .99 * k0, 1e-6);
}

TEST(Joint, AccumulatesTheForceThatItsEnergyGives) {
  // without inherited error: E = k |C|^2 / 2 + lambda . C, differentiated along the retraction
  Random random(5);
  for (int n = 0; n < 20; ++n) {
    const StepConstants c = unlimited();
    const JointCase<FixedJoint> x = randomJointCase<FixedJoint>(random);
    const JointSpec<FixedJoint> spec = specOf<FixedJoint>(x.data);
    Joint<FixedJoint> joint = begun(x, c, spec);
    const auto prepare = [&](auto& rows, Real k) {
      for (Real& shift : rows.shift) shift = 0;
      for (Real& lambda : rows.lambda) lambda = random.uniform(-50, 50);
      rows.state.k = k;
    };
    prepare(partOf<0>(joint.parts), 30), prepare(partOf<1>(joint.parts), 20);
    const auto energy = [&](const Pose& a, const Pose& b) {
      const JointCase<FixedJoint> y{x.data, a, b};
      const auto c0 = constraintOf<AnchorRows>(y);
      const auto c1 = constraintOf<OrientationRows>(y);
      Real sum = 0;
      for (int row = 0; row < 3; ++row)
        sum += augmentedEnergy(30, partOf<0>(joint.parts).lambda[row], c0.c[row]) +
               augmentedEnergy(20, partOf<1>(joint.parts).lambda[row], c1.c[row]);
      return sum;
    };
    for (int side = 0; side < 2; ++side) {
      Block6 block;
      accumulateAt(spec, joint, x.a, x.b, side, block);
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
  JointCase<BallJoint> x = apart({});
  JointSpec<BallJoint> spec = specOf<BallJoint>(x.data);
  spec.breakForce = 50;
  Joint<BallJoint> joint = begun(x, c, spec);
  const auto& rows = partOf<0>(joint.parts);
  x.a.p = {49 / rows.state.k, 0, 0};
  updateJointDuals(c, spec, joint, x.a, x.b);
  EXPECT_NEAR(rows.lambda[0], 49, 1e-9);
  EXPECT_FALSE(endJoint(spec, joint));
  EXPECT_FALSE(joint.broken);
  x.a.p = {1, 1, 0};
  updateJointDuals(c, spec, joint, x.a, x.b);
  EXPECT_NEAR(length(Vec3{rows.lambda[0], rows.lambda[1], rows.lambda[2]}), 50, 1e-9);
  Block6 block;
  accumulateAt(spec, joint, x.a, x.b, 0, block);
  EXPECT_NEAR(length(block.fl), 50, 1e-9);
  EXPECT_TRUE(endJoint(spec, joint));
  EXPECT_TRUE(joint.broken);
}

TEST(Joint, WithALargestForceHoldsOnWithoutBreaking) {
  const StepConstants c = unlimited();
  JointCase<BallJoint> x = apart({});
  JointSpec<BallJoint> spec = specOf<BallJoint>(x.data);
  partOf<0>(spec.parts).bound = 50;
  Joint<BallJoint> joint = begun(x, c, spec);
  x.a.p = {1, 0, 0};
  updateJointDuals(c, spec, joint, x.a, x.b);
  EXPECT_NEAR(partOf<0>(joint.parts).lambda[0], 50, 1e-9);
  EXPECT_FALSE(endJoint(spec, joint));
}

TEST(Joint, BreaksByTorqueToo) {
  const StepConstants c = unlimited();
  JointCase<FixedJoint> x{};
  JointSpec<FixedJoint> spec = specOf<FixedJoint>(x.data);
  spec.breakTorque = 3;
  Joint<FixedJoint> joint = begun(x, c, spec);
  x.a.q = expRotation({0, 0, .5});
  updateJointDuals(c, spec, joint, x.a, x.b);
  EXPECT_NEAR(partOf<1>(joint.parts).lambda[2], 3, 1e-9);
  EXPECT_TRUE(endJoint(spec, joint));
}

TEST(Joint, WithFiniteStiffnessConvergesToHookesLaw) {
  StepConstants c = unlimited();
  JointCase<BallJoint> x = apart({.02, 0, 0});
  JointSpec<BallJoint> spec = specOf<BallJoint>(x.data);
  partOf<0>(spec.parts).stiffness = 500;
  Joint<BallJoint> joint = begun(x, c, spec);
  for (int i = 0; i < 200; ++i) updateJointDuals(c, spec, joint, x.a, x.b);
  EXPECT_NEAR(partOf<0>(joint.parts).lambda[0], 10, 1e-6);
  c.compliantRows = false;
  Joint<BallJoint> ramp = begun(x, c, spec);
  for (int i = 0; i < 200; ++i) updateJointDuals(c, spec, ramp, x.a, x.b);
  EXPECT_EQ(partOf<0>(ramp.parts).lambda[0], 0);
  EXPECT_NEAR(partOf<0>(ramp.parts).state.k, 500, 1e-9);
}

TEST(Joint, WithADamperResistsTheRateOfItsError) {
  const StepConstants c = unlimited();
  JointCase<BallJoint> x = apart({.02, 0, 0});
  JointSpec<BallJoint> spec = specOf<BallJoint>(x.data);
  partOf<0>(spec.parts).stiffness = 500;
  partOf<0>(spec.parts).damping = 30;
  Joint<BallJoint> joint = begun(x, c, spec);
  x.a.p = {.05, 0, 0};
  for (int i = 0; i < 400; ++i) updateJointDuals(c, spec, joint, x.a, x.b);
  // 0.03 m in 1/60 s
  EXPECT_NEAR(partOf<0>(joint.parts).lambda[0], 500 * .05 + 30 * .03 * 60, 1e-6);
}

TEST(Joint, PartsThatAreOffPushNothing) {
  const StepConstants c = unlimited();
  JointCase<FixedJoint> x{};
  x.a.p = {1, 2, 3};
  JointSpec<FixedJoint> spec = specOf<FixedJoint>(x.data);
  partOf<0>(spec.parts).mode = GroupMode::Off;
  Joint<FixedJoint> joint = begun(x, c, spec);
  updateJointDuals(c, spec, joint, x.a, x.b);
  Block6 block;
  accumulateAt(spec, joint, x.a, x.b, 0, block);
  EXPECT_EQ(length(block.fl), 0);
  EXPECT_EQ(block.ll.xx, 0);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
