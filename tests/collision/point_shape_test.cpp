/// Distances of points against brute force over directions, and of points near surfaces of triangles against
/// the solids that these bound.
#include <collision/point_shape.h>

#include "tests/collision/shapes_for_tests.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// How far a point lies outside the supporting plane of a convex shape along n.
Real outsideAlong(const Shelf& shelf, const ShapeData& s, const Vec3& x, const Vec3& n) {
  const Convex c = convexOf(shelf.tables(), s);
  return dot(n, x - support(c, n)) - c.radius;
}

/// The signed distance of a convex shape is the largest of these: from each of many directions, uphill in
/// ever smaller steps.
Real bruteDistance(const Shelf& shelf, const ShapeData& s, const Vec3& x, Random& random) {
  Real best = -1e30;
  for (int start = 0; start < 40; ++start) {
    Vec3 n = random.direction();
    Real d = outsideAlong(shelf, s, x, n);
    for (Real step = .5; step > 1e-7; step *= .6)
      for (int k = 0; k < 12; ++k) {
        const Vec3 other = normalize(n + random.vector(step));
        const Real o = outsideAlong(shelf, s, x, other);
        if (o > d) d = o, n = other;
      }
    best = std::max(best, d);
  }
  return best;
}

TEST(PointDistance, OfConvexShapesIsTheLargestOverAllDirections) {
  Random random(11);
  Shelf shelf;
  std::vector<Vec3> cloud;
  for (int i = 0; i < 20; ++i) cloud.push_back(mul(random.direction(), Vec3{.4, .3, .25}));
  const std::vector<ShapeData> shapes = {
      sphere(.3),
      capsule(.2, .3),
      box({.3, .2, .4}),
      shelf.add(Shape::box({.3, .25, .2}, .05)),
      shelf.add(Shape::cylinder(.25, .3)),
      shelf.add(Shape::cylinder(.3, .2, .04)),
      shelf.add(Shape::cone(.3, .3)),
      shelf.add(Shape::cone(.1, .5)),
      shelf.add(Shape::hull(cloud)),
      shelf.add(Shape::hull(cloud, .03)),
      shelf.add(Shape::hull({{0, 0, .4}, {.4, 0, -.2}, {-.3, .3, -.2}, {-.2, -.4, -.2}}))};
  for (std::size_t k = 0; k < shapes.size(); ++k)
    for (int round = 0; round < 60; ++round) {
      const Vec3 x = random.vector(.7);
      const PointDistance at = pointToGeneralShape(shelf.tables(), shapes[k], x, {1, 1, {0, 0, 0}});
      // no direction gives more, and the reported one gives as much
      EXPECT_GE(at.distance, bruteDistance(shelf, shapes[k], x, random) - 1e-6) << k << " " << round;
      EXPECT_NEAR(outsideAlong(shelf, shapes[k], x, at.n), at.distance, 1e-5) << k << " " << round;
    }
}

/// A box as a closed mesh.
Shape meshBox(const Vec3& h) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back({(k & 1) ? h.x : -h.x, (k & 2) ? h.y : -h.y, (k & 4) ? h.z : -h.z});
  return Shape::mesh(corners, {{0, 2, 3},
                               {0, 3, 1},
                               {4, 5, 7},
                               {4, 7, 6},
                               {0, 1, 5},
                               {0, 5, 4},
                               {2, 6, 7},
                               {2, 7, 3},
                               {0, 4, 6},
                               {0, 6, 2},
                               {1, 3, 7},
                               {1, 7, 5}});
}

TEST(PointDistance, OfAClosedMeshIsThatOfTheSolidNearItsSurface) {
  Random random(12);
  Shelf shelf;
  const Vec3 h{.5, .4, .3};
  const ShapeData mesh = shelf.add(meshBox(h)), solid = box(h);
  int inside = 0, outside = 0;
  for (int round = 0; round < 3000; ++round) {
    const Vec3 x = mul(random.vector(1), h * Real(1.3));
    const PointDistance expected = pointToPrimitive(solid, x);
    const PointDistance at = pointToGeneralShape(shelf.tables(), mesh, x, {.1, .05, {0, 0, 0}});
    if (expected.distance > -.05 && expected.distance < .1) {
      ++(expected.distance < 0 ? inside : outside);
      EXPECT_NEAR(at.distance, expected.distance, 1e-7);
      // within, two faces may be equally near
      if (expected.distance > 1e-3) {
        EXPECT_LT(length(at.n - expected.n), 1e-4);
      }
    } else if (expected.distance < -.1 || expected.distance > .18) {
      EXPECT_GT(at.distance, 1e6);
    }
  }
  EXPECT_GT(inside, 100);
  EXPECT_GT(outside, 100);
}

/// A height field and the mesh that it stands for, with a ridge and a hollow.
TEST(PointDistance, OfAHeightFieldIsThatOfItsTriangles) {
  Random random(13);
  Shelf shelf;
  constexpr int kCount = 5;
  std::vector<double> heights;
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j < kCount; ++j)
    for (int i = 0; i < kCount; ++i) {
      heights.push_back(random.uniform(-.1, .1));
      points.push_back({.25 * i, .25 * j, heights.back()});
    }
  for (int j = 0; j + 1 < kCount; ++j)
    for (int i = 0; i + 1 < kCount; ++i) {
      const int a = j * kCount + i;
      triangles.push_back({a, a + 1, a + kCount + 1}), triangles.push_back({a, a + kCount + 1, a + kCount});
    }
  const ShapeData field = shelf.add(Shape::heightField(kCount, kCount, {.25, .25, 0}, heights)),
                  mesh = shelf.add(Shape::mesh(points, triangles));
  const MassProperties fieldFrame = cook(Shape::heightField(kCount, kCount, {.25, .25, 0}, heights)).unit,
                       meshFrame = cook(Shape::mesh(points, triangles)).unit;
  int near = 0;
  for (int round = 0; round < 2000; ++round) {
    const rubble::Vec3 x{random.uniform(-.1, 1.1), random.uniform(-.1, 1.1), random.uniform(-.3, .3)};
    const PointReach reach{.12, .06, {0, 0, 0}};
    const PointDistance a = pointToGeneralShape(
        shelf.tables(), field, Vec3(rotateInverse(fieldFrame.axes, x - fieldFrame.center)), reach);
    const PointDistance b = pointToGeneralShape(
        shelf.tables(), mesh, Vec3(rotateInverse(meshFrame.axes, x - meshFrame.center)), reach);
    near += a.distance < 1;
    EXPECT_NEAR(std::min(a.distance, Real(1)), std::min(b.distance, Real(1)), 1e-9);
  }
  EXPECT_GT(near, 200);
}

TEST(PointDistance, HoldsNothingBesideTheRimOfASheet) {
  Shelf shelf;
  const ShapeData sheet = shelf.add(
      Shape::mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}));
  const PointReach reach{.1, .1, {0, 0, 0}};
  const auto distance = [&](const Vec3& x) {
    return pointToGeneralShape(shelf.tables(), sheet, x, reach).distance;
  };
  EXPECT_NEAR(distance({.5, .2, .05}), .05, 1e-12);
  EXPECT_NEAR(distance({.5, .2, -.05}), -.05, 1e-12);
  EXPECT_NEAR(distance({1.03, .2, .04}), .05, 1e-12);
  EXPECT_GT(distance({1.03, .2, -.04}), 1e6);
  EXPECT_GT(distance({1.03, 1.02, -.04}), 1e6);
}

TEST(PointDistance, KeepsThePointOnItsSideOfATwoSidedSheet) {
  Shelf shelf;
  const ShapeData sheet = shelf.add(
      Shape::mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, true));
  const Vec3 below{.5, .2, -.01};
  const PointDistance fresh = pointToGeneralShape(shelf.tables(), sheet, below, {.1, .1, {0, 0, 0}});
  EXPECT_NEAR(fresh.distance, .01, 1e-12);
  EXPECT_NEAR(fresh.n.z, -1, 1e-12);
  const PointDistance held = pointToGeneralShape(shelf.tables(), sheet, below, {.1, .1, {0, 0, 1}});
  EXPECT_NEAR(held.distance, -.01, 1e-12);
  EXPECT_NEAR(held.n.z, 1, 1e-12);
}

TEST(PointDistance, OfACompoundIsThatOfItsNearestPart) {
  Shelf shelf;
  const ShapeData bar = shelf.add(
      Shape::compound({{Shape::sphere(.1), {-1, 0, 0}, {}}, {Shape::box({.1, .2, .3}), {1, 0, 0}, {}}}));
  const ShapeTables tables = shelf.tables();
  Random random(14);
  for (int round = 0; round < 200; ++round) {
    const Vec3 x = random.vector(3);
    const PointDistance at = pointToGeneralShape(tables, bar, x, {1, 1, {0, 0, 0}});
    Real least = 1e30;
    for (int k = 0; k < 2; ++k) {
      const ShapePart& part = tables.part[tables.index[bar.data + 2] + k];
      const Vec3 local = rotateInverse(part.rotation, x - part.position);
      least = std::min(least, pointToConvex(tables, part.shape, local).distance);
    }
    EXPECT_NEAR(at.distance, least, 1e-12) << round;
  }
}

/// Of two sheets one over the other, the upper one is nearer, however small the reach and the gap.
TEST(PointDistance, TellsSheetsApartAtAnyScale) {
  for (const Real size : {1e-3, 1., 1e3}) {
    const Real gap = 1e-3 * size;
    for (const bool upperFirst : {false, true}) {
      const Real first = upperFirst ? gap : 0, second = upperFirst ? 0 : gap;
      const Shape mesh = Shape::mesh({{-size, -size, first},
                                      {size, -size, first},
                                      {0, size, first},
                                      {-size, -size, second},
                                      {size, -size, second},
                                      {0, size, second}},
                                     {{0, 1, 2}, {3, 4, 5}}, true);
      Shelf shelf;
      const ShapeData sheets = shelf.add(mesh);
      const CookedShape cooked = cook(mesh);
      const Vec3 x = rotateInverse(cooked.unit.axes, Vec3{0, 0, size} - cooked.unit.center);
      const PointReach reach{2 * size, size, {0, 0, 0}};
      EXPECT_NEAR(pointToGeneralShape(shelf.tables(), sheets, x, reach).distance, size - gap, 1e-9 * size);
    }
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
