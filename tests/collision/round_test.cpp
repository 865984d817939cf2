/// Spheres, capsules and half spaces: analytic cases and brute force over points of the axes.
#include "tests/collision/shapes_for_tests.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;
constexpr Real kQuarter = 1.5707963267948966;
const Quat kAlongX = fromAxisAngle(Vec3{0, 1, 0}, kQuarter);  ///< lays a capsule along x

TEST(SphereSphere, TouchesAlongTheLineOfCenters) {
  Random random(1);
  for (const Real gap : {-.3, 0., .01}) {
    const Vec3 d = random.direction();
    const PairCase x{sphere(.5), sphere(.8), random.rotation(), random.rotation(), (1.3 + gap) * d};
    const RawManifold m = x.collide(.02);
    ASSERT_EQ(m.count, 1);
    EXPECT_TRUE(test::near(m.n, d, 1e-12));
    EXPECT_NEAR(depthOf(m, 0), -gap, 1e-12);
    EXPECT_TRUE(hasPoint(m, .5 * d, (.5 + gap) * d, 1e-12));
  }
}

TEST(SphereSphere, ApartGivesItsDistance) {
  const PairCase x{sphere(.5), sphere(.8), Quat{}, Quat{}, {0, 2, 0}};
  EXPECT_EQ(x.collide(.02).count, 0);
  EXPECT_NEAR(x.collide(.02).separation, .7, 1e-14);
}

TEST(SphereSphere, OfOneCenterAreSeparated) {
  const PairCase x{sphere(.5), sphere(.8), Quat{}, Quat{}, {0, 0, 0}};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(length(m.n), 1, 1e-14);
  EXPECT_NEAR(depthOf(m, 0), 1.3, 1e-14);
}

TEST(SphereBox, TouchesFaceEdgeAndCorner) {
  const Vec3 h{1, 2, 3};
  // outward directions: a face, an edge, a corner
  for (const Vec3 out : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{1, 1, 0}, Vec3{0, -1, 1}, Vec3{1, -1, 1}}) {
    const Vec3 corner = mul(out, h), d = normalize(out);
    const PairCase x{sphere(.5), box(h), Quat{}, Quat{}, -(corner + .49 * d)};
    const RawManifold m = x.collide(.02);
    ASSERT_EQ(m.count, 1);
    EXPECT_TRUE(test::near(m.n, -d, 1e-12));
    EXPECT_TRUE(hasPoint(m, -.5 * d, -.49 * d, 1e-12));
  }
}

TEST(SphereBox, WithItsCenterInsideIsPushedOutOfTheNearestFace) {
  const PairCase x{sphere(.5), box({1, 2, 3}), Quat{}, Quat{}, {-.9, 0, 0}};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 1);
  EXPECT_TRUE(test::near(m.n, Vec3{-1, 0, 0}, 1e-12));
  EXPECT_NEAR(depthOf(m, 0), .6, 1e-12);
}

TEST(SpherePlane, TouchesAtItsFoot) {
  Random random(2);
  const Quat q = random.rotation();
  const Vec3 up = rotate(q, Vec3{0, 0, 1}), along = rotate(q, Vec3{3, 4, 0});
  const PairCase x{sphere(.5), plane(), random.rotation(), q, -.45 * up + along};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 1);
  EXPECT_TRUE(test::near(m.n, -up, 1e-12));
  EXPECT_TRUE(hasPoint(m, -.5 * up, -.45 * up, 1e-12));
}

TEST(CapsulePlane, LyingTouchesAtBothEndsStandingAtOne) {
  const PairCase lying{capsule(.2, 1), plane(), kAlongX, Quat{}, {0, 0, -.19}};
  const RawManifold m = lying.collide(.02);
  ASSERT_EQ(m.count, 2);
  EXPECT_TRUE(hasPoint(m, {1, 0, -.2}, {1, 0, -.19}, 1e-12));
  EXPECT_TRUE(hasPoint(m, {-1, 0, -.2}, {-1, 0, -.19}, 1e-12));
  EXPECT_NE(m.points[0].feature, m.points[1].feature);
  const PairCase standing{capsule(.2, 1), plane(), Quat{}, Quat{}, {0, 0, -1.19}};
  ASSERT_EQ(standing.collide(.02).count, 1);
  EXPECT_NEAR(depthOf(standing.collide(.02), 0), .01, 1e-12);
}

TEST(BoxPlane, TouchesWithFourTwoOrOneCorner) {
  const ShapeData cube = box({.5, .5, .5});
  const PairCase flat{cube, plane(), Quat{}, Quat{}, {0, 0, -.5}};
  EXPECT_EQ(flat.collide(.02).count, 4);
  const PairCase onEdge{
      cube, plane(), fromAxisAngle(Vec3{1, 0, 0}, kQuarter / 2), Quat{}, {0, 0, -std::sqrt(.5)}};
  ASSERT_EQ(onEdge.collide(.02).count, 2);
  EXPECT_NEAR(deepest(onEdge.collide(.02)), 0, 1e-12);
  const Vec3 corner = normalize(Vec3{1, 1, 1});
  const Quat onCornerTurn = fromAxisAngle(normalize(cross(corner, Vec3{0, 0, -1})),
                                          std::acos(dot(corner, Vec3{0, 0, -1})));
  const PairCase onCorner{cube, plane(), onCornerTurn, Quat{}, {0, 0, -std::sqrt(.75)}};
  ASSERT_EQ(onCorner.collide(.02).count, 1);
  EXPECT_NEAR(depthOf(onCorner.collide(.02), 0), 0, 1e-12);
}

TEST(BoxPlane, DeepestPointIsTheLowestCorner) {
  Random random(3);
  for (int n = 0; n < 200; ++n) {
    const Quat q = random.rotation();
    PairCase x{box({.3, .5, .7}), plane(), random.rotation(), q, {}};
    const Vec3 up = rotate(q, Vec3{0, 0, 1});
    const Real depth = random.uniform(0, .1);
    x.t = -(reach(x.a, x.qA, up) - depth) * up;
    const RawManifold m = x.collide(.02);
    ASSERT_GT(m.count, 0);
    EXPECT_NEAR(deepest(m), depth, 1e-12);
    for (int k = 0; k < m.count; ++k) {
      EXPECT_NEAR(dot(m.points[k].onB - x.t, up), 0, 1e-12);
      EXPECT_NEAR(outside(x.a, x.qA, m.points[k].onA), 0, 1e-12);
    }
  }
}

TEST(CapsuleCapsule, CrossedTouchesAtOnePoint) {
  const PairCase x{
      capsule(.2, 1), capsule(.3, 1), kAlongX, fromAxisAngle(Vec3{1, 0, 0}, kQuarter), {.4, -.3, .49}};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 1);
  EXPECT_TRUE(test::near(m.n, Vec3{0, 0, 1}, 1e-9));
  EXPECT_TRUE(hasPoint(m, {.4, 0, .2}, {.4, 0, .19}, 1e-9));
}

TEST(CapsuleCapsule, ParallelTouchesAtTheEndsOfTheCommonPart) {
  const PairCase x{capsule(.2, 1), capsule(.2, 1), kAlongX, kAlongX, {.5, 0, .39}};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 2);
  EXPECT_TRUE(hasPoint(m, {-.5, 0, .2}, {-.5, 0, .19}, 1e-9));
  EXPECT_TRUE(hasPoint(m, {1, 0, .2}, {1, 0, .19}, 1e-9));
}

TEST(CapsuleCapsule, EndToEndTouchesAtOnePoint) {
  const PairCase x{capsule(.2, 1), capsule(.2, 1), Quat{}, Quat{}, {0, 0, 2.39}};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 1);
  EXPECT_TRUE(hasPoint(m, {0, 0, 1.2}, {0, 0, 1.19}, 1e-9));
}

TEST(CapsuleBox, LyingOnAFaceTouchesAtBothEndsOfTheSupportedPart) {
  const PairCase x{capsule(.2, 1), box({.5, .5, .5}), kAlongX, Quat{}, {.3, 0, -.69}};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 2);
  EXPECT_TRUE(test::near(m.n, Vec3{0, 0, -1}, 1e-12));
  EXPECT_TRUE(hasPoint(m, {-.2, 0, -.2}, {-.2, 0, -.19}, 1e-9));
  EXPECT_TRUE(hasPoint(m, {.8, 0, -.2}, {.8, 0, -.19}, 1e-9));
}

TEST(CapsuleBox, StandingOnAFaceTouchesAtOnePoint) {
  const PairCase x{capsule(.2, 1), box({.5, .5, .5}), Quat{}, Quat{}, {.1, .2, -1.69}};
  const RawManifold m = x.collide(.02);
  ASSERT_EQ(m.count, 1);
  EXPECT_TRUE(hasPoint(m, {0, 0, -1.2}, {0, 0, -1.19}, 1e-9));
}

/// Smallest distance between two sets of points that lie densely on the cores.
Real bruteDistance(const PairCase& x, int samples) {
  Real best = 1e30;
  const Vec3 ha = rotate(x.qA, x.a.half), hb = rotate(x.qB, x.b.half);
  for (int i = 0; i <= samples; ++i) {
    const Vec3 a = ha * (2. * i / samples - 1);
    if (x.b.kind == ShapeKind::Box) {
      const Vec3 local = rotateInverse(x.qB, a - x.t);
      const Vec3 nearest{clamp(local.x, -x.b.half.x, x.b.half.x), clamp(local.y, -x.b.half.y, x.b.half.y),
                         clamp(local.z, -x.b.half.z, x.b.half.z)};
      best = std::min(best, length(local - nearest));
      continue;
    }
    for (int j = 0; j <= samples; ++j) best = std::min(best, length(x.t + hb * (2. * j / samples - 1) - a));
  }
  return best - x.a.radius - (x.b.kind == ShapeKind::Box ? 0 : x.b.radius);
}

TEST(RoundShapes, FindTheNearestPointsOfCapsules) {
  Random random(4);
  int touching = 0;
  for (int n = 0; n < 200; ++n) {
    const PairCase x{capsule(.2, random.uniform(.3, 1.5)), capsule(.3, random.uniform(.3, 1.5)),
                     random.rotation(), random.rotation(), random.vector()};
    const Real brute = bruteDistance(x, 200);
    const RawManifold m = x.collide(.05);
    EXPECT_NEAR(m.separation, brute, 2e-4 + (brute < -.4 ? .1 : 0));
    if (brute > .051) {
      EXPECT_EQ(m.count, 0);
    } else if (brute < .049) {
      ++touching;
      EXPECT_GT(m.count, 0);
    }
  }
  EXPECT_GT(touching, 50);
}

TEST(RoundShapes, FindTheNearestPointsOfCapsuleAndBox) {
  Random random(5);
  int touching = 0;
  for (int n = 0; n < 600; ++n) {
    const PairCase x{capsule(.2, random.uniform(.3, 1.5)), box({.4, .6, .3}), random.rotation(),
                     random.rotation(), random.vector(1.5)};
    const Real brute = bruteDistance(x, 4000);
    if (brute < -.199) continue;  // the axis is inside
    const RawManifold m = x.collide(.05);
    EXPECT_NEAR(m.separation, brute, 5e-6);
    if (brute > .05) continue;
    ++touching;
    ASSERT_GT(m.count, 0);
    for (int k = 0; k < m.count; ++k) {
      EXPECT_LE(depthOf(m, k), -brute + 5e-6);
      EXPECT_NEAR(outside(x.b, x.qB, m.points[k].onB - x.t), 0, 1e-9);
    }
  }
  EXPECT_GT(touching, 50);
}

TEST(AnyPair, SwappedGivesTheSamePoints) {
  Random random(6);
  const ShapeData shapes[] = {sphere(.4), capsule(.2, .6), box({.3, .4, .5}), plane()};
  int compared = 0;
  for (const ShapeData& a : shapes)
    for (const ShapeData& b : shapes) {
      if (a.kind == b.kind) continue;
      for (int n = 0; n < 50; ++n) {
        const PairCase x{a, b, random.rotation(), random.rotation(), random.vector(.7)};
        const RawManifold m = x.collide(.05), s = x.swapped().collide(.05);
        ASSERT_EQ(m.count, s.count);
        EXPECT_NEAR(m.separation, s.separation, 1e-12);
        if (m.count == 0) continue;
        ++compared;
        EXPECT_TRUE(test::near(m.n, -s.n, 1e-12));
        EXPECT_EQ(m.normalOnB, !s.normalOnB);
        for (int k = 0; k < m.count; ++k)
          EXPECT_TRUE(hasPoint(s, m.points[k].onB - x.t, m.points[k].onA - x.t, 1e-12));
      }
    }
  EXPECT_GT(compared, 200);
}

TEST(AnyPair, TurnsWithTheWorld) {
  Random random(7);
  const ShapeData shapes[] = {sphere(.4), capsule(.2, .6), box({.3, .4, .5}), plane()};
  for (const ShapeData& a : shapes)
    for (const ShapeData& b : shapes) {
      if (a.kind == ShapeKind::Box && b.kind == ShapeKind::Box) continue;
      for (int n = 0; n < 50; ++n) {
        const PairCase x{a, b, random.rotation(), random.rotation(), random.vector(.7)};
        const Quat turn = random.rotation();
        const RawManifold m = x.collide(.05), r = x.turned(turn).collide(.05);
        ASSERT_EQ(m.count, r.count);
        for (int k = 0; k < m.count; ++k)
          EXPECT_TRUE(hasPoint(r, rotate(turn, m.points[k].onA), rotate(turn, m.points[k].onB), 1e-7));
      }
    }
}

TEST(AnyPair, OfTwoPlanesNeverTouches) {
  const PairCase x{plane(), plane(), Quat{}, kAlongX, {0, 0, 0}};
  EXPECT_EQ(x.collide(1).count, 0);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
