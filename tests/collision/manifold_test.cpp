/// Transfer of loads between manifolds of successive steps: matching by feature and by position, world
/// directions, recycling.
#include <collision/manifold.h>

#include "tests/collision/shapes_for_tests.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

const ShapeData kBrick = box({.5, .25, .125});

PairPose pose(const Quat& qA, const Quat& qB, const Vec3& t) {
  return {qA, qB, t, 2 * length(kBrick.half), .02};
}
PairPose stacked(Real shift = .2) { return pose(Quat{}, Quat{}, {shift, .1, .25}); }

/// What lasts of a pair.
struct Kept {
  PairTest test;
  Manifold manifold;
};
/// As the narrow phase does it.
Kept update(const PairPose& p, const Kept* old, Real tolerance) {
  if (old && recyclable(old->test, old->manifold.count, p, tolerance))
    return {old->test, recycledManifold<Real>(old->manifold, p)};
  const RawManifold raw = collide(kBrick, kBrick, p);
  return {pairTest(raw, p), testedManifold(raw, p, old ? &old->manifold : nullptr)};
}
bool recyclable(const Kept& old, const PairPose& p, Real tolerance) {
  return recyclable(old.test, old.manifold.count, p, tolerance);
}
Manifold updateManifold(const PairPose& p, const Manifold* old) {
  return testedManifold(collide(kBrick, kBrick, p), p, old);
}
Manifold fresh(const PairPose& p) { return updateManifold(p, nullptr); }

/// Gives each point distinct multipliers.
void load(Manifold& m) {
  for (int k = 0; k < m.count; ++k) {
    m.lambdaN[k] = 10 + k, m.lambda1[k] = 1 + k, m.lambda2[k] = -1 - k;
    m.kN[k] = 100 + k, m.kT[k] = 200 + k;
    m.drift1[k] = .001 * (k + 1), m.drift2[k] = .002 * (k + 1);
  }
  m.stick = 0b0101;
}

Vec3 worldVector(const Manifold& m, Real l1, Real l2) {
  Vec3 t1, t2;
  tangentBasis(m.normal, t1, t2);
  return t1 * l1 + t2 * l2;
}

/// The point of `m` whose place on A is nearest to that of point k of `old`.
int nearestTo(const Manifold& m, const Manifold& old, int k) {
  int best = 0;
  for (int j = 1; j < m.count; ++j)
    if (length(pointOnA(m, j) - pointOnA(old, k)) < length(pointOnA(m, best) - pointOnA(old, k))) best = j;
  return best;
}

TEST(Manifold, KeepsPointsInTheFramesOfTheirBodies) {
  Random random(1);
  const Quat qA = random.rotation(), qB = qA * fromAxisAngle(Vec3{0, 0, 1}, .2);
  const PairPose p = pose(qA, qB, rotate(qA, Vec3{.1, .05, .249}));
  const RawManifold raw = collide(kBrick, p.qA, kBrick, p.qB, p.t, p.margin, p.length);
  const Manifold m = newManifold(raw, p);
  ASSERT_EQ(m.count, raw.count);
  for (int k = 0; k < m.count; ++k) {
    EXPECT_TRUE(test::near(rotate(qA, pointOnA(m, k)), raw.points[k].onA, 1e-12));
    EXPECT_TRUE(test::near(p.t + rotate(qB, pointOnB(m, k)), raw.points[k].onB, 1e-12));
    EXPECT_EQ(m.feature[k], raw.points[k].feature);
    EXPECT_EQ(m.kN[k], 0);
  }
  EXPECT_TRUE(test::near(rotate(m.normalOnB ? qB : qA, m.localNormal), raw.n, 1e-12));
}

TEST(Manifold, MatchedByFeatureKeepsEverything) {
  Manifold old = fresh(stacked());
  ASSERT_EQ(old.count, 4);
  load(old);
  const Manifold m = updateManifold(stacked(.25), &old);
  ASSERT_EQ(m.count, 4);
  EXPECT_FALSE(m.recycled);
  for (int k = 0; k < 4; ++k) {
    int from = -1;
    for (int j = 0; j < 4; ++j)
      if (old.feature[j] == m.feature[k]) from = j;
    ASSERT_GE(from, 0);
    EXPECT_EQ(m.lambdaN[k], old.lambdaN[from]);
    EXPECT_NEAR(m.lambda1[k], old.lambda1[from], 1e-12);
    EXPECT_NEAR(m.lambda2[k], old.lambda2[from], 1e-12);
    EXPECT_NEAR(m.drift1[k], old.drift1[from], 1e-15);
    EXPECT_EQ(m.kN[k], old.kN[from]);
    EXPECT_EQ(m.kT[k], old.kT[from]);
    EXPECT_EQ(m.stick >> k & 1, old.stick >> from & 1);
  }
}

TEST(Manifold, MatchesByPlaceWhenFeaturesFlicker) {
  Manifold old = fresh(stacked());
  load(old);
  for (int k = 0; k < 4; ++k) old.feature[k] += 7;  // nothing matches by feature
  const Manifold m = updateManifold(stacked(.201), &old);
  ASSERT_EQ(m.count, 4);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(m.lambdaN[nearestTo(m, old, k)], old.lambdaN[k]);
}

TEST(Manifold, AlignedBricksKeepTheirLoadUnderTinyTurns) {
  // equal bricks edge on edge: any turn changes which edges cut one another
  Random random(2);
  Manifold m = fresh(pose(Quat{}, Quat{}, {0, 0, .25}));
  ASSERT_EQ(m.count, 4);
  load(m);
  for (int n = 0; n < 200; ++n) {
    const PairPose p = pose(expRotation(random.vector(1e-5)), expRotation(random.vector(1e-5)),
                            {random.uniform(-1e-5, 1e-5), random.uniform(-1e-5, 1e-5), .25});
    m = updateManifold(p, &m);
    ASSERT_EQ(m.count, 4);
    Real sum = 0;
    for (int k = 0; k < 4; ++k) sum += m.lambdaN[k];
    ASSERT_EQ(sum, 10 + 11 + 12 + 13) << n;
  }
}

TEST(Manifold, FarPointsAndTurnedNormalsAreNew) {
  Manifold old = fresh(stacked());
  load(old);
  for (int k = 0; k < 4; ++k) old.feature[k] += 7;
  // the other way: every corner of the overlap is another one, on both bricks
  const Manifold moved = updateManifold(stacked(-.2), &old);
  ASSERT_EQ(moved.count, 4);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(moved.kN[k], 0);
  Manifold turned = fresh(stacked());
  load(turned);
  turned.normal = normalize(Vec3{1, 0, 1});
  const Manifold m = updateManifold(stacked(), &turned);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(m.kN[k], 0);
}

TEST(Manifold, EachOldPointIsMatchedOnce) {
  Manifold old = fresh(stacked());
  load(old);
  for (int k = 0; k < 4; ++k) old.feature[k] = old.feature[0];
  const Manifold m = updateManifold(stacked(.201), &old);
  Real sum = 0;
  for (int k = 0; k < 4; ++k) sum += m.lambdaN[k];
  EXPECT_LE(sum, 10 + 11 + 12 + 13);
}

TEST(TransferLoad, KeepsTheWorldTangentialVectorAsFarAsItLiesInTheNewPlane) {
  Random random(3);
  for (int n = 0; n < 100; ++n) {
    Manifold old = fresh(stacked()), m = old;
    load(old);
    // across the half sphere where the basis jumps, too
    old.normal = normalize(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-.1, .1)});
    m.normal = normalize(old.normal + random.vector(.2));
    transferLoad(old, 2, m, 1);
    const Vec3 before = worldVector(old, old.lambda1[2], old.lambda2[2]),
               after = worldVector(m, m.lambda1[1], m.lambda2[1]);
    EXPECT_TRUE(test::near(after, before - m.normal * dot(m.normal, before), 1e-12));
    const Vec3 drift = worldVector(old, old.drift1[2], old.drift2[2]),
               carried = worldVector(m, m.drift1[1], m.drift2[1]);
    EXPECT_TRUE(test::near(carried, drift - m.normal * dot(m.normal, drift), 1e-14));
  }
}

TEST(Recycling, KeepsAManifoldThatHardlyMovedAndTurnsItsNormal) {
  Kept before = update(stacked(), nullptr, 0);
  load(before.manifold);
  const Manifold& old = before.manifold;
  const Quat turn = fromAxisAngle(Vec3{0, 1, 0}, .3);
  const PairPose p = pose(turn, turn, rotate(turn, Vec3{.2001, .1, .25}));
  const Manifold m = update(p, &before, 2e-3).manifold;
  EXPECT_TRUE(m.recycled);
  EXPECT_TRUE(test::near(m.normal, rotate(turn, Vec3{0, 0, 1}), 1e-12));
  EXPECT_EQ(m.count, old.count);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(m.feature[k], old.feature[k]);
    EXPECT_EQ(m.lambdaN[k], old.lambdaN[k]);
    EXPECT_EQ(m.stick >> k & 1, old.stick >> k & 1);
    // the tangential vector keeps its world direction
    const Vec3 before = worldVector(old, old.lambda1[k], old.lambda2[k]);
    EXPECT_TRUE(test::near(worldVector(m, m.lambda1[k], m.lambda2[k]),
                           before - m.normal * dot(m.normal, before), 1e-12));
  }
}

TEST(Recycling, MeasuresFromTheLastFullTestAndNotFromTheLastStep) {
  Kept pair = update(stacked(), nullptr, 0);
  const Real tolerance = 2e-3, step = .3 * tolerance * stacked().length;
  int tests = 0;
  for (int i = 1; i <= 20; ++i) {
    pair = update(stacked(.2 + i * step), &pair, tolerance);
    tests += !pair.manifold.recycled;
  }
  // one in four: 0.3, 0.6, 0.9 are kept, 1.2 is tested
  EXPECT_EQ(tests, 5);
}

TEST(Recycling, TestsAnewAfterAMoveOrATurnBeyondTheTolerance) {
  const Real tolerance = 2e-3;
  const Kept m = update(stacked(), nullptr, 0);
  const Real length = stacked().length;
  EXPECT_TRUE(recyclable(m, stacked(.2 + .9 * tolerance * length), tolerance));
  EXPECT_FALSE(recyclable(m, stacked(.2 + 1.1 * tolerance * length), tolerance));
  const auto turned = [&](Real angle) {
    return pose(Quat{}, fromAxisAngle(Vec3{0, 0, 1}, angle), stacked().t);
  };
  EXPECT_TRUE(recyclable(m, turned(.9 * tolerance), tolerance));
  EXPECT_FALSE(recyclable(m, turned(1.1 * tolerance), tolerance));
}

TEST(Recycling, PairsApartAreTestedAnewUnlessFarEnough) {
  const Real tolerance = 2e-3;
  const Real slack = 2 * tolerance * stacked().length;
  const auto apart = [&](Real gap) { return pose(Quat{}, Quat{}, {0, 0, .25 + gap}); };
  const Kept near = update(apart(.02 + .5 * slack), nullptr, 0),
             far = update(apart(.02 + 1.5 * slack), nullptr, 0);
  ASSERT_EQ(near.manifold.count + far.manifold.count, 0);
  EXPECT_FALSE(recyclable(near, apart(.02 + .5 * slack), tolerance));
  EXPECT_TRUE(recyclable(far, apart(.02 + 1.5 * slack), tolerance));
}

TEST(Recycling, WithoutToleranceIsOff) {
  const Kept old = update(stacked(), nullptr, 0);
  EXPECT_FALSE(update(stacked(), &old, 0).manifold.recycled);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
