/// Sweeps and distances of meshes, height fields, distance fields and compounds.
#include <collision/sweep.h>

#include "tests/collision/shapes_for_tests.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// A cube of half width `half` about the origin as a distance field of 0.125 m.
Shape fieldOfCube(double half) {
  constexpr double kSpacing = .125;
  const int count = 2 * static_cast<int>(std::lround(half / kSpacing)) + 5;
  const double first = -kSpacing * (count - 1) / 2;
  std::vector<double> samples;
  for (int k = 0; k < count; ++k)
    for (int j = 0; j < count; ++j)
      for (int i = 0; i < count; ++i) {
        const Vec3 d = abs(Vec3{first, first, first} + kSpacing * Vec3{Real(i), Real(j), Real(k)}) -
                       Vec3{half, half, half};
        samples.push_back(std::max({d.x, d.y, d.z}));
      }
  return Shape::distanceField({count, count, count}, {first, first, first}, kSpacing, samples);
}

PlacedAny placedAt(const Shelf& shelf, const ShapeData& s, const Vec3d& p) {
  return {shelf.tables(), s, p, Quatd{}};
}

TEST(FieldDistance, IsThatOfEachFieldOfSeveral) {
  Shelf shelf;
  const ShapeData small = shelf.add(fieldOfCube(.25)), large = shelf.add(fieldOfCube(.5)), ball = sphere(.1);
  for (const auto& [field, half] : {std::pair{small, .25}, std::pair{large, .5}}) {
    const Separation s = fieldSeparation(placedAt(shelf, field, {0, 0, 0}),
                                         placedAt(shelf, ball, {0, 0, half + .15}));
    EXPECT_NEAR(s.distance, .05, 1e-6);
    EXPECT_TRUE(test::near(s.n, Vec3d{0, 0, 1}, 1e-6));
    EXPECT_TRUE(test::near(s.onB, s.onA + s.distance * s.n, 1e-12));
    EXPECT_NEAR(s.onA.z, half, 1e-6);
  }
}

/// Points of a field that has sunk into a mesh are found, too, as long as they are near its triangles.
TEST(FieldDistance, FindsPointsAboveAndBelowTheTrianglesOfAMesh) {
  Shelf shelf;
  const Shape sheet = Shape::mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  const ShapeData field = shelf.add(fieldOfCube(.25)), ground = shelf.add(sheet);
  const DistanceLattice lattice = latticeOf(shelf.tables(), field);
  Real lowest = 0;
  for (int k = 0; k < lattice.pointCount; ++k) lowest = std::min(lowest, lattice.points[k].z);
  constexpr Real kLength = .4, kMargin = .02;
  for (const Real height : {-.02, -.004, 0., .01}) {
    SurfaceContacts found;
    found.length = kLength;
    found.weight = {};
    collideDistance(shelf.tables(), field, ground, {0, 0, lowest - height}, cook(sheet).unit.axes, kMargin,
                    found);
    ASSERT_EQ(found.count, 1) << height;
    EXPECT_TRUE(test::near(found.cluster[0].n, Vec3{0, 0, -1}, 1e-9));
    Real least = kMargin;
    for (int k = 0; k < found.cluster[0].points.count; ++k) {
      const auto& point = found.cluster[0].points.v[k];
      EXPECT_NEAR(point.w, point.x.z - lowest + height, 1e-9) << height;
      least = std::min(least, point.w);
    }
    EXPECT_NEAR(least, height, 1e-9);
  }
}

TEST(SurfaceContacts, MergePointsAtOneSpotAndKeepTheDeepest) {
  SurfaceContacts found;
  found.length = 1;
  found.weight = {};
  const Vec3 up{0, 0, 1}, at{.3, .2, -.5}, off{.4 * kSameSpot, 0, 0};
  addSurfacePoint(found, up, at, .003, 1);
  addSurfacePoint(found, up, at + off, -.004, 2);
  addSurfacePoint(found, up, at - off, .005, 3);
  // the mirror image is another spot
  addSurfacePoint(found, up, -at, 0, 4);
  ASSERT_EQ(found.count, 1);
  ASSERT_EQ(found.cluster[0].points.count, 2);
  EXPECT_EQ(found.cluster[0].points.v[0].w, -.004);
  EXPECT_EQ(found.cluster[0].points.v[1].from, 4);
}

/// Triangles whose corners have coordinates of magnitudes from 1e-331 to 1e60, about the center of a ball.
TEST(SurfaceContacts, NormalsAreUnitVectorsHoweverSmallOrLargeTheTriangle) {
  Random random(22);
  const Convex ball = convexOf({}, sphere(.2));
  const Quat still;
  int touching = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto coordinate = [&] {
      const double sign = random.uniform(-1, 1);
      const int power = random.below(1300) - 200;
      return random.below(2) == 0 ? 0. : std::ldexp(sign, -power);
    };
    SurfaceTriangle t{{}, ~0, 0, {}};
    for (Vec3& corner : t.corner)
      for (int k = 0; k < 3; ++k) corner[k] = coordinate();
    std::copy(t.corner, t.corner + 3, t.beyond);
    SurfaceContacts found;
    found.length = .4;
    found.weight = {};
    surface::addTriangle(t, true, ball, still, rotationMatrix(still), .02, found);
    for (int k = 0; k < found.count; ++k) ASSERT_NEAR(lengthSquared(found.cluster[k].n), 1, 1e-6) << i;
    touching += found.count;
  }
  EXPECT_GT(touching, 1000);
}

/// A height field of 7 x 7 flat cells, and paths of boxes over it in all directions.
TEST(TrianglesAlongAPath, AreAllThatTheBoxMeets) {
  constexpr int kCount = 8;
  Shelf shelf;
  const ShapeData field = shelf.add(
      Shape::heightField(kCount, kCount, {1, 1, 0}, std::vector<double>(kCount * kCount, 0)));
  const surface::HeightGrid grid = surface::heightGrid(shelf.tables(), field);
  Random random(21);
  std::size_t most = 0;
  for (int round = 0; round < 200; ++round) {
    const Vec3d x(random.vector(4)), half{.7, .3, 5};
    // some are vertical, some follow an axis
    Vec3d d(random.vector(6));
    if (round % 4 < 2) d[round % 4] = 0;
    std::vector<int> found, expected;
    visitTrianglesAlong(shelf.tables(), field, x, d, half, 1.,
                        [&](const SurfaceTriangle& t) { found.push_back(t.index); });
    const auto all = [](const Vec3&, const Vec3&) { return true; };
    for (int j = 0; j + 1 < kCount; ++j)
      for (int i = 0; i + 1 < kCount; ++i)
        grid.visitCell(i, j, all, [&](const SurfaceTriangle& t) {
          const Vec3d low(lower(t.corner[0], lower(t.corner[1], t.corner[2]))),
              high(upper(t.corner[0], upper(t.corner[1], t.corner[2])));
          if (passes(x - (low + high) * .5, inverseOf(d), half + (high - low) * .5, 1))
            expected.push_back(t.index);
          return false;
        });
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << round;
    most = std::max(most, found.size());
  }
  EXPECT_GT(most, 20u);
}

/// A point of a field that just reaches a triangle at the end of its way hits it.
TEST(FieldImpact, HitsATriangleAtWhichItsWayEnds) {
  Shelf shelf;
  const ShapeData field = shelf.add(fieldOfCube(.25)),
                  ground = shelf.add(Shape::heightField(2, 2, {4, 4, 0}, {0, 0, 0, 0}));
  const ImpactRule rule{1e-3};
  const auto any = [](const Vec3d&, const TimeOfImpact&) { return true; };
  for (const double share : {.5, 1., 1.5}) {
    const PlacedAny cube = placedAt(shelf, field, {0, 0, .5});
    const DistanceLattice lattice = latticeOf(shelf.tables(), field);
    double lowest = 0;
    for (int k = 0; k < lattice.pointCount; ++k) lowest = std::min(lowest, double(xyz(lattice.points[k]).z));
    const double gap = .5 + lowest;
    const TimeOfImpact m = timeOfImpactWithField(cube, {{0, 0, -share * gap}, {}},
                                                 placedAt(shelf, ground, {0, 0, 0}), {}, rule, any);
    if (share < 1)
      EXPECT_GT(m.fraction, 1);
    else
      EXPECT_NEAR(m.fraction, 1 / share, 1e-12) << share;
  }
}

TEST(InnerRadius, OfACompoundIsThatOfItsThinnestPart) {
  Shelf shelf;
  const ShapeData bar = shelf.add(Shape::compound({{Shape::box({.4, .1, .1}), {0, -.25, -.2}, {}},
                                                   {Shape::cylinder(.3, .07), {0, .25, -.2}, {}},
                                                   {Shape::sphere(.2), {0, 0, .3}, {}}}));
  EXPECT_NEAR(innerRadiusOf(shelf.tables(), bar), .07, 1e-12);
}

/// Parts are placed about the center of their body: the contact of two parts is that of bodies which consist
/// of nothing else, shifted.
TEST(PartContact, IsThatOfThePartsAlone) {
  Random random(22);
  Shelf shelf;
  const ShapeTables tables = shelf.tables();
  const ShapeData kinds[] = {box({.3, .2, .1}), sphere(.2), capsule(.1, .3)};
  int touching = 0;
  for (int round = 0; round < 60; ++round) {
    const ShapeData &a = kinds[round % 3], &b = kinds[round / 3 % 3];
    const Quat qa = random.rotation(), qb = random.rotation();
    const Vec3 between = random.vector(.35), atA = random.vector(), atB = random.vector();
    constexpr Real kMargin = .05, kLength = .4;
    const RawManifold alone = collideParts(tables, {a, qa, {}}, {b, qb, {}}, between, kMargin, kLength),
                      placed = collideParts(tables, {a, qa, atA}, {b, qb, atB}, between + atA - atB, kMargin,
                                            kLength);
    ASSERT_EQ(placed.count, alone.count) << round;
    touching += alone.count > 0;
    for (int k = 0; k < alone.count; ++k) {
      EXPECT_TRUE(test::near(placed.points[k].onA, alone.points[k].onA + atA, 1e-9));
      EXPECT_TRUE(test::near(placed.points[k].onB, alone.points[k].onB + atA, 1e-9));
    }
  }
  EXPECT_GT(touching, 20);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
