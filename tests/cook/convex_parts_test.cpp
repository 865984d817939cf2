/// Solids that are cut: convex parts, pieces of a fracture, distance fields.
#include <numeric>

#include <gtest/gtest.h>

#include <rubble/mesh.h>

#include "cook/distance_surface.h"
#include "cook/hull.h"
#include "cook/solid_cut.h"
#include "tests/support/meshes.h"

namespace rubble {
namespace {

double sumOf(const std::vector<ConvexPart>& parts) {
  return std::accumulate(parts.begin(), parts.end(), 0.0,
                         [](double sum, const ConvexPart& part) { return sum + part.volume; });
}

/// Depth of a point in a hull [m]; negative outside.
double depthIn(const Hull& hull, const Vec3& x) {
  double depth = 1e30;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const Vec3& on = hull.vertices[static_cast<std::size_t>(hull.faces[f][0])];
    depth = std::min(depth, dot(hull.normals[f], on - x));
  }
  return depth;
}

/// Solids of several kinds, by number.
TriangleMesh solid(int kind) {
  switch (kind) {
    case 0:
      return test::ell();
    case 1:
      return test::torusMesh(1, 0.35, 24, 12);
    default:
      return test::bumpyBall(1, 0.5, 12, static_cast<unsigned>(kind));
  }
}

/// The hulls cover the solid, and no two of them overlap.
void expectPartition(const TriangleMesh& mesh, const std::vector<ConvexPart>& parts, double lost) {
  std::vector<Hull> hulls;
  for (const ConvexPart& part : parts) {
    hulls.push_back(convexHull(part.points, "part"));
    EXPECT_EQ(hulls.back().vertices.size(), part.points.size()) << "a point is no corner";
  }
  const CutSurface whole(mesh);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-2, 2);
  int inside = 0, uncovered = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vec3 x{place(random), place(random), place(random)};
    constexpr double kRoundOff = 1e-6;
    int in = 0;
    bool isCovered = false;
    for (const Hull& hull : hulls) {
      const double depth = depthIn(hull, x);
      in += depth > kRoundOff, isCovered = isCovered || depth > -kRoundOff;
    }
    EXPECT_LE(in, 1) << "two parts overlap";
    if (!whole.isInside(x)) continue;
    ++inside;
    uncovered += !isCovered;
  }
  EXPECT_GT(inside, 50);
  EXPECT_LE(uncovered, lost * inside + (lost > 0 ? 3 : 0));
}

TEST(ConvexParts, OfAnEllAreTwoBoxes) {
  const std::vector<ConvexPart> parts = convexParts(test::ell(), 0.001, 32);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_NEAR(sumOf(parts), 3, 1e-12);
  for (const ConvexPart& part : parts) EXPECT_EQ(part.points.size(), 8u);
}

TEST(ConvexParts, OfAConvexSolidAreItself) {
  const std::vector<ConvexPart> parts = convexParts(test::bumpyBall(1, 0, 12, 1), 0.01, 32);
  EXPECT_EQ(parts.size(), 1u);
}

TEST(ConvexParts, ExceedTheSolidByTheBoundAtMostAndDoNotOverlap) {
  for (int kind = 0; kind < 4; ++kind) {
    const TriangleMesh mesh = solid(kind);
    const double volume = volumeOf(mesh);
    for (const double bound : {0.2, 0.03}) {
      const std::vector<ConvexPart> parts = convexParts(mesh, bound, 200);
      SCOPED_TRACE(testing::Message() << "solid " << kind << ", bound " << bound << ", " << parts.size());
      EXPECT_LT(parts.size(), 200u);
      EXPECT_GE(sumOf(parts), volume * (1 - 1e-9));
      EXPECT_LE(sumOf(parts), volume * (1 + bound) * (1 + 1e-9));
      expectPartition(mesh, parts, 0);
    }
  }
}

TEST(ConvexParts, AreAsManyAsAllowed) {
  EXPECT_EQ(convexParts(test::torusMesh(1, 0.35, 24, 12), 1e-6, 9).size(), 9u);
}

TEST(Fracture, FillsTheSolidWithConnectedConvexPieces) {
  for (int kind = 0; kind < 3; ++kind) {
    const TriangleMesh mesh = solid(kind);
    const double volume = volumeOf(mesh);
    const Fracture broken = fracture(mesh, 40, 11);
    SCOPED_TRACE(testing::Message() << "solid " << kind << ", " << broken.pieces.size() << " pieces, "
                                    << broken.contacts.size() << " contacts, lost " << broken.lost / volume);
    EXPECT_GE(broken.pieces.size(), 38u);
    EXPECT_NEAR(sumOf(broken.pieces), volume, 0.01 * volume);
    expectPartition(mesh, broken.pieces, broken.lost / volume);
    // Along contacts one comes from any piece to any other.
    std::vector<int> root(broken.pieces.size());
    std::iota(root.begin(), root.end(), 0);
    const auto rootOf = [&](int i) {
      while (root[static_cast<std::size_t>(i)] != i) i = root[static_cast<std::size_t>(i)];
      return i;
    };
    for (const Fracture::Contact& contact : broken.contacts) {
      EXPECT_GT(contact.area, 0);
      const Hull a = convexHull(broken.pieces[static_cast<std::size_t>(contact.a)].points, "a"),
                 b = convexHull(broken.pieces[static_cast<std::size_t>(contact.b)].points, "b");
      EXPECT_LT(std::fabs(depthIn(a, contact.center)), 0.05);
      EXPECT_LT(std::fabs(depthIn(b, contact.center)), 0.05);
      root[static_cast<std::size_t>(rootOf(contact.a))] = rootOf(contact.b);
    }
    for (int i = 0; i < static_cast<int>(broken.pieces.size()); ++i) EXPECT_EQ(rootOf(i), rootOf(0));
  }
}

TEST(Fracture, IsTheSameForTheSameSeedAlone) {
  const TriangleMesh mesh = test::ell();
  const Fracture a = fracture(mesh, 20, 3), b = fracture(mesh, 20, 3), c = fracture(mesh, 20, 4);
  ASSERT_EQ(a.pieces.size(), b.pieces.size());
  for (std::size_t i = 0; i < a.pieces.size(); ++i) EXPECT_EQ(a.pieces[i].points, b.pieces[i].points);
  EXPECT_NE(a.pieces[0].points, c.pieces[0].points);
}

TEST(Fracture, RefusesOpenSurfacesAndNoPieces) {
  TriangleMesh open = test::ell();
  open.triangles.pop_back();
  EXPECT_THROW(fracture(open, 5, 1), Error);
  EXPECT_THROW(fracture(test::ell(), 0, 1), Error);
  EXPECT_THROW(convexParts(test::ell(), 0, 5), Error);
}

TEST(MeshDistance, IsThatOfATorus) {
  const Shape shape = distanceFieldOf(test::torusMesh(1, 0.35, 96, 48), 32);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-1.3, 1.3), height(-0.3, 0.3);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 x{place(random), place(random), height(random)};
    const double exact = std::hypot(std::hypot(x.x, x.y) - 1, x.z) - 0.35;
    if (std::fabs(exact) > 0.2) continue;
    const double spacing = shape.geometry->spacing.x;
    EXPECT_NEAR(distanceAt(*shape.geometry, x), exact, 0.15 * spacing) << x.x << ' ' << x.y << ' ' << x.z;
  }
  const double volume = 2 * std::numbers::pi * std::numbers::pi * 0.35 * 0.35;
  EXPECT_NEAR(massProperties(shape, 1).mass, volume, 0.03 * volume);
}

}  // namespace
}  // namespace rubble
