/// The general convex test against brute force: the separation over many directions, points of contact,
/// closed forms of flat contact.
#include <collision/parts.h>

#include <numbers>

#include "tests/collision/shapes_for_tests.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

struct ConvexCase {
  ShapeData a, b;
  Quat qA, qB;
  Vec3 t;

  RawManifold collide(const Shelf& shelf, Real margin) const {
    return collideParts(shelf.tables(), {a, qA, {0, 0, 0}}, {b, qB, {0, 0, 0}}, t, margin, size());
  }
  Real size() const { return 2 * std::min(boundingRadius(a), boundingRadius(b)); }
};

Real separationOver(const Shelf& shelf, const ConvexCase& x, const Vec3& n) {
  const Convex a = convexOf(shelf.tables(), x.a), b = convexOf(shelf.tables(), x.b);
  const Real ra = dot(n, rotate(x.qA, support(a, rotateInverse(x.qA, n)))),
             rb = -dot(n, rotate(x.qB, support(b, rotateInverse(x.qB, -n))));
  return dot(n, x.t) - ra - rb - a.radius - b.radius;
}

/// The largest separation over all directions: from each of many, uphill in ever smaller steps.
Real bruteSeparation(const Shelf& shelf, const ConvexCase& x, Random& random) {
  Real best = -1e30;
  for (int start = 0; start < 60; ++start) {
    Vec3 n = random.direction();
    Real s = separationOver(shelf, x, n);
    for (Real step = .5; step > 1e-7; step *= .6)
      for (int k = 0; k < 12; ++k) {
        const Vec3 other = normalize(n + random.vector(step));
        const Real so = separationOver(shelf, x, other);
        if (so > s) s = so, n = other;
      }
    best = std::max(best, s);
  }
  return best;
}

std::vector<Vec3> randomPoints(Random& random, int count, double size) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back(mul(random.direction(), Vec3{size, .8 * size, .6 * size}));
  return points;
}

std::vector<ShapeData> everyKind(Shelf& shelf, Random& random) {
  return {sphere(.3),
          capsule(.2, .3),
          box({.3, .2, .4}),
          shelf.add(Shape::box({.3, .25, .2}, .05)),
          shelf.add(Shape::cylinder(.25, .3)),
          shelf.add(Shape::cylinder(.3, .2, .04)),
          shelf.add(Shape::cone(.3, .3)),
          shelf.add(Shape::hull(randomPoints(random, 20, .4))),
          shelf.add(Shape::hull({{0, 0, .4}, {.4, 0, -.2}, {-.3, .3, -.2}, {-.2, -.4, -.2}}))};
}

TEST(ConvexPair, SeparatesAsFarAsAnyDirectionDoes) {
  Random random(41);
  Shelf shelf;
  const std::vector<ShapeData> shapes = everyKind(shelf, random);
  int apart = 0, touching = 0;
  for (int round = 0; round < 260; ++round) {
    ConvexCase x{shapes[static_cast<std::size_t>(random.below(9))],
                 shapes[static_cast<std::size_t>(3 + random.below(6))],
                 random.rotation(),
                 random.rotation(),
                 {}};
    // near touching along a random direction
    const Vec3 d = random.direction();
    x.t = d * (-separationOver(shelf, {x.a, x.b, x.qA, x.qB, {0, 0, 0}}, d) + random.uniform(-.15, .02));
    const Real exact = bruteSeparation(shelf, x, random);
    const Real margin = .02;
    const RawManifold m = x.collide(shelf, margin);
    const Real slack = .012 * x.size();
    if (m.count == 0) {
      EXPECT_GT(exact, margin - 1e-3 * x.size()) << round;
      EXPECT_LE(m.separation, exact + 1e-4 * x.size()) << round;
      ++apart;
      continue;
    }
    ++touching;
    EXPECT_NEAR(length(m.n), 1, 1e-9);
    // an edge may lose against a face by the stated preference, and by no more
    EXPECT_GE(separationOver(shelf, x, m.n), exact - slack - .05 * std::fabs(exact))
        << round << " kinds " << static_cast<int>(x.a.kind) << " " << static_cast<int>(x.b.kind);
    EXPECT_NEAR(-deepest(m), separationOver(shelf, x, m.n), .03 * x.size())
        << round << " kinds " << static_cast<int>(x.a.kind) << " " << static_cast<int>(x.b.kind)
        << " feature " << m.points[0].feature;
    for (int k = 0; k < m.count; ++k) EXPECT_LE(-depthOf(m, k), margin + 1e-9);
  }
  EXPECT_GT(apart, 20);
  EXPECT_GT(touching, 100);
}

TEST(ConvexPair, AHullOfABoxTouchesLikeTheBox) {
  Random random(42);
  Shelf shelf;
  for (int round = 0; round < 200; ++round) {
    const PairCase boxes = randomBoxes(random);
    const auto hullOf = [&](const ShapeData& s) {
      std::vector<rubble::Vec3> points;
      for (int k = 0; k < 8; ++k)
        points.push_back(
            {(k & 1) ? s.half.x : -s.half.x, (k & 2) ? s.half.y : -s.half.y, (k & 4) ? s.half.z : -s.half.z});
      return shelf.add(Shape::hull(points));
    };
    const RawManifold expected = boxes.collide(.02);
    const ConvexCase x{hullOf(boxes.a), hullOf(boxes.b), boxes.qA, boxes.qB, boxes.t};
    const RawManifold got = x.collide(shelf, .02);
    if (expected.count == 0 || got.count == 0 || separationAlong(boxes, expected.n) < -.1 * boxes.length())
      continue;
    const Real a = separationAlong(boxes, expected.n), b = separationAlong(boxes, got.n);
    EXPECT_NEAR(a, b, .011 * boxes.length() + .05 * std::fabs(a)) << round;
    if (dot(expected.n, got.n) > 1 - 1e-9) {
      EXPECT_EQ(expected.count, got.count) << round;
    }
  }
}

TEST(ConvexPair, FlatContactHasFourPointsAtTheDepthOfTheOverlap) {
  Random random(43);
  Shelf shelf;
  const ShapeData slab = box({2, 2, .1});
  // what stands on its base, and how high its center of mass is over it
  const std::vector<std::pair<ShapeData, Real>> standing = {
      {shelf.add(Shape::cylinder(.25, .3)), .3},
      {shelf.add(Shape::cone(.3, .4)), .2},
      {shelf.add(Shape::hull({{-.3, -.3, 0}, {.3, -.3, 0}, {.3, .3, 0}, {-.3, .3, 0}, {0, 0, .8}})), .2},
      {shelf.add(Shape::box({.3, .2, .25}, .05)), .25}};
  for (const auto& [shape, height] : standing)
    for (int round = 0; round < 20; ++round) {
      const Quat turn = fromAxisAngle(Vec3{0, 0, 1}, random.uniform(0, 6));
      const Vec3 t{random.uniform(-1, 1), random.uniform(-1, 1), .1 + height - .001};
      const RawManifold m = ConvexCase{slab, shape, Quat{}, turn, t}.collide(shelf, .01);
      ASSERT_EQ(m.count, 4);
      EXPECT_TRUE(test::near(m.n, Vec3{0, 0, 1}, 1e-9));
      for (int k = 0; k < 4; ++k) EXPECT_NEAR(depthOf(m, k), .001, 1e-9);
      const RawManifold p = collideParts(shelf.tables(), {shape, turn, {0, 0, 0}},
                                         {plane(), Quat{}, {0, 0, 0}}, Vec3{0, 0, -height + .001}, .01, .6);
      ASSERT_EQ(p.count, 4);
      for (int k = 0; k < 4; ++k) EXPECT_NEAR(depthOf(p, k), .001, 1e-9);
    }
}

TEST(ConvexPair, ADiscHasAPointWhereItsWeightActs) {
  Random random(45);
  Shelf shelf;
  const ShapeData slab = box({2, 2, .1});
  for (const auto& [shape, height] : std::vector<std::pair<ShapeData, Real>>{
           {shelf.add(Shape::cylinder(.25, .3)), .3}, {shelf.add(Shape::cone(.25, .4)), .2}})
    for (int round = 0; round < 50; ++round) {
      const Real way = random.uniform(0, 6), slope = random.uniform(.5, .8);
      const Vec3 side{std::cos(way), std::sin(way), 0},
          down = side * std::sin(slope) + Vec3{0, 0, -std::cos(slope)};
      const PlacedPart standing{shape, fromAxisAngle(Vec3{0, 0, 1}, random.uniform(0, 6)), {0, 0, 0}};
      for (const auto& [ground, top] : std::vector<std::pair<ShapeData, Real>>{{slab, .1}, {plane(), 0}}) {
        const RawManifold m = collideParts(shelf.tables(), {ground, Quat{}, {0, 0, 0}}, standing,
                                           {0, 0, top + height}, .01, .6, down);
        ASSERT_EQ(m.count, 4);
        Real furthest = 0;
        for (int k = 0; k < 4; ++k) furthest = std::max(furthest, dot(side, m.points[k].onB));
        EXPECT_NEAR(furthest, .25, 1e-6) << round;
      }
    }
}

TEST(ConvexPair, ALyingCylinderHasBothEndsOfItsLine) {
  Shelf shelf;
  const ShapeData cylinder = shelf.add(Shape::cylinder(.25, .3));
  const Quat lying = fromAxisAngle(Vec3{1, 0, 0}, std::numbers::pi / 2);
  for (const Real spin : {0., .1, .7, 2.}) {
    const Quat q = lying * fromAxisAngle(Vec3{0, 0, 1}, spin);
    const RawManifold m = ConvexCase{box({2, 2, .1}), cylinder, Quat{}, q, {.1, .2, .35 - 1e-4}}.collide(
        shelf, .01);
    ASSERT_EQ(m.count, 2);
    EXPECT_NEAR(std::fabs(m.points[0].onB.y - m.points[1].onB.y), .6, 1e-9);
    for (int k = 0; k < 2; ++k) EXPECT_NEAR(m.points[k].onB.x, .1, 1e-9);
  }
}

TEST(ConvexPair, TurnsWithTheWorld) {
  Random random(44);
  Shelf shelf;
  const std::vector<ShapeData> shapes = everyKind(shelf, random);
  for (int round = 0; round < 100; ++round) {
    ConvexCase x{shapes[static_cast<std::size_t>(random.below(9))],
                 shapes[static_cast<std::size_t>(3 + random.below(6))],
                 random.rotation(),
                 random.rotation(),
                 {}};
    const Vec3 d = random.direction();
    x.t = d * (-separationOver(shelf, {x.a, x.b, x.qA, x.qB, {0, 0, 0}}, d) - .01);
    const Quat turn = random.rotation();
    const RawManifold m = x.collide(shelf, .02),
                      n = ConvexCase{x.a, x.b, turn * x.qA, turn * x.qB, rotate(turn, x.t)}.collide(shelf,
                                                                                                    .02);
    ASSERT_EQ(m.count, n.count) << round;
    if (m.count == 0) continue;
    EXPECT_TRUE(test::near(rotate(turn, m.n), n.n, 1e-4)) << round;
    EXPECT_NEAR(deepest(m), deepest(n), 1e-5) << round;
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
