/// Parts of the step that concern single bodies, in closed form: sums over lanes, paths, swept boxes, shares.
#include <gtest/gtest.h>

#include <vector>

#include "stages/ccd/unpaired_impacts.h"
#include "stages/islands/island_momentum.h"
#include "stages/trees/trees.h"
#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

BodyParams dynamicBody(const ShapeData& shape) {
  BodyParams p{};
  p.shape = shape, p.kind = BodyKind::Dynamic, p.mass = 1, p.radius = boundingRadius(shape);
  p.surface = -1, p.gravityScale = 1;
  return p;
}

TEST(Block, OfLanesIsTheSumOfItsLanes) {
  constexpr int kNumbers = sizeof(Block6) / sizeof(Real);
  Random random(1);
  Block6T<Real4> four;
  auto* const lanes = reinterpret_cast<Real*>(&four);
  for (int k = 0; k < kNumbers * kLanes; ++k) lanes[k] = random.uniform(1, 2);
  Block6 sum;
  addLanes(sum, four);
  const auto* const numbers = reinterpret_cast<const Real*>(&sum);
  for (int k = 0; k < kNumbers; ++k) {
    Real expected = 0;
    for (int lane = 0; lane < kLanes; ++lane) expected += lanes[kLanes * k + lane];
    EXPECT_NEAR(numbers[k], expected, 1e-12) << k;
  }
}

/// A body that rests has no path; one that falls free has that of its fall.
TEST(FreePath, IncludesOnlyGravityThatTheBodyFollowed) {
  StepConstants step = testConstants();
  BodyParams params = dynamicBody({{0, 0, 0}, 1, ShapeKind::Sphere, -1});
  Vec3 velocity{1, 0, -2}, previous = velocity;
  SolverData s{};
  s.step = &step, s.params = &params, s.velocity = &velocity, s.previousVelocity = &previous;
  EXPECT_TRUE(test::near(freePath(s, 0), step.dt * velocity, 1e-15));
  previous = velocity - step.dt * step.gravity;
  EXPECT_TRUE(test::near(freePath(s, 0), step.dt * velocity + step.dt * step.dt * step.gravity, 1e-15));
}

/// Bodies pass one another at less than the gap at which an impact is found, and at more.
TEST(BoundsOnMotions, MeetWhereverAnImpactMayBeFound) {
  constexpr Real kRadius = .1;
  BodyParams params[2];
  params[0] = params[1] = dynamicBody({{0, 0, 0}, kRadius, ShapeKind::Sphere, -1});
  const Real gap = kImpactGap * pairLength(params[0], params[1]);
  for (const Real share : {-.5, 0., .9, 5.}) {
    Vec3d position[2] = {{-3, 0, 0}, {3, 2 * kRadius + share * gap, 0}};
    Quat orientation[2];
    SolverData s{};
    s.params = params, s.position = position, s.orientation = orientation;
    const SweptMotion a{{5, 0, 0}, {}}, b{{-5, 0, 0}, {}}, ends{{-5, 0, 0}, {}, .1};
    EXPECT_EQ(boundsMeet(s, 0, 1, a, b), share < 1) << share;
    // they are still apart after a quarter of the way, and A alone does not get to B
    EXPECT_FALSE(boundsMeet(s, 0, 1, a, b, .25));
    EXPECT_FALSE(boundsMeet(s, 0, 1, a, ends));
  }
}

TEST(BoundsOnMotions, OfLongBodiesAreThinnerThanTheirSpheresUnlessTheyTurn) {
  BodyParams params[2];
  params[0] = params[1] = dynamicBody({{1, .05, .05}, 0, ShapeKind::Box, -1});
  Vec3d position[2] = {{-3, 0, 0}, {3, .5, 0}};
  Quat orientation[2];
  SolverData s{};
  s.params = params, s.position = position, s.orientation = orientation;
  const SweptMotion a{{5, 0, 0}, {}}, b{{-5, 0, 0}, {}}, turning{{5, 0, 0}, {0, 0, 1.5}};
  EXPECT_FALSE(boundsMeet(s, 0, 1, a, b));
  EXPECT_TRUE(boundsMeet(s, 0, 1, turning, b));
}

TEST(RecordedImpact, IsTheFirstOfThoseOfAPair) {
  BodyParams params[2];
  params[0] = params[1] = dynamicBody({{0, 0, 0}, 1, ShapeKind::Sphere, -1});
  SweptPair swept{};
  int shares[2]{}, fast[2] = {1, 1}, pairs[2]{}, carriers[2]{};
  Counters counters{};
  SolverData s{};
  s.params = params, s.ccdShareBits = shares, s.fast = fast, s.counters = &counters;
  s.ccdPair = pairs, s.ccdCarrier = carriers;
  for (const double fraction : {.5, .25, .75}) recordImpact(s, swept, {0, 1}, fraction, {0, 0, 1});
  for (const int bits : {swept.toiBits, shares[0], shares[1]})
    EXPECT_EQ(fromFloatBits(bits), .75) << "what remains";
  EXPECT_EQ(counters.ccdImpacts, 1);
}

TEST(SweptBounds, HoldATurningBodyAtAllTimes) {
  Random random(2);
  for (int round = 0; round < 40; ++round) {
    BodyParams params = dynamicBody({{1, Real(.05), Real(.1)}, 0, ShapeKind::Box, -1});
    Vec3d position = random.vector(2);
    Quat orientation = random.rotation();
    Displacement moved{random.vector(.5), 0, random.vector(1), 0};
    SolverData s{};
    s.params = &params, s.position = &position, s.orientation = &orientation, s.dx = &moved;
    const Real begin = random.uniform(0, .5), end = random.uniform(.5, 1);
    const Bounds bounds = boundsOfMotion(s, 0, begin, end);
    for (int k = 0; k < 8; ++k)
      for (const Real t : {begin, (begin + end) / 2, end}) {
        const Vec3 corner{k & 1 ? Real(1) : Real(-1), k & 2 ? Real(.05) : Real(-.05),
                          k & 4 ? Real(.1) : Real(-.1)};
        const Vec3 at = position + t * moved.dp + rotate(expRotation(t * moved.dw) * orientation, corner);
        const Vec3 off = abs(at - bounds.center);
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(off[axis], bounds.half[axis] + 1e-12) << round;
      }
  }
}

/// An island that loses all motion relative to its rigid motion has the latter alone.
TEST(IslandRepair, TakesWhatIsNotRigidMotion) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    StepConstants step = testConstants();
    BodyParams params = dynamicBody({{1, Real(.5), Real(.2)}, 0, ShapeKind::Box, -1});
    params.inertia = {random.uniform(2, 3), random.uniform(3, 4), random.uniform(4, 5)};
    Vec3d position = random.vector();
    Quat orientation = random.rotation();
    Vec3 velocity = random.vector(), spin = random.vector(.2);
    BodyTarget target{};
    target.y.p = step.dt * random.vector();
    IslandRepair repair{};
    repair.center = random.vector(), repair.velocity = random.vector(), repair.spin = random.vector(.2);
    repair.loss = 1, repair.active = 1;
    int slot = 0, root = 0;
    Counters counters{};
    counters.freeIslands = 1;
    SolverData s{};
    s.step = &step, s.params = &params, s.position = &position, s.orientation = &orientation;
    s.velocity = &velocity, s.angularVelocity = &spin, s.target = &target, s.counters = &counters;
    s.islandRepair = &repair, s.islandSlot = &slot, s.rowIsland = &root;
    RepairBodies{}(s, 0);
    const Vec3 arm(position - repair.center), rigid = repair.velocity + cross(repair.spin, arm);
    EXPECT_TRUE(test::near(velocity, step.inverseDt * target.y.p + rigid, 1e-12)) << round;
    EXPECT_TRUE(test::near(spin, repair.spin, 1e-3)) << round;
  }
}

TEST(TreeShare, LimitsRotationsAndRejectsOnlyStepsThatAreNotFinite) {
  for (const Real turn : {.01, .7, .99, 1.5, 40., 1e20}) {
    const double share = treeShare(floatBits(turn));
    EXPECT_NEAR(share * turn, std::min(turn, kLargestRotation), 1e-6 * turn) << turn;
  }
  EXPECT_EQ(treeShare(floatBits(SubstituteNode::kNoRotation)), 0);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
