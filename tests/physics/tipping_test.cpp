/// Bodies with round and many-cornered bases on slopes tip where their weight leaves the base, for any yaw.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

using std::numbers::pi;

constexpr double kRadius = .5, kCell = 1.3;
constexpr int kSides = 24;

enum class Ground { Plane, Box, Mesh, Field };
enum class Base { Cylinder, Cone, Prism };

/// A flat ground whose surface holds the origin. Triangles meet nowhere in particular under what stands
/// there.
BodyDef groundOf(Ground kind, const Quat& tilt) {
  constexpr int kCount = 9;
  const Vec3 corner{-4 * kCell + .31, -4 * kCell + .17, 0};
  BodyDef ground = test::ground(3);
  Vec3 at;
  if (kind == Ground::Box) ground.shape = Shape::box({20, 20, .5}), at = {0, 0, -.5};
  if (kind == Ground::Field)
    ground.shape = Shape::heightField(kCount, kCount, {kCell, kCell, 1},
                                      std::vector<double>(kCount * kCount, 0.)),
    at = corner;
  if (kind == Ground::Mesh) {
    std::vector<Vec3> vertices;
    std::vector<std::array<int, 3>> triangles;
    for (int k = 0; k < kCount * kCount; ++k) {
      vertices.push_back(corner + Vec3{kCell * (k % kCount), kCell * (k / kCount), 0});
      if (k % kCount == kCount - 1 || k / kCount == kCount - 1) continue;
      triangles.push_back({k, k + 1, k + kCount + 1});
      triangles.push_back({k, k + kCount + 1, k + kCount});
    }
    ground.shape = Shape::mesh(vertices, triangles);
  }
  ground.position = rotate(tilt, at);
  ground.orientation = tilt;
  return ground;
}

Shape standing(Base base, double halfHeight) {
  if (base == Base::Cylinder) return Shape::cylinder(kRadius, halfHeight);
  if (base == Base::Cone) return Shape::cone(kRadius, halfHeight);
  std::vector<Vec3> corners;
  for (int k = 0; k < 2 * kSides; ++k)
    corners.push_back({kRadius * std::cos(k / 2 * 2 * pi / kSides),
                       kRadius * std::sin(k / 2 * 2 * pi / kSides), k % 2 ? halfHeight : -halfHeight});
  return Shape::hull(corners);
}

/// How far the base reaches down the slope from its middle; `towards`: the way down, seen from the body.
double reachOf(Base base, double towards) {
  if (base != Base::Prism) return kRadius;
  const double edge = 2 * pi / kSides, off = std::remainder(towards - edge / 2, edge);
  return kRadius * std::cos(edge / 2) / std::cos(off);
}

class TippingOn : public ::testing::TestWithParam<std::tuple<Ground, Base>> {
 protected:
  /// Does it tip within 6 s, `off` degrees steeper than it should?
  static bool tips(double slender, double yaw, double down, double off) {
    const auto [ground, base] = GetParam();
    const double halfHeight = slender * kRadius, center = base == Base::Cone ? halfHeight / 2 : halfHeight;
    const double slope = std::atan(reachOf(base, down - yaw) / center) + off * pi / 180;
    const Quat tilt = fromAxisAngle(Vec3{-std::sin(down), std::cos(down), 0}, slope);
    Scene scene = test::emptyScene();
    scene.bodies.push_back(groundOf(ground, tilt));
    BodyDef body = test::body(standing(base, halfHeight), rotate(tilt, {0, 0, halfHeight}), 3);
    body.orientation = tilt * fromAxisAngle(Vec3{0, 0, 1}, yaw);
    scene.bodies.push_back(body);
    World world(scene, test::options(4));
    const Vec3 up = rotate(body.orientation, Vec3{0, 0, 1});
    for (int i = 0; i < 360; ++i) {
      world.step();
      if (dot(up, rotate(world.state(world.bodyAt(1)).orientation, Vec3{0, 0, 1})) < std::cos(10 * pi / 180))
        return true;
    }
    return false;
  }
};

TEST_P(TippingOn, HappensAtTheAngleOfTheClosedFormAtAnyYaw) {
  // of points on triangles those nearer than a hundredth of L are one
  const bool triangles = std::get<0>(GetParam()) == Ground::Mesh || std::get<0>(GetParam()) == Ground::Field;
  const double off = triangles ? 1 : .5;
  for (const double slender : {1., 2.5})
    for (const double yaw : {0., .2, .37})
      for (const double down : {0., .8, 2.1}) {
        EXPECT_FALSE(tips(slender, yaw, down, -off)) << slender << ' ' << yaw << ' ' << down;
        EXPECT_TRUE(tips(slender, yaw, down, off)) << slender << ' ' << yaw << ' ' << down;
      }
}

INSTANTIATE_TEST_SUITE_P(GroundsAndBases, TippingOn,
                         ::testing::Combine(::testing::Values(Ground::Plane, Ground::Box, Ground::Mesh,
                                                              Ground::Field),
                                            ::testing::Values(Base::Cylinder, Base::Cone, Base::Prism)));

}  // namespace
}  // namespace rubble
