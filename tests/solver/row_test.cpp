/// Forces and dual updates of groups of rows.
#include <solver/dual.h>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;
constexpr Real kNoBound = 1e30;

/// A group of rows with stiffness k with the ramp rule of beta 10 up to 1e6.
GroupState group(Real k, Real compliance = 0, Real bound = kNoBound) {
  return {k, compliance, bound, {StiffnessPolicy::Ramp, 1, 1e6, 10, 1e3}, true};
}

struct Result {
  Real force[3];
  Real hessian;
  bool inside;
};
Result forceOf(const GroupState& g, const Vec3& error, const Vec3& lambda) {
  const Real c[3] = {error.x, error.y, error.z}, l[3] = {lambda.x, lambda.y, lambda.z};
  Result r{};
  r.inside = aggregateForce<3>(g, c, l, r.force, 3, r.hessian);
  return r;
}
Vec3 vector(const Result& r) { return {r.force[0], r.force[1], r.force[2]}; }

TEST(GroupForce, OfAHardGroupIsTheDerivativeOfTheAugmentedEnergy) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Real k = random.logUniform(1, 1e6), lambda = random.uniform(-10, 10), error = random.uniform(-1, 1),
               h = 1e-4;
    const Real slope = (augmentedEnergy(k, lambda, error + h) - augmentedEnergy(k, lambda, error - h)) /
                       (2 * h);
    const Result r = forceOf(group(k), {error, 0, 0}, {lambda, 0, 0});
    EXPECT_NEAR(r.force[0], slope, 1e-7 * (1 + k));
    EXPECT_EQ(r.hessian, k);
    EXPECT_TRUE(r.inside);
  }
  EXPECT_EQ(quadraticEnergy(6, 2), 12);
}

TEST(GroupForce, IsCutToTheBoundAlongItself) {
  Random random(2);
  int cut = 0;
  for (int i = 0; i < 200; ++i) {
    const Real k = random.logUniform(1, 100), bound = random.logUniform(.1, 100);
    const Vec3 error = random.vector(), lambda = random.vector(5);
    const Vec3 free = k * error + lambda;
    const Result r = forceOf(group(k, 0, bound), error, lambda);
    EXPECT_EQ(r.inside, length(free) <= bound);
    const Vec3 expected = r.inside ? free : free * (bound / length(free));
    EXPECT_TRUE(test::near(vector(r), expected, 1e-12 * (1 + length(free))));
    cut += !r.inside;
  }
  EXPECT_GT(cut, 50);
  EXPECT_LT(cut, 150);
}

TEST(GroupForce, HasTheSecantStiffnessAtTheBound) {
  // one row: from lambda 2 at C = 0 the force reaches its bound 5 at C = 4
  const Result r = forceOf(group(100, 0, 5), {4, 0, 0}, {2, 0, 0});
  EXPECT_NEAR(r.hessian, 3. / 4, 1e-14);
  // never stiffer than k
  EXPECT_NEAR(forceOf(group(1, 0, 5), {.1, 0, 0}, {20, 0, 0}).hessian, 1, 1e-14);
  EXPECT_NEAR(forceOf(group(7, 0, 5), {0, 0, 0}, {20, 0, 0}).hessian, 7, 0);
}

TEST(GroupForce, OfACompliantGroupIsSoftenedByItsCompliance) {
  const Real k = 300, stiffness = 100;
  const Result r = forceOf(group(k, 1 / stiffness), {.2, 0, 0}, {8, 0, 0});
  const Real s = stiffness / (stiffness + k);
  EXPECT_NEAR(r.force[0], s * (k * .2 + 8), 1e-12);
  EXPECT_NEAR(r.hessian, s * k, 1e-12);
}

TEST(UpdateGroup, TakesOverTheForceAndGrowsTheStiffnessWithTheError) {
  GroupState g = group(50);
  const Real error[3] = {.3, 0, -.4};
  Real lambda[3] = {1, 2, 3};
  updateGroup<3>(g, error, lambda, 3);
  EXPECT_NEAR(lambda[0], 16, 1e-13);
  EXPECT_NEAR(lambda[1], 2, 1e-13);
  EXPECT_NEAR(lambda[2], -17, 1e-13);
  EXPECT_NEAR(g.k, 50 + 10 * .5, 1e-13);
}

TEST(UpdateGroup, GrowsNoStiffnessAtTheBoundAndNoneBeyondTheLimit) {
  const Real error[3] = {.3, 0, -.4};
  Real lambda[3] = {0, 0, 0};
  GroupState bounded = group(50, 0, 5);
  updateGroup<3>(bounded, error, lambda, 3);
  EXPECT_EQ(bounded.k, 50);
  EXPECT_NEAR(length(Vec3{lambda[0], lambda[1], lambda[2]}), 5, 1e-13);
  GroupState limited = group(1e6 - 1);
  updateGroup<3>(limited, error, lambda, 3);
  EXPECT_EQ(limited.k, 1e6);
}

TEST(UpdateGroup, OfACompliantGroupConvergesToHookesLawAtAnyStiffness) {
  for (const Real k : {1., 100., 1e4}) {
    const Real stiffness = 250, error[1] = {.02};
    Real lambda[1] = {0};
    GroupState g = group(k, 1 / stiffness);
    for (int i = 0; i < 10000; ++i) updateGroup<1>(g, error, lambda, 1);
    EXPECT_NEAR(lambda[0], stiffness * error[0], 1e-9) << k;
    EXPECT_EQ(g.k, k);
  }
}

TEST(UpdateGroup, OfARampGroupKeepsNoMultiplierAndEndsAtTheMaterialStiffness) {
  GroupState g = group(1);
  g.keepsMultiplier = false;
  g.rule.limit = 250;
  const Real error[1] = {.5};
  Real lambda[1] = {0};
  for (int i = 0; i < 100; ++i) {
    updateGroup<1>(g, error, lambda, 1);
    EXPECT_EQ(lambda[0], 0);
  }
  EXPECT_EQ(g.k, 250);
}

TEST(UpdateGroup, TouchesOnlyItsOwnRows) {
  GroupState g = group(10);
  const Real error[3] = {1, 1, 1};
  Real lambda[3] = {0, 0, 7};
  updateGroup<3>(g, error, lambda, 2);
  EXPECT_EQ(lambda[2], 7);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
