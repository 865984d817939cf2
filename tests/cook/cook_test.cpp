/// Mass properties against closed forms and against one another, and what the cook makes of geometry.
#include <cook/cook.h>
#include <cook/hull.h>
#include <cook/solid_mass.h>
#include <gtest/gtest.h>
#include <rubble/error.h>
#include <rubble/mesh.h>

#include <algorithm>
#include <numbers>

#include "tests/support/expect.h"
#include "tests/support/random.h"

namespace rubble {
namespace {

using test::near;
using test::Random;

std::vector<Vec3> boxCorners(const Vec3& h, const Vec3& at = {}, const Quat& q = {}) {
  std::vector<Vec3> points;
  for (int k = 0; k < 8; ++k)
    points.push_back(at + rotate(q, Vec3{(k & 1) ? h.x : -h.x, (k & 2) ? h.y : -h.y, (k & 4) ? h.z : -h.z}));
  return points;
}

/// The inertia tensor in the frame of the shape, about its center of mass.
Mat3 tensor(const MassProperties& m) {
  const Mat3 r = rotationMatrix(m.axes);
  return r * Mat3{{m.inertia.x, 0, 0}, {0, m.inertia.y, 0}, {0, 0, m.inertia.z}} * transpose(r);
}
::testing::AssertionResult sameTensor(const Mat3& a, const Mat3& b, double tolerance) {
  for (const auto& [x, y] : {std::pair{a.c0, b.c0}, {a.c1, b.c1}, {a.c2, b.c2}})
    if (const auto result = near(x, y, tolerance); !result) return result;
  return ::testing::AssertionSuccess();
}

TEST(Hull, OfABoxHasItsMassWhereverItLies) {
  Random random(5);
  for (int round = 0; round < 30; ++round) {
    const Vec3 h{random.uniform(.1, 2), random.uniform(.1, 2), random.uniform(.1, 2)}, at = random.vector(3);
    const Quat q = random.rotation();
    const MassProperties box = massProperties(Shape::box(h), 700),
                         hull = massProperties(Shape::hull(boxCorners(h, at, q)), 700);
    EXPECT_NEAR(hull.mass / box.mass, 1, 1e-12);
    EXPECT_TRUE(near(hull.center, at, 1e-12));
    MassProperties turned = box;
    turned.axes = q;
    EXPECT_TRUE(sameTensor(tensor(hull), tensor(turned), 1e-10 * length(box.inertia)));
  }
}

TEST(Hull, KeepsTheAxesOfAFrameThatIsPrincipal) {
  EXPECT_EQ(massProperties(Shape::hull(boxCorners({.5, .3, .2})), 1).axes, Quat{});
}

TEST(Hull, OfATessellatedSphereComesCloseToIt) {
  std::vector<Vec3> points;
  for (int i = 0; i < 250; ++i) {
    const double z = 1 - (2 * i + 1) / 250., a = i * 2.399963229728653, s = std::sqrt(1 - z * z);
    points.push_back({s * std::cos(a), s * std::sin(a), z});
  }
  const MassProperties hull = massProperties(Shape::hull(points), 1),
                       sphere = massProperties(Shape::sphere(1), 1);
  EXPECT_LT(hull.mass, sphere.mass);
  EXPECT_NEAR(hull.mass / sphere.mass, 1, .04);
  EXPECT_TRUE(near(hull.center, Vec3{}, 1e-3));
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(hull.inertia[i] / hull.mass, .4, .02);
}

TEST(Hull, UnitesFacesInOnePlane) {
  std::vector<Vec3> points = boxCorners({1, 1, 1});
  for (double u = -.5; u <= .5; u += .5) points.push_back({u, .3, 1}), points.push_back({1, u, -.2});
  const Hull hull = convexHull(points, "points");
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.faces.size(), 6u);
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    EXPECT_EQ(hull.faces[f].size(), 4u);
    for (const Vec3& p : points)
      EXPECT_LE(dot(hull.normals[f], p - hull.vertices[static_cast<std::size_t>(hull.faces[f][0])]), 1e-9);
  }
}

TEST(Hull, RefusesPointsInAPlane) {
  EXPECT_THROW(cook(Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}})), Error);
  EXPECT_THROW(cook(Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})), Error);
}

TEST(MassProperties, OfEverySolidAgreeWithItsSurface) {
  const std::vector<Shape> shapes = {Shape::sphere(.7),           Shape::capsule(.3, .5),
                                     Shape::cylinder(.4, .6),     Shape::cone(.5, .7),
                                     Shape::box({.3, .2, .5}),    Shape::box({.3, .2, .5}, .1),
                                     Shape::cylinder(.4, .3, .1), Shape::hull(boxCorners({.3, .2, .5}), .1)};
  for (const Shape& shape : shapes) {
    SolidSums sums;
    const ShapeMesh mesh = shapeMesh(shape, 200);
    for (const auto& t : mesh.triangles) {
      const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(t[k])]; };
      sums += tetrahedronSums(at(0), at(1), at(2));
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_GT(dot(cross(at(1) - at(0), at(2) - at(0)), mesh.normals[static_cast<std::size_t>(t[k])]), 0);
    }
    const MassProperties a = massProperties(shape, 1), b = principal(sums);
    EXPECT_NEAR(a.mass / b.mass, 1, 4e-3) << static_cast<int>(shape.type);
    EXPECT_TRUE(near(a.center, b.center, 2e-3));
    EXPECT_TRUE(sameTensor(tensor(a), tensor(b), 6e-3 * length(b.inertia)));
  }
}

/// The triangulated surface approaches the rounded one with the square of its edges.
TEST(MassProperties, OfRoundedSolidsAreTheLimitOfTheirSurfaces) {
  Random random(7);
  for (int k = 0; k < 12; ++k) {
    const double r = random.uniform(.02, .3);
    Shape shape = Shape::cylinder(r + random.uniform(.01, .5), r + random.uniform(.01, .5), r);
    if (k % 3 == 1)
      shape = Shape::box(
          Vec3{random.uniform(.01, .5), random.uniform(.01, .5), random.uniform(.01, .5)} + Vec3{r, r, r}, r);
    else if (k % 3 == 2) {
      std::vector<Vec3> points;
      for (int i = 0; i < 5 + random.below(8); ++i) points.push_back(random.vector(.5) + Vec3{.3, .1, .7});
      shape = Shape::hull(points, r);
    }
    const MassProperties a = massProperties(shape, 1);
    const auto error = [&](int segments) {
      SolidSums sums;
      const ShapeMesh mesh = shapeMesh(shape, segments);
      for (const auto& t : mesh.triangles) {
        const auto at = [&](std::size_t i) { return mesh.points[static_cast<std::size_t>(t[i])]; };
        sums += tetrahedronSums(at(0), at(1), at(2));
      }
      const MassProperties b = principal(sums);
      const Mat3 x = tensor(a), y = tensor(b);
      return std::max({std::fabs(a.mass / b.mass - 1), length(a.center - b.center) / length(a.inertia),
                       length(x.c0 - y.c0) / length(a.inertia), length(x.c1 - y.c1) / length(a.inertia),
                       length(x.c2 - y.c2) / length(a.inertia)});
    };
    const double coarse = error(32), fine = error(96);
    EXPECT_LT(fine, coarse / 5) << k;
    EXPECT_LT(fine, 4e-3) << k;
  }
}

TEST(MassProperties, OfARoundedBoxFollowSteiner) {
  // V = core + faces r + quarter cylinders + sphere
  const double r = .1;
  const Vec3 c{.2, .1, .4};
  const double exact = 8 * c.x * c.y * c.z + r * 8 * (c.x * c.y + c.y * c.z + c.x * c.z) +
                       std::numbers::pi * r * r * 2 * (c.x + c.y + c.z) +
                       4. / 3 * std::numbers::pi * r * r * r;
  EXPECT_NEAR(massProperties(Shape::box(c + Vec3{r, r, r}, r), 1).mass / exact, 1, 1e-12);
}

TEST(MassProperties, OfACompoundAreThoseOfTheWhole) {
  // a box cut in two, the halves turned to their places
  const Shape half = Shape::box({.25, .3, .2});
  const Quat turn = fromAxisAngle(Vec3{0, 0, 1}, std::numbers::pi / 2);
  const Shape whole = Shape::compound(
      {{half, {.25, 0, 0}, {}}, {Shape::box({.3, .25, .2}), {-.25, 0, 0}, turn}});
  const MassProperties a = massProperties(whole, 3), b = massProperties(Shape::box({.5, .3, .2}), 3);
  EXPECT_NEAR(a.mass, b.mass, 1e-12);
  EXPECT_TRUE(near(a.center, b.center, 1e-12));
  EXPECT_TRUE(sameTensor(tensor(a), tensor(b), 1e-12));
}

TEST(MassProperties, OfACompoundMayBeGiven) {
  const Quat turn = fromAxisAngle(Vec3{0, 0, 1}, .3);
  const MassProperties given{2, {.1, .2, .25}, {.3, -.1, .5}, turn};
  const MassProperties own = massProperties(Shape::compound({{Shape::sphere(.1), {}, {}}}, given), 3);
  EXPECT_NEAR(own.mass, 6, 1e-12);
  EXPECT_TRUE(near(own.center, given.center, 1e-12));
  EXPECT_TRUE(near(own.inertia, 3 * given.inertia, 1e-12));
  EXPECT_NEAR(dot(own.axes.v, turn.v) + own.axes.s * turn.s, 1, 1e-12);
  MassProperties wrong = given;
  wrong.inertia = {1, 1, 3};
  EXPECT_THROW(validate(Shape::compound({{Shape::sphere(.1), {}, {}}}, wrong), "shape"), Error);
}

TEST(MassProperties, OfADistanceFieldAgreeWithTheSolid) {
  const int n = 25;
  const double spacing = .1;
  std::vector<double> distances;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        distances.push_back(length(Vec3{i * spacing - 1.1, j * spacing - 1.2, k * spacing - 1.2}) - .8);
  const MassProperties field = massProperties(
                           Shape::distanceField({n, n, n}, {-1.2, -1.2, -1.2}, spacing, distances), 1),
                       sphere = massProperties(Shape::sphere(.8), 1);
  EXPECT_NEAR(field.mass / sphere.mass, 1, .01);
  EXPECT_TRUE(near(field.center, Vec3{-.1, 0, 0}, 2e-3));
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(field.inertia[i] / sphere.inertia[i], 1, .02);
}

TEST(Mesh, FlatAndHollowEdgesAreNotTouchable) {
  // a roof: two slopes that meet in a ridge, each of two triangles
  const std::vector<Vec3> points = {{-1, 0, 0}, {-1, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 0}, {1, 1, 0}};
  const std::vector<std::array<int, 3>> roof = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
  const auto edgesOf = [](int flags) { return flags & 7; };
  const std::vector<int> ridge = cooking::touchableEdges(points, roof, false);
  // the diagonals 0-3 and 2-5 are flat
  EXPECT_EQ(edgesOf(ridge[0]), 0b011);
  EXPECT_EQ(edgesOf(ridge[1]), 0b110);
  std::vector<Vec3> valley = points;
  for (Vec3& p : valley) p.z = -p.z;
  const std::vector<int> hollow = cooking::touchableEdges(valley, roof, false),
                         both = cooking::touchableEdges(valley, roof, true);
  EXPECT_EQ(edgesOf(hollow[0]), 0b001);
  EXPECT_EQ(edgesOf(both[0]), 0b001);
  EXPECT_EQ(edgesOf(both[0] >> 6), 0b011);
}

TEST(Mesh, RefusesTrianglesWhoseAreaHasNoSquareInSinglePrecision) {
  const auto meshOf = [](double edge) {
    return Shape::mesh({{0, 0, 0}, {edge, 0, 0}, {0, edge, 0}}, {{0, 1, 2}});
  };
  const auto fieldOf = [](double edge) { return Shape::heightField(2, 2, {edge, edge, 0}, {0, 0, 0, 0}); };
  const auto pathOfError = [](const Shape& shape) -> std::string {
    try {
      cook(shape, "shape");
      return "none";
    } catch (const Error& error) {
      return error.path();
    }
  };
  for (const double edge : {1.1e-9, 1., .9e9}) {
    EXPECT_EQ(pathOfError(meshOf(edge)), "none") << edge;
    EXPECT_EQ(pathOfError(fieldOf(edge)), "none") << edge;
  }
  for (const double edge : {.9e-9, 1.1e9}) {
    EXPECT_EQ(pathOfError(meshOf(edge)), "shape.triangles[0]") << edge;
    EXPECT_EQ(pathOfError(fieldOf(edge)), "shape.spacing") << edge;
  }
  // corners on a line, whose area in double precision is round-off
  EXPECT_EQ(pathOfError(Shape::mesh({{0, 0, 0}, {.001, .002, .003}, {.007, .014, .021}}, {{0, 1, 2}})),
            "shape.triangles[0]");
}

TEST(Mesh, NamesTheTriangleThatIsWrong) {
  try {
    cook(Shape::mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 7}}), "body.shape");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("body.shape.triangles[1]"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace rubble
