/// Tetrahedra from closed surfaces, cloth and rods from meshes and lines.
#include <algorithm>
#include <limits>
#include <map>

#include <gtest/gtest.h>
#include <rubble/error.h>
#include <rubble/mesh.h>

#include "tests/support/meshes.h"

namespace rubble {
namespace {

using namespace test;

double volumeOf(const TetrahedronMesh& m) {
  double sum = 0;
  for (const auto& t : m.tetrahedra) {
    const auto at = [&](std::size_t k) { return m.vertices[std::size_t(t[k])]; };
    const double own = dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) / 6;
    EXPECT_GT(own, 0);
    sum += own;
  }
  return sum;
}

/// Smallest angle between two faces [rad].
double leastAngle(const TetrahedronMesh& m) {
  double least = 4;
  for (const auto& t : m.tetrahedra)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        std::size_t others[2], n = 0;
        for (std::size_t k = 0; k < 4; ++k)
          if (k != i && k != j) others[n++] = k;
        const auto at = [&](std::size_t k) { return m.vertices[std::size_t(t[k])]; };
        const Vec3 axis = normalize(at(j) - at(i));
        const auto across = [&](std::size_t k) {
          const Vec3 v = at(k) - at(i);
          return normalize(v - axis * dot(v, axis));
        };
        least = std::min(least, std::acos(std::clamp(dot(across(others[0]), across(others[1])), -1., 1.)));
      }
  return least;
}

/// Faces of one tetrahedron only.
std::vector<std::array<int, 3>> outside(const TetrahedronMesh& m) {
  std::map<std::array<int, 3>, int> faces;
  for (const auto& t : m.tetrahedra)
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<int, 3> f{t[(k + 1) % 4], t[(k + 2) % 4], t[(k + 3) % 4]};
      std::sort(f.begin(), f.end());
      ++faces[f];
    }
  std::vector<std::array<int, 3>> out;
  for (const auto& [face, count] : faces) {
    EXPECT_LE(count, 2);
    if (count == 1) out.push_back(face);
  }
  return out;
}

TEST(Tetrahedralize, FillsARingWithWellShapedTetrahedra) {
  const TriangleMesh ring = torusMesh(1, .4, 48, 24);
  double before = 1;
  for (const double cell : {.2, .1}) {
    const TetrahedronMesh mesh = tetrahedralize(ring, cell);
    const double error = std::fabs(volumeOf(mesh) / volumeOf(ring) - 1);
    EXPECT_LT(error, .6 * cell * cell / .4) << "of second order in the cell";
    EXPECT_LT(error, before);
    before = error;
    EXPECT_GT(leastAngle(mesh), .17) << "10 degrees";
    // its surface is that of the ring, and closed
    std::map<std::pair<int, int>, int> edges;
    for (const auto& f : outside(mesh)) {
      for (const auto& [a, b] : {std::pair{f[0], f[1]}, {f[0], f[2]}, {f[1], f[2]}}) ++edges[{a, b}];
      for (const int v : f) {
        const Vec3& x = mesh.vertices[std::size_t(v)];
        EXPECT_NEAR(std::hypot(std::hypot(x.x, x.y) - 1, x.z), .4, .02);
      }
    }
    for (const auto& [edge, count] : edges) EXPECT_EQ(count % 2, 0);
    EXPECT_NO_THROW(validate(tetSolidFromMesh(mesh), "ring"));
  }
}

TEST(Tetrahedralize, KeepsTheFacesOfACubeThatLiesOnRoundNumbers) {
  const TetrahedronMesh mesh = tetrahedralize(cubeMesh(), .125);
  EXPECT_NEAR(volumeOf(mesh), 1, .01);
  for (const Vec3& x : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(x[axis] > -1e-9 && x[axis] < 1 + 1e-9);
}

TEST(Tetrahedralize, PartsThatOverlapAreOneSolid) {
  TriangleMesh two = cubeMesh();
  const TriangleMesh one = cubeMesh();
  for (const Vec3& x : one.vertices) two.vertices.push_back(x + Vec3{.5, 0, 0});
  for (const auto& t : one.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  EXPECT_NEAR(volumeOf(tetrahedralize(two, .1)), 1.5, .02);
}

/// The text of the error, or "".
template <class F> std::string errorOf(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Tetrahedralize, SaysWhatIsWrongWithASurface) {
  const auto refused = [](auto&& change, double cell = .2) {
    TriangleMesh mesh = cubeMesh();
    change(mesh);
    return errorOf([&] { tetrahedralize(mesh, cell, "cube"); });
  };
  EXPECT_EQ(refused([](TriangleMesh&) {}), "");
  EXPECT_EQ(refused([](TriangleMesh& m) { m.triangles.pop_back(); }),
            "cube.triangles[4]: expected a closed surface, got a hole beside the edge from vertex 1 to 5");
  EXPECT_NE(refused([](TriangleMesh& m) {
              std::swap(m.triangles[3][0], m.triangles[3][1]);
            }).find("cube.triangles[3]: expected two triangles on each edge"),
            std::string::npos);
  EXPECT_NE(
      refused([](TriangleMesh& m) { m.triangles.push_back(m.triangles[0]); }).find("cube.triangles[12]"),
      std::string::npos);
  EXPECT_NE(refused([](TriangleMesh& m) {
              for (auto& t : m.triangles) std::swap(t[0], t[1]);
            }).find("counter-clockwise"),
            std::string::npos);
  EXPECT_NE(refused([](TriangleMesh& m) {
              m.triangles[2][1] = 99;
            }).find("cube.triangles[2]: expected indices below 8, got 99"),
            std::string::npos);
  EXPECT_NE(refused([](TriangleMesh& m) { m.vertices[3] = m.vertices[2]; }).find("a positive area"),
            std::string::npos);
  EXPECT_NE(refused([](TriangleMesh& m) { m.vertices[3].x = std::nan(""); }).find("cube.vertices[3]"),
            std::string::npos);
  EXPECT_NE(refused([](TriangleMesh&) {}, 9).find("cube.cell: expected cells that fit"), std::string::npos);
  EXPECT_NE(refused([](TriangleMesh&) {}, 1e-4).find("cube.cell: expected a width that gives fewer"),
            std::string::npos);
  EXPECT_NE(refused([](TriangleMesh&) {}, 0).find("cube.cell"), std::string::npos);
  EXPECT_NE(refused([](TriangleMesh& m) { m.triangles.clear(); }).find("at least four"), std::string::npos);
}

TEST(Mesh, ClothLeavesOutWhatItDoesNotUse) {
  TriangleMesh mesh{{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {8, 8, 8}, {0, 1, 0}}, {{1, 2, 4}}};
  const ClothDef cloth = clothFromMesh(mesh);
  EXPECT_EQ(cloth.vertices.size(), 3u);
  EXPECT_NO_THROW(validate(cloth, "cloth"));
  mesh.triangles[0][2] = 5;
  EXPECT_NE(errorOf([&] { clothFromMesh(mesh); }).find("mesh.triangles[0]"), std::string::npos);
}

TEST(Mesh, SolidsTurnTetrahedraOver) {
  const TetSolidDef solid = tetSolidFromMesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 2, 3}}});
  EXPECT_NO_THROW(validate(solid, "solid"));
}

TEST(Mesh, RodsRefuseSegmentsTooShortToBeMeant) {
  const std::vector<Vec3> points{{0, 0, 0}, {10, 0, 0}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double segment : {1e-300, 1e-9, 2e-9, 1e-7, 0., -1., nan}) {
    try {
      cableAlong(points, segment);
      ADD_FAILURE() << segment;
    } catch (const Error& error) {
      EXPECT_EQ(error.path(), "segment") << error.what();
    }
  }
  EXPECT_EQ(cableAlong(points, 1e-3).vertices.size(), 10001u);
  EXPECT_EQ(cableAlong(points, 1e18).vertices.size(), 2u);
  EXPECT_THROW(cableAlong({{0, 0, 0}, {nan, 0, 0}}, 1), Error);
}

TEST(Mesh, RodsHaveSegmentsOfOneLength) {
  const CableDef bent = cableAlong({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}}, .24);
  ASSERT_EQ(bent.vertices.size(), 14u);
  EXPECT_EQ(bent.vertices.front(), (Vec3{0, 0, 0}));
  EXPECT_LT(length(bent.vertices.back() - Vec3{1, 2, 0}), 1e-12);
  EXPECT_NEAR(length(bent.vertices[1] - bent.vertices[0]), 3. / 13, 1e-12);
  EXPECT_NEAR(bent.vertices[5].y, 5 * 3. / 13 - 1, 1e-12);
  const CableDef ring = cableAlong({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, .5, true);
  EXPECT_TRUE(ring.closed);
  EXPECT_EQ(ring.vertices.size(), 8u);
  EXPECT_NO_THROW(validate(ring, "ring"));
  EXPECT_NE(errorOf([] { cableAlong({{0, 0, 0}}, 1); }), "");
  EXPECT_NE(errorOf([] { cableAlong({{0, 0, 0}, {0, 0, 0}}, 1); }), "");
  EXPECT_NE(errorOf([] { cableAlong({{0, 0, 0}, {1, 0, 0}}, 0); }), "");
}

}  // namespace
}  // namespace rubble
