/// Stiffness rules, warm start [S 12] [S 17], regularisation by alpha, and the constants of a step.
#include <solver/warmstart.h>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

TEST(Stiffness, StartsAtKTimesMassOverTheTimeStepSquared) {
  StepConstants c = testConstants();
  EXPECT_NEAR(startStiffness(c, 2), 2 * 3600, 1e-9);
  c.startStiffness = 2.5;
  EXPECT_NEAR(startStiffness(c, 2), 5 * 3600, 1e-9);
}

TEST(Stiffness, RampGrowsWithTheErrorInMassPerTimeStepSquaredAndLength) {
  StepConstants c = testConstants();
  c.contactRampRate = 10;
  const Real start = startStiffness(c, 2), length = .5;
  const StiffnessRule rule = stiffnessRule(c, StiffnessPolicy::Ramp, c.contactRampRate, start, length);
  // an error of L adds B k_start
  EXPECT_NEAR(grownStiffness<Real>(rule, start, -length, 0), 11 * start, 1e-9 * start);
  EXPECT_NEAR(grownStiffness<Real>(rule, start, 0, 1e9), start, 0);
}

TEST(Stiffness, RampDoesNotDependOnTheUnitOfMass) {
  // grams: forces and stiffness 1000 times those in kilograms
  const StepConstants c = testConstants();
  const StiffnessRule heavy = stiffnessRule(c, StiffnessPolicy::Ramp, c.contactRampRate, startStiffness(c, 2),
                                            1),
                      light = stiffnessRule(c, StiffnessPolicy::Ramp, c.contactRampRate,
                                            startStiffness(c, 2e3), 1);
  EXPECT_NEAR(
      grownStiffness<Real>(light, light.start, .1, 0) / grownStiffness<Real>(heavy, heavy.start, .1, 0), 1e3,
      1e-9);
}

TEST(Stiffness, LiteralBetaIsTakenAsItIs) {
  StepConstants c = testConstants();
  c.literalBeta = true;
  c.contactRampRate = 10;
  const StiffnessRule rule = stiffnessRule(c, StiffnessPolicy::Ramp, c.contactRampRate, startStiffness(c, 2),
                                           .5);
  EXPECT_NEAR(grownStiffness<Real>(rule, 100, .3, 0), 103, 1e-12);
}

TEST(Stiffness, NeverExceedsItsLimit) {
  StepConstants c = testConstants();
  c.maxStiffness = 100;
  const Real start = startStiffness(c, 1);
  for (const StiffnessPolicy policy : {StiffnessPolicy::Ramp, StiffnessPolicy::FollowLoad})
    EXPECT_NEAR(grownStiffness<Real>(stiffnessRule(c, policy, c.contactRampRate, start, 1), start, 1e9, 1e12),
                100 * start, 1e-6);
}

TEST(Stiffness, FollowsTheLoadFromItsFloor) {
  const StepConstants c = testConstants();
  StiffnessRule rule = stiffnessRule(c, StiffnessPolicy::FollowLoad, c.contactRampRate, startStiffness(c, 1),
                                     .5);
  EXPECT_GT(rule.perLoad, 0);
  rule.perLoad = 2000;
  EXPECT_NEAR(grownStiffness<Real>(rule, 1, 9, -1000), 2e6, 1e-6);
  EXPECT_NEAR(grownStiffness<Real>(rule, 1, 9, .001), rule.start, 0);
  EXPECT_NEAR(warmStiffness<Real>(c, rule, 7, 1000), 2e6, 1e-6);
}

TEST(WarmStart, OfANewRowIsZeroForceAtTheFloor) {
  const Warm warm = coldStart(42);
  EXPECT_EQ(warm.lambda, 0);
  EXPECT_EQ(warm.k, 42);
}

TEST(WarmStart, DecaysTheMultiplierByAlphaGammaOrByGamma) {
  const StepConstants c = testConstants();
  EXPECT_NEAR(warmMultiplier<Real>(c, 10, true), 10 * .95 * .99, 1e-12);
  EXPECT_NEAR(warmMultiplier<Real>(c, -10, false), -9.9, 1e-12);
}

TEST(WarmStart, DecaysTheStiffnessDownToItsFloor) {
  const StepConstants c = testConstants();
  const StiffnessRule rule = stiffnessRule(c, StiffnessPolicy::Ramp, c.contactRampRate, startStiffness(c, 1),
                                           1);
  EXPECT_NEAR(warmStiffness<Real>(c, rule, 5 * rule.start, 0), .99 * 5 * rule.start, 1e-9);
  EXPECT_EQ(warmStiffness<Real>(c, rule, rule.start, 0), rule.start);
  EXPECT_EQ(warmStiffness<Real>(c, rule, 1e30, 0), rule.limit);
}

TEST(WarmStart, RescalesTheStiffnessWhenTheTimeStepChanges) {
  Params params;
  params.dt = 1. / 120;
  const StepConstants c = stepConstants(params, {0, 0, 0}, 1. / 60);
  EXPECT_NEAR(c.stiffnessRescale, 4, 1e-12);
  EXPECT_EQ(stepConstants(params, {0, 0, 0}, 0).stiffnessRescale, 1);
  const StiffnessRule rule = stiffnessRule(c, StiffnessPolicy::Ramp, c.contactRampRate, startStiffness(c, 1),
                                           1);
  EXPECT_NEAR(warmStiffness<Real>(c, rule, 2 * rule.start, 0), c.gamma * 8 * rule.start, 1e-6);
}

TEST(Regularisation, LeavesAlphaOfAnInheritedErrorAlone) {
  const StepConstants c = testConstants();
  EXPECT_NEAR(inheritedError(c, .2), .01, 1e-15);
  EXPECT_NEAR(inheritedError(c, -.2), -.01, 1e-15);
}

TEST(Regularisation, ForgivesPenetrationButNoGap) {
  const StepConstants c = testConstants();
  EXPECT_NEAR(inheritedViolation(c, .2), .01, 1e-15);
  EXPECT_EQ(inheritedViolation(c, -.2), -.2);
}

TEST(StepConstants, KeepTheRateOfCorrectionAtAnyTimeStep) {
  Params params;
  params.tuning.errorRetention = -1;
  for (const Real dt : {1. / 30, 1. / 60, 1. / 240}) {
    params.dt = dt;
    const StepConstants c = stepConstants(params, {0, 0, 0}, 0);
    EXPECT_NEAR((1 - c.alpha) / dt, 3, 1e-12);
    EXPECT_NEAR(std::log(c.gamma) / dt, 60 * std::log(params.tuning.warmStartDecay), 1e-9);
  }
  params.dt = 1;
  EXPECT_EQ(stepConstants(params, {0, 0, 0}, 0).alpha, 0);
}

TEST(StepConstants, TakeTheRateOfDriftCorrectionAndCorrectAtMostAll) {
  Params params;
  params.dt = .01;
  params.tuning.driftCorrection = 20;
  EXPECT_NEAR(stepConstants(params, {0, 0, 0}, 0).driftCorrection, .2, 1e-15);
  params.tuning.driftCorrection = 300;
  EXPECT_EQ(stepConstants(params, {0, 0, 0}, 0).driftCorrection, 1);
}

TEST(StepConstants, DivideTheStepBySubsteps) {
  Params params;
  params.dt = 1. / 60;
  params.substeps = 4;
  const StepConstants c = stepConstants(params, {1, 2, 3}, 0);
  EXPECT_NEAR(c.dt, 1. / 240, 1e-16);
  EXPECT_NEAR(c.inverseDt * c.dt, 1, 1e-14);
  EXPECT_EQ(c.gravity, (Vec3{1, 2, 3}));
}

TEST(StepConstants, OfThePaperAreThoseOfTheAvbdAbstract) {
  const Params params = Params::of(Preset::Paper);
  const StepConstants c = stepConstants(params, {0, 0, 0}, 0);
  EXPECT_EQ(c.alpha, .95);
  EXPECT_EQ(c.gamma, .99);
  EXPECT_EQ(c.contactRampRate, 10);
  EXPECT_TRUE(c.literalBeta);
  EXPECT_FALSE(stepPlan(params).coneHessian);
  EXPECT_FALSE(c.compliantRows);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
