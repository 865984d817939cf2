/// The rows of one coordinate: limits, drives, friction.
#include <forces/axis.h>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

AxisSpec nothing() { return {-kNoLimit, kNoLimit, kHardValue, 0, 0, 0, 0, 0, kHardValue, 0, 0, 0, 0}; }
AxisSituation at(Real value, Real change = 0) { return {value, 0, change, 0, 1, 1, 1, kHardValue, 1}; }

/// Dual updates at a fixed coordinate until the force is settled.
Real settled(const StepConstants& c, AxisRows& rows, Real value, int updates = 400) {
  for (int i = 0; i < updates; ++i) updateAxis(c, rows, value);
  return axisLoad(rows);
}

TEST(Axis, WithNothingOnItDoesNotAct) {
  AxisRows rows{};
  beginAxis(testConstants(), nothing(), rows, at(3));
  EXPECT_FALSE(actsAtAll(rows));
}

TEST(Axis, LimitPushesBackOnEitherSideOnly) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.lo = -1, spec.hi = 2;
  for (const Real value : {-1.5, 0., 2.5}) {
    AxisRows rows{};
    // predicted to move far, so that it takes part whatever the side
    beginAxis(c, spec, rows, at(1, 5));
    Real force, hessian;
    axisForces(rows, value, force, hessian);
    EXPECT_NEAR(force, rows.limit.k * (value > 2 ? .5 : value < -1 ? -.5 : 0), 1e-9);
    EXPECT_EQ(hessian, rows.limit.k);
  }
}

TEST(Axis, MultiplierOfAHardLimitDecaysByAlphaGamma) {
  StepConstants c = testConstants();
  c.alpha = .9, c.gamma = .8;
  AxisSpec spec = nothing();
  spec.hi = 2;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(2.5));
  rows.limit.lambda = 10;
  beginAxis(c, spec, rows, at(2.5));
  EXPECT_NEAR(rows.limit.lambda, 7.2, 1e-12);
}

TEST(Axis, LimitThatStaysOpenIsInactive) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.hi = 1;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(-1, .1));
  EXPECT_FALSE(rows.limit.active);
  beginAxis(c, spec, rows, at(.5, .4));
  EXPECT_EQ(rows.limit.active, 1);
  beginAxis(c, spec, rows, at(1.01, -1));
  EXPECT_EQ(rows.limit.active, 1);
}

TEST(Axis, LimitNearbyIsWatchedWithoutStiffnessUntilItIsCrossed) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.hi = 1;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(.8, .01));
  EXPECT_EQ(rows.limit.active, kWatched);
  Real force, hessian;
  axisForces(rows, Real(.9), force, hessian);
  EXPECT_EQ(force, 0);
  EXPECT_EQ(hessian, 0);
  // an impact drives it past its limit: the limit acts in the same step
  axisForces(rows, Real(1.1), force, hessian);
  EXPECT_NEAR(force, rows.limit.k * Real(.1), 1e-6 * rows.limit.k);
  EXPECT_EQ(hessian, rows.limit.k);
}

/// A contact may drive a joint to its limit however slow it was before.
TEST(Axis, LimitForgetsWhatFirstLoadsItAndKeepsWhatFollows) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.hi = 1;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(.8, .01));
  updateAxis(c, rows, Real(1.1));
  EXPECT_GT(rows.limit.lambda, 0);
  beginAxis(c, spec, rows, at(1.02, .01));
  EXPECT_EQ(rows.limit.active, 1);
  EXPECT_EQ(rows.limit.lambda, 0);
  updateAxis(c, rows, Real(1.03));
  EXPECT_GT(rows.limit.lambda, 0);
  beginAxis(c, spec, rows, at(.99, -1));
  EXPECT_EQ(rows.limit.active, 1);
  EXPECT_GT(rows.limit.lambda, 0);
}

TEST(Axis, LimitForgivesExcessButNoGap) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.lo = -1, spec.hi = 1;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(1.2));
  EXPECT_NEAR(rows.limit.hi, 1 + .95 * .2, 1e-12);
  EXPECT_NEAR(rows.limit.lo, -1, 1e-12);
  beginAxis(c, spec, rows, at(.9, 1));
  EXPECT_NEAR(rows.limit.hi, 1, 1e-12);
}

TEST(Axis, EqualLimitsLockIt) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.lo = spec.hi = .3;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(.5));
  Real force, hessian;
  axisForces(rows, .3 + .95 * .2, force, hessian);
  EXPECT_NEAR(force, 0, 1e-9);
  axisForces(rows, 0, force, hessian);
  EXPECT_LT(force, 0);
}

TEST(Axis, SoftLimitIsASpringAndADamperBeyondIt) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.hi = 1;
  spec.limitStiffness = 200, spec.limitDamping = 10;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(1.1));
  EXPECT_NEAR(settled(c, rows, 1.15), 200 * .15 + 10 * .05 * 60, 1e-6);
}

TEST(Axis, DriveIsASpringAndADamperWithALargestForce) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.target = 2, spec.speed = .6;
  spec.driveStiffness = 40, spec.driveDamping = 5;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(1));
  // 0.02 in a step is 1.2 a second, 0.6 more than wanted
  EXPECT_NEAR(settled(c, rows, 1.02), 40 * (1.02 - 2) + 5 * (1.2 - .6), 1e-6);
  spec.driveBound = 7;
  AxisRows weak{};
  beginAxis(c, spec, weak, at(1));
  EXPECT_NEAR(settled(c, weak, 1.02), -7, 1e-9);
}

TEST(Axis, MotorKeepsItsSpeedAndLeavesPositionAlone) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.speed = 3;
  spec.driveDamping = kHardValue;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(17));
  Real force, hessian;
  axisForces(rows, 17 + 3. / 60, force, hessian);
  EXPECT_NEAR(force, 0, 1e-8);
  axisForces(rows, 17, force, hessian);
  // F opposes c: a negative force drives it up
  EXPECT_LT(force, 0);
}

TEST(Axis, FrictionResistsAnyMotionUpToItsBound) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.friction = 4;
  for (const Real way : {-.2, .2}) {
    AxisRows rows{};
    beginAxis(c, spec, rows, at(1));
    EXPECT_NEAR(settled(c, rows, 1 + way), way > 0 ? 4 : -4, 1e-9);
    EXPECT_NEAR(settled(c, rows, 1, 0), way > 0 ? 4 : -4, 1e-9);
  }
}

TEST(Axis, MultiplierOfAnImpactIsNotWarmStarted) {
  StepConstants c = testConstants();
  c.impactRule = true;
  AxisSpec spec = nothing();
  spec.hi = 1;
  AxisRows rows{};
  beginAxis(c, spec, rows, at(.95, .1));  // 6 m/s
  EXPECT_TRUE(rows.impact);
  settled(c, rows, 1.01, 3);
  EXPECT_GT(rows.limit.lambda, 0);
  beginAxis(c, spec, rows, at(1.01));
  EXPECT_EQ(rows.limit.lambda, 0);
}

TEST(Axis, CountsTurnsOutOfItsLimits) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.hi = 10;
  AxisRows rows{};
  AxisSituation s = at(-2.5, .5);
  s.turn = 12.566370614359172;  // two turns: 10.07
  beginAxis(c, spec, rows, s);
  EXPECT_TRUE(rows.limit.active);
  Real force, hessian;
  axisForces(rows, -2.4, force, hessian);
  EXPECT_GT(force, 0);
}

TEST(Axis, RotorIsAnInertiaADamperAndAForceByImplicitEuler) {
  const StepConstants c = testConstants();
  AxisSpec spec = nothing();
  spec.armature = .3, spec.damping = .7, spec.force = 2;
  AxisRows rows{};
  AxisSituation s = at(.4);
  s.speed = 1.5;
  beginAxis(c, spec, rows, s);
  EXPECT_TRUE(actsAtAll(rows));
  const Real value = .43, speed = (value - .4) * c.inverseDt;
  Real force, hessian;
  axisForces(rows, value, force, hessian);
  EXPECT_NEAR(force, .3 * (speed - 1.5) * c.inverseDt + .7 * speed - 2, 1e-9);
  EXPECT_NEAR(hessian, (.3 * c.inverseDt + .7) * c.inverseDt, 1e-9);
  updateAxis(c, rows, value);
  EXPECT_DOUBLE_EQ(rows.rotor.force, force);
  EXPECT_EQ(axisLoad(rows), 0);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
