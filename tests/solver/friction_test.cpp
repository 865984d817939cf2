/// Circular friction: the cut force and its cone-consistent Hessian (METHOD 6.2).
#include <solver/friction.h>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

struct Tangent {
  Real k, c1, c2, l1, l2, normal, mu, muDynamic;
  TangentForce<Real> force(bool cone = true) const {
    return frictionForce<Real>(k, c1, c2, l1, l2, normal, mu, muDynamic, cone);
  }
  Real size() const { return std::hypot(k * c1 + l1, k * c2 + l2); }
};

Tangent randomTangent(Random& random) {
  Tangent t;
  t.k = random.logUniform(1, 100);
  t.c1 = random.uniform(-1, 1), t.c2 = random.uniform(-1, 1), t.l1 = random.uniform(-5, 5),
  t.l2 = random.uniform(-5, 5);
  t.normal = random.logUniform(1, 100);
  t.mu = t.muDynamic = random.uniform(.1, 1);
  return t;
}

TEST(Friction, InsideTheConeIsTheFreeForce) {
  Random random(1);
  int inside = 0;
  for (int i = 0; i < 300; ++i) {
    const Tangent t = randomTangent(random);
    if (t.size() > t.mu * t.normal) continue;
    ++inside;
    const TangentForce<Real> f = t.force();
    EXPECT_NEAR(f.f1, t.k * t.c1 + t.l1, 1e-12);
    EXPECT_NEAR(f.f2, t.k * t.c2 + t.l2, 1e-12);
    EXPECT_EQ(f.inside, 1);
    EXPECT_EQ(f.w11(), t.k);
    EXPECT_EQ(f.w12(), 0);
    EXPECT_EQ(f.w22(), t.k);
  }
  EXPECT_GT(inside, 50);
}

TEST(Friction, OutsideTheConeLiesOnItAlongTheFreeForce) {
  Random random(2);
  int outside = 0;
  for (int i = 0; i < 300; ++i) {
    const Tangent t = randomTangent(random);
    if (t.size() <= t.mu * t.normal) continue;
    ++outside;
    const TangentForce<Real> f = t.force();
    EXPECT_EQ(f.inside, 0);
    EXPECT_NEAR(std::hypot(f.f1, f.f2), t.mu * t.normal, 1e-12 * t.size());
    EXPECT_NEAR(f.f1 * (t.k * t.c2 + t.l2) - f.f2 * (t.k * t.c1 + t.l1), 0, 1e-10 * t.size() * t.size());
    EXPECT_GT(f.f1 * (t.k * t.c1 + t.l1) + f.f2 * (t.k * t.c2 + t.l2), 0);
  }
  EXPECT_GT(outside, 50);
}

TEST(Friction, LeavesTheStaticConeOntoTheDynamicOne) {
  const Tangent held{1, 5.9, 0, 0, 0, 10, .6, .4}, sliding{1, 6.1, 0, 0, 0, 10, .6, .4};
  EXPECT_NEAR(held.force().f1, 5.9, 1e-14);
  EXPECT_NEAR(sliding.force().f1, 4, 1e-14);
}

/// Central difference of the cut force along the direction u.
Vec3 slope(const Tangent& t, Real u1, Real u2) {
  constexpr Real h = 1e-6;
  Tangent plus = t, minus = t;
  plus.c1 += h * u1, plus.c2 += h * u2, minus.c1 -= h * u1, minus.c2 -= h * u2;
  const TangentForce<Real> a = plus.force(), b = minus.force();
  return {(a.f1 - b.f1) / (2 * h), (a.f2 - b.f2) / (2 * h), 0};
}

TEST(Friction, HessianAcrossTheSlidingDirectionIsTheExactDerivative) {
  Random random(3);
  int outside = 0;
  for (int i = 0; i < 300; ++i) {
    const Tangent t = randomTangent(random);
    if (t.size() <= 1.01 * t.mu * t.normal) continue;
    ++outside;
    const Real e1 = (t.k * t.c1 + t.l1) / t.size(), e2 = (t.k * t.c2 + t.l2) / t.size();
    const Vec3 derivative = slope(t, -e2, e1);
    const TangentForce<Real> f = t.force();
    EXPECT_NEAR(-f.w11() * e2 + f.w12() * e1, derivative.x, 1e-7 * t.k);
    EXPECT_NEAR(-f.w12() * e2 + f.w22() * e1, derivative.y, 1e-7 * t.k);
  }
  EXPECT_GT(outside, 50);
}

TEST(Friction, HessianAlongTheSlidingDirectionIsTheSecantOrHalfTheStoppingOneAndAtMostK) {
  Random random(4);
  int secants = 0;
  for (int i = 0; i < 300; ++i) {
    const Tangent t = randomTangent(random);
    if (t.size() <= t.mu * t.normal) continue;
    const Real e1 = (t.k * t.c1 + t.l1) / t.size(), e2 = (t.k * t.c2 + t.l2) / t.size();
    const TangentForce<Real> f = t.force();
    const Real along = f.w11() * e1 * e1 + 2 * f.w12() * e1 * e2 + f.w22() * e2 * e2;
    const Real slip = std::fabs(t.c1 * e1 + t.c2 * e2);
    const Real secant = std::fabs(t.mu * t.normal - (t.l1 * e1 + t.l2 * e2)) / slip;
    EXPECT_NEAR(along, std::min(t.k, std::max(secant, kSlidingResistance * t.mu * t.normal / slip)),
                1e-9 * t.k);
    // no coupling between along and across
    EXPECT_NEAR((f.w22() - f.w11()) * e1 * e2 + f.w12() * (e1 * e1 - e2 * e2), 0, 1e-9 * t.k);
    secants += secant < t.k;
  }
  EXPECT_GT(secants, 30);
}

TEST(Friction, SecantReachesTheConeInOneNewtonStep) {
  // a row with lambda 1 that slides to C = 2: force(0) + secant C = bound
  const Tangent t{100, 2, 0, 1, 0, 10, .5, .5};
  EXPECT_NEAR(t.l1 + t.force().w11() * t.c1, 5, 1e-12);
}

TEST(Friction, UnclampedHessianIsKInBothDirections) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Tangent t = randomTangent(random);
    const TangentForce<Real> cone = t.force(true), plain = t.force(false);
    EXPECT_EQ(plain.f1, cone.f1);
    EXPECT_EQ(plain.f2, cone.f2);
    EXPECT_EQ(plain.w11(), t.k);
    EXPECT_EQ(plain.w22(), t.k);
    EXPECT_EQ(plain.w12(), 0);
  }
}

TEST(Friction, TurnsWithTheTangentBasis) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Tangent t = randomTangent(random);
    const Real a = random.uniform(0, 6), c = std::cos(a), s = std::sin(a);
    Tangent turned = t;
    turned.c1 = c * t.c1 - s * t.c2, turned.c2 = s * t.c1 + c * t.c2;
    turned.l1 = c * t.l1 - s * t.l2, turned.l2 = s * t.l1 + c * t.l2;
    const TangentForce<Real> f = t.force(), g = turned.force();
    EXPECT_NEAR(g.f1, c * f.f1 - s * f.f2, 1e-10);
    EXPECT_NEAR(g.f2, s * f.f1 + c * f.f2, 1e-10);
    EXPECT_NEAR(g.w11() + g.w22(), f.w11() + f.w22(), 1e-8 * t.k);
    EXPECT_NEAR(g.w11(), c * c * f.w11() - 2 * c * s * f.w12() + s * s * f.w22(), 1e-8 * t.k);
  }
}

TEST(Friction, IsFiniteWithoutLoadAndWithoutMotion) {
  const Tangent unloaded{100, .1, 0, 0, 0, 0, .5, .5}, still{100, 0, 0, 0, 0, 0, .5, .5},
      held{100, 0, 0, 9, 0, 1, .5, .5};
  for (const Tangent& t : {unloaded, still, held}) {
    const TangentForce<Real> f = t.force();
    EXPECT_TRUE(isFinite(f.f1 + f.f2 + f.w11() + f.w12() + f.w22()));
  }
  EXPECT_EQ(unloaded.force().f1, 0);
  EXPECT_NEAR(held.force().f1, .5, 1e-15);
}

TEST(Friction, OfFourLanesEqualsThatOfSinglePoints) {
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    Tangent t[4];
    Real4 v[8];
    for (int k = 0; k < 4; ++k) {
      t[k] = randomTangent(random);
      const Real fields[8] = {t[k].k,  t[k].c1,     t[k].c2, t[k].l1,
                              t[k].l2, t[k].normal, t[k].mu, t[k].muDynamic};
      for (int m = 0; m < 8; ++m) v[m][k] = fields[m];
    }
    const TangentForce<Real4> four = frictionForce<Real4>(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7],
                                                          true);
    for (int k = 0; k < 4; ++k) {
      const TangentForce<Real> one = t[k].force();
      EXPECT_EQ(four.f1[k], one.f1);
      EXPECT_EQ(four.f2[k], one.f2);
      EXPECT_EQ(four.w11()[k], one.w11());
      EXPECT_EQ(four.w12()[k], one.w12());
      EXPECT_EQ(four.w22()[k], one.w22());
      EXPECT_EQ(four.inside[k], one.inside);
    }
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
