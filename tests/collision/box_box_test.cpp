/// Box against box: brute force over directions, analytic cases, invariances.
#include "tests/collision/shapes_for_tests.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// Largest separation over the fifteen axes.
Real bestOverAxes(const PairCase& x) {
  const Mat3 ra = rotationMatrix(x.qA), rb = rotationMatrix(x.qB);
  Real best = -1e30;
  const auto take = [&](const Vec3& axis) {
    best = std::max({best, separationAlong(x, axis), separationAlong(x, -axis)});
  };
  for (int i = 0; i < 3; ++i) {
    take(ra.column(i));
    take(rb.column(i));
    for (int j = 0; j < 3; ++j) take(normalize(cross(ra.column(i), rb.column(j)), ra.column(i)));
  }
  return best;
}

/// The same, and a check that no random direction beats it where the boxes overlap.
Real bestSeparation(const PairCase& x, Random& random) {
  const Real best = bestOverAxes(x);
  for (int i = 0; best < 0 && i < 300; ++i) EXPECT_LE(separationAlong(x, random.direction()), best + 1e-12);
  return best;
}

TEST(BoxBox, NormalSeparatesAboutAsFarAsAnyDirection) {
  Random random(1);
  int touching = 0, edges = 0;
  for (int n = 0; n < 2000; ++n) {
    const PairCase x = randomBoxes(random);
    const Real length = x.length(), margin = .02 * length, best = bestSeparation(x, random);
    const RawManifold m = x.collide(margin);
    if (best > margin) {
      EXPECT_EQ(m.count, 0);
      continue;
    }
    if (m.count == 0) continue;
    ++touching;
    EXPECT_NEAR(rubble::length(m.n), 1, 1e-12);
    // faces win near ties: against edges by 5 % of the separation and 0.01 L, those of A against those of B
    // by 0.001 L
    const Real allowed = .01 * length + .001 * length + .06 * std::fabs(best);
    EXPECT_GE(separationAlong(x, m.n), best - allowed);
    edges += m.points[0].feature >= 0x1000;
  }
  EXPECT_GT(touching, 500);
  EXPECT_GT(edges, 20);
}

TEST(BoxBox, OverlappingBoxesAlwaysHaveAPoint) {
  Random random(2);
  int overlapping = 0;
  for (int n = 0; n < 20000; ++n) {
    const PairCase x = randomBoxes(random);
    if (bestOverAxes(x) > 0) continue;
    ++overlapping;
    EXPECT_GT(x.collide(.02 * x.length()).count, 0) << "case " << n << ", overlap " << -bestOverAxes(x);
  }
  EXPECT_GT(overlapping, 5000);
}

TEST(BoxBox, PointsLieOnBothBoxesAtMostAMarginApart) {
  Random random(3);
  for (int n = 0; n < 2000; ++n) {
    const PairCase x = randomBoxes(random);
    const Real margin = .05 * x.length();
    const RawManifold m = x.collide(margin);
    ASSERT_LE(m.count, kLanes);
    for (int k = 0; k < m.count; ++k) {
      const RawPoint& p = m.points[k];
      EXPECT_NEAR(outside(x.a, x.qA, p.onA), 0, 1e-9);
      EXPECT_NEAR(outside(x.b, x.qB, p.onB - x.t), 0, 1e-9);
      EXPECT_LE(outside(x.a, x.qA, p.onB), margin + 1e-9);
      EXPECT_LE(outside(x.b, x.qB, p.onA - x.t), std::max(margin, depthOf(m, k)) + 1e-9);
      EXPECT_GE(depthOf(m, k), -margin - 1e-12);
      EXPECT_LE(depthOf(m, k), -separationAlong(x, m.n) + 1e-9);
    }
  }
}

TEST(BoxBox, DepthOfOverlappingAlignedBoxesIsTheirOverlap) {
  for (const Real depth : {-.01, 0., .01, .1}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const Real sign : {1., -1.}) {
        PairCase x{box({.5, .6, .7}), box({.3, .4, .2}), Quat{}, Quat{}, {}};
        x.t[axis] = sign * (x.a.half[axis] + x.b.half[axis] - depth);
        const RawManifold m = x.collide(.02);
        Vec3 normal;
        normal[axis] = sign;
        EXPECT_TRUE(test::near(m.n, normal, 1e-15));
        ASSERT_EQ(m.count, 4);
        for (int k = 0; k < 4; ++k) EXPECT_NEAR(depthOf(m, k), depth, 1e-14);
      }
    }
  }
}

TEST(BoxBox, BricksWithOffsetTouchAtTheFourCornersOfTheirOverlap) {
  for (const Vec3 offset : {Vec3{.5, 0, 0}, Vec3{.3, .1, 0}, Vec3{-.7, -.2, 0}, Vec3{0, 0, 0}}) {
    const Vec3 half{.5, .25, .125};
    const PairCase x{box(half), box(half), Quat{}, Quat{}, {offset.x, offset.y, .25}};
    const RawManifold m = x.collide(.02);
    ASSERT_EQ(m.count, 4);
    EXPECT_TRUE(test::near(m.n, Vec3{0, 0, 1}, 1e-15));
    const Real x0 = std::max(-.5, offset.x - .5), x1 = std::min(.5, offset.x + .5),
               y0 = std::max(-.25, offset.y - .25), y1 = std::min(.25, offset.y + .25);
    for (const Real cx : {x0, x1})
      for (const Real cy : {y0, y1})
        EXPECT_TRUE(hasPoint(m, {cx, cy, .125}, {cx, cy, .125}, 1e-12)) << cx << " " << cy;
  }
}

TEST(BoxBox, FacesWinNearTies) {
  // a cube laid on another with any yaw and a small tilt: edge axes separate nearly as far as the face
  Random random(4);
  for (int n = 0; n < 500; ++n) {
    const Quat tilt = fromAxisAngle(normalize(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), 0}),
                                    random.uniform(0, .01));
    const Quat qB = tilt * fromAxisAngle(Vec3{0, 0, 1}, random.uniform(0, 6));
    const PairCase x{box({.5, .5, .5}),
                     box({.5, .5, .5}),
                     Quat{},
                     qB,
                     {random.uniform(-.3, .3), random.uniform(-.3, .3), 1 - random.uniform(-.005, .005)}};
    const RawManifold m = x.collide(.035);
    EXPECT_EQ(m.count, 4);
    EXPECT_GT(std::max(std::fabs(m.n.z), std::fabs(dot(m.n, rotate(qB, Vec3{0, 0, 1})))), 1 - 1e-12);
  }
}

TEST(BoxBox, EightPointsAreReducedToFourThatSpanThem) {
  // a cube turned by 45 degrees on another: the overlap is an octagon
  const PairCase x{
      box({.5, .5, .5}), box({.5, .5, .5}), Quat{}, fromAxisAngle(Vec3{0, 0, 1}, .785398), {0, 0, 1}};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 4);
  Vec3 center;
  for (int k = 0; k < 4; ++k) {
    center += m.points[k].onA / 4.;
    for (int j = 0; j < k; ++j) EXPECT_GT(length(m.points[k].onA - m.points[j].onA), .3);
  }
  EXPECT_LT(length(center - Vec3{0, 0, .5}), .05);
}

TEST(BoxBox, ReductionKeepsADeepPointThatIsNoCorner) {
  for (const Real depth : {.1, 1e-4}) {
    boxes::ClipVertex p[boxes::kMaxVertices] = {
        {-1, -1, 0, 0, 0}, {1, -1, 0, 0, 1}, {1, .2, -depth, 0, 2}, {1, 1, 0, 0, 3}, {-1, 1, 0, 0, 4}};
    int count = 5;
    boxes::reduceToFour(p, count, 1, 1, 1);
    ASSERT_EQ(count, 4);
    bool kept = false;
    for (int k = 0; k < count; ++k) kept |= p[k].edgeOut == 2;
    // it stands out by a thousandth of the length, or it is left out
    EXPECT_EQ(kept, depth > 1e-3);
  }
}

TEST(BoxBox, CrossedEdgesTouchAtOnePoint) {
  // two cubes standing on edges that cross at a right angle
  const Quat qA = fromAxisAngle(Vec3{1, 0, 0}, .785398163397448),
             qB = fromAxisAngle(Vec3{0, 1, 0}, .785398163397448);
  const Real diagonal = std::sqrt(.5);
  const PairCase x{box({.5, .5, .5}), box({.5, .5, .5}), qA, qB, {.1, .2, 2 * diagonal - .01}};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 1);
  EXPECT_TRUE(test::near(m.n, Vec3{0, 0, 1}, 1e-9));
  EXPECT_TRUE(test::near(m.points[0].onA, Vec3{.1, 0, diagonal}, .21));
  EXPECT_NEAR(depthOf(m, 0), .01, 1e-9);
  EXPECT_TRUE(hasPoint(m, {.1, 0, diagonal}, {.1, 0, diagonal - .01}, 1e-9));
}

/// Poses whose result does not depend on a tie between the faces of A and B.
bool clearCut(const PairCase& x) {
  const Mat3 ra = rotationMatrix(x.qA), rb = rotationMatrix(x.qB);
  Real bestA = -1e30, bestB = -1e30;
  for (int i = 0; i < 3; ++i) {
    bestA = std::max({bestA, separationAlong(x, ra.column(i)), separationAlong(x, -ra.column(i))});
    bestB = std::max({bestB, separationAlong(x, rb.column(i)), separationAlong(x, -rb.column(i))});
  }
  return std::fabs(bestA - bestB) > .002 * x.length();
}

TEST(BoxBox, SwappingTheBoxesGivesTheSamePoints) {
  Random random(5);
  int compared = 0;
  for (int n = 0; n < 2000; ++n) {
    const PairCase x = randomBoxes(random);
    if (!clearCut(x)) continue;
    const RawManifold m = x.collide(.02), s = x.swapped().collide(.02);
    ASSERT_EQ(m.count, s.count);
    if (m.count == 0) continue;
    ++compared;
    EXPECT_TRUE(test::near(m.n, -s.n, 1e-9));
    for (int k = 0; k < m.count; ++k)
      EXPECT_TRUE(hasPoint(s, m.points[k].onB - x.t, m.points[k].onA - x.t, 1e-9));
  }
  EXPECT_GT(compared, 500);
}

TEST(BoxBox, TurnsWithTheWorld) {
  Random random(6);
  int compared = 0;
  for (int n = 0; n < 2000; ++n) {
    const PairCase x = randomBoxes(random);
    const Quat turn = random.rotation();
    const RawManifold m = x.collide(.02), r = x.turned(turn).collide(.02);
    ASSERT_EQ(m.count, r.count);
    EXPECT_NEAR(m.separation, r.separation, 1e-12);
    if (m.count == 0) continue;
    ++compared;
    EXPECT_TRUE(test::near(rotate(turn, m.n), r.n, 1e-9));
    EXPECT_EQ(features(m), features(r));
    for (int k = 0; k < m.count; ++k)
      EXPECT_TRUE(hasPoint(r, rotate(turn, m.points[k].onA), rotate(turn, m.points[k].onB), 1e-9));
  }
  EXPECT_GT(compared, 500);
}

TEST(BoxBox, FeaturesStayUnderTinyMotion) {
  Random random(7);
  int same = 0, compared = 0;
  for (int n = 0; n < 2000; ++n) {
    const PairCase x = randomBoxes(random);
    PairCase y = x;
    y.t += random.vector(1e-7);
    y.qB = expRotation(random.vector(1e-7)) * y.qB;
    const RawManifold m = x.collide(.02), r = y.collide(.02);
    if (m.count == 0) continue;
    ++compared;
    same += features(m) == features(r);
    for (int k = 1; k < m.count; ++k)
      for (int j = 0; j < k; ++j) EXPECT_NE(m.points[k].feature, m.points[j].feature);
  }
  EXPECT_GT(compared, 500);
  // a corner may happen to lie within 1e-7 of a side plane
  EXPECT_GE(same, compared - 2);
}

TEST(BoxBox, SeparationOfPairsApartIsALowerBound) {
  Random random(8);
  for (int n = 0; n < 500; ++n) {
    PairCase x = randomBoxes(random);
    x.t *= 1.3;
    const RawManifold m = x.collide(.01);
    if (m.count > 0) continue;
    const Real best = bestSeparation(x, random);
    EXPECT_LE(m.separation, best + 1e-12);
    EXPECT_GT(m.separation, .01);
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
