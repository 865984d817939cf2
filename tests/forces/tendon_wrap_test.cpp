/// Lengths of tendons around spheres and cylinders.
#include "forces/tendon_wrap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rubble::RUBBLE_CORE {
namespace {

struct WrapCase {
  Vec3 from, to, axis, guide;
  double radius;
  bool guided;

  double length(const Vec3& a, const Vec3& b) const {
    const WrappedArc arc = wrapAround(a, b, axis, radius, guided ? &guide : nullptr);
    if (!arc.touches) return rubble::length(b - a);
    return rubble::length(arc.begin - a) + arc.length + rubble::length(b - arc.end);
  }
  bool touches() const { return wrapAround(from, to, axis, radius, guided ? &guide : nullptr).touches; }
};

/// Ends outside of the surface; every second one is a cylinder, every third one has a guide inside.
template <class Claim> void forEachCase(Claim&& claim) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto direction = [&] {
    Vec3 v;
    do v = {any(random), any(random), any(random)};
    while (lengthSquared(v) > 1 || lengthSquared(v) < .01);
    return normalize(v);
  };
  int touching[2] = {};
  for (int i = 0; i < 3000; ++i) {
    WrapCase c{};
    c.radius = .3 + .2 * any(random);
    if (i % 2 == 0) c.axis = direction();
    const auto outside = [&] {
      const Vec3 d = direction();
      const double across = rubble::length(d - dot(c.axis, d) * c.axis);
      return d * (c.radius * (1.05 + std::fabs(any(random))) / std::max(across, .1));
    };
    do c.from = outside(), c.to = outside();
    while (i % 2 == 0 && (rubble::length(cross(c.axis, c.from)) < 1.02 * c.radius ||
                          rubble::length(cross(c.axis, c.to)) < 1.02 * c.radius));
    c.guided = i % 3 == 0;
    c.guide = .3 * c.radius * direction();
    if (!c.touches()) continue;
    ++touching[c.guided];
    claim(c, i);
  }
  EXPECT_GT(std::min(touching[0], touching[1]), 200);
}

TEST(TendonWrap, IsTheShortestWayAroundASphere) {
  forEachCase([](const WrapCase& c, int i) {
    if (c.guided || lengthSquared(c.axis) > 0) return;
    const double a = length(c.from), b = length(c.to);
    const double turn = std::acos(dot(c.from, c.to) / (a * b)) - std::acos(c.radius / a) -
                        std::acos(c.radius / b);
    const double expected = std::sqrt(a * a - c.radius * c.radius) + std::sqrt(b * b - c.radius * c.radius) +
                            c.radius * turn;
    EXPECT_NEAR(c.length(c.from, c.to), expected, 1e-9) << i;
  });
}

/// The way over any other point of the circle, of those between the ends, is longer.
TEST(TendonWrap, AGuideInsideMakesItTouchWhereTheWayIsShortest) {
  forEachCase([](const WrapCase& c, int i) {
    if (!c.guided || lengthSquared(c.axis) > 0) return;
    const Vec3 u = normalize(c.from), v = normalize(c.to);
    double shortest = 1e9;
    for (int k = 0; k <= 2000; ++k) {
      const Vec3 w = c.radius * normalize(u + (k / 2000.) * (v - u));
      shortest = std::min(shortest, length(w - c.from) + length(c.to - w));
    }
    EXPECT_NEAR(c.length(c.from, c.to), shortest, 1e-5) << i;
    EXPECT_LT(c.length(c.from, c.to), shortest + 1e-12) << i;
  });
}

/// dL/dx of an end is the direction in which the tendon reaches it.
TEST(TendonWrap, ItsLengthChangesAsItsStraightPiecesSay) {
  forEachCase([](const WrapCase& c, int i) {
    const WrappedArc arc = wrapAround(c.from, c.to, c.axis, c.radius, c.guided ? &c.guide : nullptr);
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 3; ++k) {
      Vec3 step{};
      step[k] = kStep;
      const double left = c.length(c.from - step, c.to), right = c.length(c.from + step, c.to);
      if (std::fabs(left - right) > 2.01 * kStep) continue;  // another side of the surface is shorter there
      EXPECT_NEAR((right - left) / (2 * kStep), normalize(c.from - arc.begin)[k], 1e-4) << i;
      EXPECT_NEAR((c.length(c.from, c.to + step) - c.length(c.from, c.to - step)) / (2 * kStep),
                  normalize(c.to - arc.end)[k], 1e-4)
          << i;
    }
  });
}

/// Once around a half of a circle, on the side that the guide is on.
TEST(TendonWrap, KeepsToTheSideOfItsGuide) {
  for (const double side : {1., -1.}) {
    const WrapCase c{{-2, .5, 0}, {2, .5, 0}, {0, 0, 1}, {0, 3 * side, 0}, 1, true};
    const WrappedArc arc = wrapAround(c.from, c.to, c.axis, c.radius, &c.guide);
    ASSERT_TRUE(arc.touches);
    EXPECT_GT(side * arc.begin.y, 0);
    EXPECT_GT(side * arc.end.y, 0);
    EXPECT_GT(arc.length, 0);
  }
  // far from the surface, on the side of the guide: straight; on the other one: around
  const Vec3 guide{0, 1.5, 0};
  EXPECT_FALSE(wrapAround({-2, 1.5, 0}, {2, 1.5, 0}, {0, 0, 1}, 1, &guide).touches);
  EXPECT_TRUE(wrapAround({-2, -1.5, 0}, {2, -1.5, 0}, {0, 0, 1}, 1, &guide).touches);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
