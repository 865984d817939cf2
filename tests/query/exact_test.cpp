/// The distances of exact.h against planes that separate. Two convex sets are at least as far apart as the
/// slab between them along any direction is thick, and at most as far as any two of their points: where both
/// agree the distance is proven. Supports are the corners and closed forms of shapes, and share no code with
/// it.
#include <gtest/gtest.h>

#include "tests/query/exact.h"

namespace rubble {
namespace {

using test::Piece;

/// The point of a core that is furthest along d, in the frame of the piece.
Vec3 supportOfCore(const Piece& p, const Vec3& d) {
  const Shape& s = p.shape;
  const auto furthest = [&](const auto& points) {
    Vec3 best = points[0];
    for (const Vec3& x : points)
      if (dot(d, x) > dot(d, best)) best = x;
    return best;
  };
  const auto sign = [](double x) { return x < 0 ? -1. : 1.; };
  const double r = s.rounding, across = std::hypot(d.x, d.y);
  const Vec3 rim = across > 0 ? Vec3{d.x / across, d.y / across, 0} : Vec3{};
  switch (s.type) {
    case ShapeType::Sphere:
      return {};
    case ShapeType::Capsule:
      return {0, 0, sign(d.z) * s.halfLength};
    case ShapeType::Cylinder:
      return (s.radius - r) * rim + Vec3{0, 0, sign(d.z) * (s.halfLength - r)};
    case ShapeType::Cone: {
      const Vec3 tip{0, 0, s.halfLength}, base = s.radius * rim - tip;
      return dot(d, tip) > dot(d, base) ? tip : base;
    }
    case ShapeType::Hull:
      return furthest(s.geometry->points);
    case ShapeType::Mesh:
      return furthest(p.corner);
    default:
      return {sign(d.x) * (s.halfExtents.x - r), sign(d.y) * (s.halfExtents.y - r),
              sign(d.z) * (s.halfExtents.z - r)};
  }
}

/// How far a piece reaches along the unit vector d.
double reachAlong(const Piece& p, const Vec3& d) {
  const bool round = p.shape.type == ShapeType::Sphere || p.shape.type == ShapeType::Capsule;
  const double around = p.shape.type == ShapeType::Mesh ? 0 : round ? p.shape.radius : p.shape.rounding;
  return dot(d, p.position + rotate(p.orientation, supportOfCore(p, rotateInverse(p.orientation, d)))) +
         around;
}

/// Thickness of the slab between two pieces along d, from b to a.
double slab(const Piece& a, const Piece& b, const Vec3& d) { return -reachAlong(a, -d) - reachAlong(b, d); }

Piece randomPiece(test::Random& random, double apart) {
  constexpr double kMost = 1;
  BodyDef b;
  b.position = random.vector(apart), b.orientation = random.rotation();
  b.shape = random.below(6) == 0 ? test::randomMesh(random, kMost) : test::randomConvex(random, kMost);
  const std::vector<Piece> pieces = test::piecesOf(b);
  return pieces[static_cast<std::size_t>(random.below(static_cast<int>(pieces.size())))];
}

TEST(ExactDistance, IsProvenByASlabBetweenThePieces) {
  test::Random random(1);
  int apart = 0;
  for (int i = 0; i < 400; ++i) {
    const Piece a = randomPiece(random, 1.5), b = randomPiece(random, 1.5);
    const test::NearestPair pair = test::nearestPair(a, b);
    if (pair.distance < 1e-3) continue;
    ++apart;
    EXPECT_NEAR(slab(a, b, (pair.a - pair.b) / pair.distance), pair.distance, 1e-6) << i;
  }
  EXPECT_GT(apart, 200);
}

TEST(ExactDistance, IsZeroOnlyWhereNoSlabSeparates) {
  test::Random random(2);
  int together = 0;
  for (int i = 0; i < 200; ++i) {
    const Piece a = randomPiece(random, 0.4), b = randomPiece(random, 0.4);
    const test::NearestPair pair = test::nearestPair(a, b);
    if (pair.distance >= 1e-3) continue;
    ++together;
    for (int k = 0; k < 500; ++k) EXPECT_LE(slab(a, b, random.direction()), pair.distance + 1e-12) << i;
  }
  EXPECT_GT(together, 50);
}

TEST(ExactDistance, OfAHalfSpaceIsThatOfTheLowestPoint) {
  test::Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Piece a = randomPiece(random, 1.5);
    BodyDef ground;
    ground.shape = Shape::plane(), ground.position = random.vector(1), ground.orientation = random.rotation();
    const Piece b = test::piecesOf(ground)[0];
    const Vec3 up = rotate(b.orientation, Vec3{0, 0, 1});
    EXPECT_NEAR(test::distanceBetween(a, b), -reachAlong(a, -up) - dot(up, b.position), 1e-6) << i;
    EXPECT_EQ(test::distanceBetween(a, b), test::distanceBetween(b, a)) << i;
  }
}

}  // namespace
}  // namespace rubble
