/// What plastic flow of a tetrahedron promises: stress comes back to the yield surface along its own
/// direction, volume stays, energy falls.
#include <gtest/gtest.h>

#include "forces/bending.h"
#include "forces/plasticity.h"
#include "tests/support/core.h"
#include "tests/support/random.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

constexpr Real kMu = 4e4, kYield = 3e3, kHardening = 1e4;  // [Pa]

TEST(FoldBend, TurnTakesTheShortWay) {
  EXPECT_NEAR(FoldBend::turn(.5, .2), .3, 1e-15);
  EXPECT_NEAR(FoldBend::turn(3, -3), 6 - 2 * std::numbers::pi, 1e-14);
  EXPECT_NEAR(FoldBend::turn(-3, 3), 2 * std::numbers::pi - 6, 1e-14);
}

struct Clay {
  Tetrahedron element{};
  Vec3 x[4];
  Real volume = 0;
};

/// A tetrahedron of some shape whose corners are then moved by up to `size`, in units of 0.1 m.
Clay clay(Random& random, Real size, Real hardening = kHardening) {
  Clay c;
  c.x[0] = {0, 0, 0}, c.x[1] = {.1, 0, 0}, c.x[2] = {.02, .12, 0}, c.x[3] = {.03, .02, .09};
  for (Vec3& p : c.x) p += random.vector(.01);
  const Vec3 e1 = c.x[1] - c.x[0], e2 = c.x[2] - c.x[0], e3 = c.x[3] - c.x[0];
  const Real det = dot(e1, cross(e2, e3));
  Tetrahedron& t = c.element;
  t.m[0] = cross(e2, e3) / det, t.m[1] = cross(e3, e1) / det, t.m[2] = cross(e1, e2) / det;
  c.volume = det / 6;
  t.mu = kMu * c.volume, t.lambda = 2e5 * c.volume;
  t.yield = kYield * c.volume, t.hardening = hardening * c.volume;
  t.steepest = 1e3 * t.steepness();
  for (Vec3& p : c.x) p += random.vector(.1 * size);
  return c;
}

Real ratioOf(const Clay& c) {
  const Mat3 f = c.element.deformation(c.x);
  return dot(f.c0, cross(f.c1, f.c2));
}
/// Von Mises stress [Pa].
Real mises(const Clay& c) { return kMu * distortion(c.element.deformation(c.x)); }
Real yieldOf(const Clay& c) {
  return (c.element.yield + c.element.hardening * c.element.plasticStrain) / c.volume;
}

/// dev F F^T.
Sym3 deviator(const Clay& c) {
  const Mat3 f = c.element.deformation(c.x);
  Sym3 b = outer(f.c0);
  b += outer(f.c1), b += outer(f.c2);
  const Real mean = (b.xx + b.yy + b.zz) / 3;
  return {b.xx - mean, b.xy, b.xz, b.yy - mean, b.yz, b.zz - mean};
}
Real product(const Sym3& a, const Sym3& b) {
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + 2 * (a.xy * b.xy + a.xz * b.xz + a.yz * b.yz);
}

/// visit(before, after) for many that flow, a little and far.
template <class Visit> void forEachFlow(Visit&& visit) {
  Random random(3);
  int flowed = 0;
  for (int n = 0; n < 2000; ++n) {
    const Clay before = clay(random, n % 2 ? .1 : 1, n % 3 ? kHardening : 0);
    Clay after = before;
    flow(after.element, after.x);
    if (after.element.plasticStrain == Real(0)) continue;
    ++flowed;
    visit(before, after);
  }
  EXPECT_GT(flowed, 500);
}

TEST(Plasticity, StressComesBackToTheYieldStress) {
  forEachFlow([](const Clay& before, const Clay& after) {
    EXPECT_GT(mises(before), kYield);
    EXPECT_GT(after.element.plasticStrain, 0);
    EXPECT_NEAR(mises(after), yieldOf(after), 1e-9 * yieldOf(after));
  });
}

TEST(Plasticity, VolumesStay) {
  forEachFlow([](const Clay& before, const Clay& after) {
    EXPECT_NEAR(ratioOf(after), ratioOf(before), 1e-10 * ratioOf(before));
    const auto inverseVolume = [](const Vec3(&m)[3]) { return dot(m[0], cross(m[1], m[2])); };
    EXPECT_NEAR(inverseVolume(after.element.m), inverseVolume(before.element.m),
                1e-9 * inverseVolume(before.element.m));
  });
}

TEST(Plasticity, StressKeepsItsAxes) {
  forEachFlow([](const Clay& before, const Clay& after) {
    const Sym3 a = deviator(before), b = deviator(after);
    EXPECT_NEAR(product(a, b), std::sqrt(product(a, a) * product(b, b)),
                1e-9 * std::sqrt(product(a, a) * product(b, b)));
  });
}

TEST(Plasticity, EnergyFalls) {
  forEachFlow([](const Clay& before, const Clay& after) {
    EXPECT_LT(after.element.energy(testConstants(), after.x),
              before.element.energy(testConstants(), before.x));
  });
}

TEST(Plasticity, BelowTheYieldStressNothingChanges) {
  Random random(4);
  int below = 0;
  for (int n = 0; n < 100; ++n) {
    const Clay before = clay(random, .02);
    if (mises(before) > kYield) continue;
    Clay after = before;
    flow(after.element, after.x);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(after.element.m[k], before.element.m[k]);
    EXPECT_EQ(after.element.plasticStrain, 0);
    ++below;
  }
  EXPECT_GT(below, 20);
}

TEST(Plasticity, WhatIsFlatOrInvertedDoesNotFlow) {
  Random random(5);
  for (const Real height : {0., .004, -1.}) {
    Clay c = clay(random, 0);
    for (Vec3& p : c.x) p = {2 * p.x, p.y, height * p.z};
    flow(c.element, c.x);
    EXPECT_EQ(c.element.plasticStrain, 0) << height;
  }
}

TEST(Plasticity, WhatWouldBecomeANeedleStaysElastic) {
  Random random(8);
  for (const Real bound : {2., 10., 100.}) {
    Clay c = clay(random, 0, 0);
    const Real first = c.element.steepness();
    c.element.steepest = bound * first;
    Real longest = 1;
    for (int k = 0; k < 60; ++k) {
      const Real strain = c.element.plasticStrain;
      for (Vec3& p : c.x) p = {1.1 * p.x, p.y / std::sqrt(1.1), p.z / std::sqrt(1.1)};
      flow(c.element, c.x);
      if (c.element.plasticStrain > strain) longest *= 1.1;
    }
    EXPECT_LE(c.element.steepness(), bound * first);
    EXPECT_GT(c.element.steepness(), .5 * bound * first);
    EXPECT_GT(longest, .5 * bound);
    EXPECT_LT(longest, 2 * bound);
  }
}

TEST(Plasticity, ShapesStayFiniteWhereverCornersAreThrown) {
  Random random(6);
  for (int n = 0; n < 1000; ++n) {
    Clay c = clay(random, 0);
    for (int k = 0; k < 5; ++k) {
      for (Vec3& p : c.x) p = random.vector(n % 2 ? 1 : 100);
      flow(c.element, c.x);
      ASSERT_TRUE(isFinite(c.element.m[0]) && isFinite(c.element.m[1]) && isFinite(c.element.m[2]) &&
                  isFinite(c.element.plasticStrain));
    }
  }
}

TEST(Plasticity, CopiesOfCornersTakeTheShapeOfTheirElement) {
  Random random(7);
  Clay c = clay(random, 1);
  for (int k = 0; k < 4; ++k) c.element.v[k] = 10 - k;
  for (int own = 0; own < 4; ++own) {
    TetraCorner corner{};
    for (int k = 0, n = 0; k < 4; ++k)
      if (k != own) corner.other[n++] = c.element.v[k];
    corner.takeShape(c.element);
    EXPECT_LT(length(corner.gradient(0) - c.element.gradient(own)), 1e-9);
    for (int n = 0; n < 3; ++n) EXPECT_EQ(corner.m[n], c.element.gradient(10 - corner.other[n]));
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
