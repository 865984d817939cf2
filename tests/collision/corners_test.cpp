/// Corners with which a body touches surfaces of triangles.
#include <collision/corners.h>

#include "tests/collision/shapes_for_tests.h"

namespace rubble::RUBBLE_CORE {
namespace {

std::vector<Vec3> cornersOf(const ShapeTables& tables, const ShapeData& s, const CornerRange& range) {
  std::vector<Vec3> out;
  visitCorners(tables, s, range, [&](const ShapeCorner& corner) { out.push_back(corner.at); });
  return out;
}

std::vector<ShapeData> shapesWithCorners(Shelf& shelf) {
  return {box({.3, .2, .1}),
          capsule(.1, .4),
          shelf.add(Shape::cylinder(.25, .3)),
          shelf.add(Shape::cone(.3, .4)),
          shelf.add(Shape::hull({{0, 0, .4}, {.4, 0, -.2}, {-.3, .3, -.2}, {-.2, -.4, -.2}})),
          shelf.add(Shape::compound({{Shape::box({.4, .1, .1}), {0, -.25, -.2}, {}},
                                     {Shape::cylinder(.1, .2), {0, .25, -.2}, {}},
                                     {Shape::sphere(.2), {0, 0, .3}, {}}}))};
}

TEST(Corners, OfAllSharesAreThoseOfTheShape) {
  Shelf shelf;
  for (const ShapeData& s : shapesWithCorners(shelf)) {
    const ShapeTables tables = shelf.tables();
    const int all = cornerCount(tables, s);
    const std::vector<Vec3> expected = cornersOf(tables, s, {0, all});
    EXPECT_EQ(expected.size(), static_cast<std::size_t>(all));
    for (int shares = 2; shares <= 8; ++shares) {
      std::vector<Vec3> found;
      for (int k = 0; k < shares; ++k)
        for (const Vec3& x : cornersOf(tables, s, cornerShare(tables, s, k, shares))) found.push_back(x);
      EXPECT_EQ(found, expected) << "kind " << static_cast<int>(s.kind) << ", " << shares << " shares";
    }
  }
}

TEST(Corners, LieOnTheSurfaceOfTheirShape) {
  Shelf shelf;
  for (const ShapeData& s : shapesWithCorners(shelf)) {
    if (s.kind == ShapeKind::Compound) continue;
    const Convex convex = convexOf(shelf.tables(), s);
    for (const Vec3& x : cornersOf(shelf.tables(), s, {0, cornerCount(shelf.tables(), s)}))
      EXPECT_NEAR(distanceTo(convex, x) + convex.radius, 0, 1e-12) << static_cast<int>(s.kind);
  }
}

TEST(Corners, OfABoxFaceAreFourFeatures) {
  Shelf shelf;
  const Convex c = convexOf(shelf.tables(), box({.3, .2, .1}));
  std::vector<int> uses(8);
  for (int face = 0; face < 6; ++face) {
    Feature f;
    faceFeature(c, face, {0, 0, 1}, {0, 0, 0}, f);
    ASSERT_EQ(f.count, 4);
    for (int k = 0; k < 4; ++k) {
      ASSERT_TRUE(f.id[k] >= 0 && f.id[k] < 8);
      ++uses[static_cast<std::size_t>(f.id[k])];
    }
  }
  EXPECT_EQ(uses, std::vector<int>(8, 3)) << "each corner of a box is on three faces";
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
