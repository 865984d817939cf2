/// Parts of contacts in closed form: paths of points on round bodies, one-way surfaces, rules of materials.
#include <gtest/gtest.h>

#include <vector>

#include "stages/contacts/one_way.h"
#include "stages/contacts/rolled.h"
#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// A point of a body at lever r with outward normal `out`, for a rotation in one step.
Vec3 swept(const ShapeData& shape, const Vec3& dw, const Vec3& r, const Vec3& out) {
  BodyParams params{};
  params.shape = shape;
  Quat orientation{};
  SolverData s{};
  s.params = &params, s.orientation = &orientation;
  return sweptBy(s, 0, dw, expRotation(dw), r, out);
}

TEST(SweptPoint, OfARollingShapeGoesAlongTheArc) {
  constexpr Real kRadius = .3, kHalf = .5;
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Vec3 dw = random.vector(.6), out = random.direction(), round = kRadius * out;
    const ShapeData ball{{0, 0, 0}, kRadius, ShapeKind::Sphere, -1},
        rod{{0, 0, kHalf}, kRadius, ShapeKind::Capsule, -1}, brick{{.3, .2, .1}, 0, ShapeKind::Box, -1};
    EXPECT_TRUE(test::near(swept(ball, dw, round, out), cross(dw, round), 1e-12));
    // the end of the axis moves with the body, and the round part rolls
    const Vec3 end{0, 0, kHalf}, moved = rotate(expRotation(dw), end) - end;
    EXPECT_TRUE(test::near(swept(rod, dw, end + round, out), moved + cross(dw, round), 1e-12));
    const Vec3 corner{.3, .2, .1}, turned = rotate(expRotation(dw), corner) - corner;
    EXPECT_TRUE(test::near(swept(brick, dw, corner, out), turned, 1e-12));
    // slow rotations count as those of material points, which is the same to second order
    const Vec3 slow = dw * Real(1e-3);
    EXPECT_TRUE(test::near(swept(ball, slow, round, out), cross(slow, round), 1e-6));
  }
}

TEST(OneWay, HoldsWithinSixtyDegreesOfItsDirection) {
  const Vec3 way{0, 0, 1};
  const auto normalAt = [](Real cosine) { return Vec3{std::sqrt(1 - cosine * cosine), 0, cosine}; };
  for (const Real cosine : {.5, .51, 1.}) EXPECT_TRUE(isInFront(way, normalAt(cosine))) << cosine;
  for (const Real cosine : {.49, 0., -1.}) EXPECT_FALSE(isInFront(way, normalAt(cosine))) << cosine;
  EXPECT_TRUE(isInFront({0, 0, 0}, {0, 0, -1})) << "other surfaces have no direction";
}

TEST(MaterialRules, AreFoundForTwoKindsInEitherOrder) {
  // sorted by world, then by kinds
  std::vector<MaterialRule> rules;
  for (const auto& [world, low, high] : {std::array{0, 1, 1}, {0, 1, 3}, {0, 2, 5}, {1, 1, 2}, {1, 2, 5}})
    rules.push_back({world, low, high, 0, 0, 0, 0, 0, 0});
  SolverData s{};
  s.materialRules = static_cast<int>(rules.size()), s.materialRule = rules.data();
  for (int world = 0; world < 2; ++world)
    for (int a = 0; a < 7; ++a)
      for (int b = 0; b < 7; ++b) {
        const MaterialRule* expected = nullptr;
        for (const MaterialRule& r : rules)
          if (r.world == world && r.low == std::min(a, b) && r.high == std::max(a, b)) expected = &r;
        EXPECT_EQ(ruleOf(s, world, a, b), expected) << world << ": " << a << ", " << b;
      }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
