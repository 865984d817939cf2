/// Deformable objects that are built from numbers alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>

#include <rubble/deformables.h>
#include <rubble/error.h>

namespace rubble {
namespace {

/// How many tetrahedra have each face.
std::map<std::array<int, 3>, int> facesOf(const TetSolidDef& d) {
  std::map<std::array<int, 3>, int> faces;
  for (const auto& t : d.tetrahedra)
    for (std::size_t left = 0; left < 4; ++left) {
      std::array<int, 3> face;
      for (std::size_t k = 0, n = 0; k < 4; ++k)
        if (k != left) face[n++] = t[k];
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  return faces;
}

double volumeOf(const TetSolidDef& d, const std::array<int, 4>& t) {
  const auto at = [&](std::size_t k) { return d.vertices[static_cast<std::size_t>(t[k])]; };
  return dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) / 6;
}

class SoftBall : public testing::TestWithParam<int> {};

TEST_P(SoftBall, IsFilledByTetrahedraThatFitToOneAnother) {
  constexpr double kRadius = .7;
  const TetSolidDef ball = tetBall({1, 2, 3}, kRadius, GetParam());
  double volume = 0;
  for (const auto& t : ball.tetrahedra) {
    EXPECT_GT(volumeOf(ball, t), 0);
    volume += volumeOf(ball, t);
  }
  for (const auto& [face, count] : facesOf(ball)) {
    EXPECT_LE(count, 2);
    // a face of one tetrahedron is a part of the surface
    if (count != 1) continue;
    for (const int v : face)
      EXPECT_NEAR(length(ball.vertices[static_cast<std::size_t>(v)] - Vec3{1, 2, 3}), kRadius, 1e-12);
  }
  // flat faces lack a share that falls with the square of their size: 0.88 / n^2 with 2 cells, 1.15 / n^2
  // with
  // 9
  const double whole = 4 * std::numbers::pi / 3 * kRadius * kRadius * kRadius,
               lacking = (1 - volume / whole) * GetParam() * GetParam();
  EXPECT_GT(lacking, .8);
  EXPECT_LT(lacking, 1.2);
}

TEST_P(SoftBall, HasNoTetrahedronWithAllCornersOnItsSurface) {
  const TetSolidDef ball = tetBall({0, 0, 0}, 1, GetParam());
  for (const auto& t : ball.tetrahedra)
    EXPECT_FALSE(std::all_of(t.begin(), t.end(), [&](int v) {
      return length(ball.vertices[static_cast<std::size_t>(v)]) > .999;
    }));
}

INSTANTIATE_TEST_SUITE_P(Cells, SoftBall, testing::Values(2, 3, 4, 5, 9));

TEST(SoftBall, WantsTwoCellsAndARadius) {
  EXPECT_THROW(tetBall({0, 0, 0}, 1, 1), Error);
  EXPECT_THROW(tetBall({0, 0, 0}, 0, 4), Error);
}

}  // namespace
}  // namespace rubble
