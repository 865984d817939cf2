/// Rotation vectors and tangent bases.
#include <math/rotation.h>

#include <numbers>

#include "tests/support/eigen.h"
#include "tests/support/expect.h"
#include "tests/support/random.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;
constexpr double kPi = std::numbers::pi;

TEST(ExpRotation, AgreesWithEigenAtEveryAngle) {
  Random random(1);
  for (const double angle : {1e-12, 1e-6, 1e-3, .0099, .01, .0101, .1, 1., 3., kPi, 5.}) {
    for (int i = 0; i < 20; ++i) {
      const Vec3 axis = random.direction();
      const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle, test::eigen(axis)));
      EXPECT_NEAR((test::eigen(expRotation(angle * axis)).coeffs() - expected.coeffs()).norm(), 0, 1e-15)
          << angle;
    }
  }
}

TEST(ExpRotation, OfZeroIsTheIdentity) { EXPECT_EQ(expRotation({0, 0, 0}), Quat{}); }

TEST(LogRotation, UndoesExpFromNearZeroToNearPi) {
  Random random(2);
  for (const double angle :
       {0., 1e-14, 1e-9, 1e-5, 1e-3, .0999, .1, .1001, .5, 1., 2., 3., kPi - 1e-3, kPi - 1e-6, kPi - 1e-9}) {
    for (int i = 0; i < 20; ++i) {
      const Vec3 a = angle * random.direction();
      EXPECT_TRUE(test::near(logRotation(expRotation(a)), a, 1e-9 * angle + 1e-15)) << angle;
    }
  }
}

TEST(LogRotation, DoesNotDependOnTheSignOfTheQuaternion) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Quat q = random.rotation();
    EXPECT_TRUE(test::near(logRotation(q), logRotation(Quat{-q.s, -q.v}), 1e-14));
    EXPECT_LE(length(logRotation(q)), kPi + 1e-12);
    EXPECT_TRUE(test::sameRotation(expRotation(logRotation(q)), q, 1e-8));
  }
}

TEST(ShortArc, KeepsTheRotationAndMakesTheScalarPartPositive) {
  Random random(4);
  int flipped = 0;
  for (int i = 0; i < 50; ++i) {
    const Quat q = random.rotation(), s = shortArc(q);
    EXPECT_GE(s.s, 0);
    EXPECT_TRUE(test::sameRotation(s, q, 1e-7));
    flipped += q.s < 0;
  }
  EXPECT_GT(flipped, 10);
  EXPECT_LT(flipped, 40);
}

void expectBasis(const Vec3& n) {
  Vec3 t1, t2;
  tangentBasis(n, t1, t2);
  EXPECT_NEAR(length(t1), 1, 1e-14);
  EXPECT_NEAR(length(t2), 1, 1e-14);
  EXPECT_NEAR(dot(t1, n), 0, 1e-14);
  EXPECT_NEAR(dot(t2, n), 0, 1e-14);
  EXPECT_TRUE(test::near(cross(n, t1), t2, 1e-14));
}

TEST(TangentBasis, IsOrthonormalAndRightHandedEverywhere) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) expectBasis(random.direction());
}

TEST(TangentBasis, IsOrthonormalAtThePolesAndAlongTheAxes) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1., -1.}) {
      Vec3 n;
      n[axis] = sign;
      expectBasis(n);
      for (const double tilt : {1e-300, 1e-16, 1e-12, 1e-8, 1e-4}) {
        Vec3 near = n;
        near[(axis + 1) % 3] = tilt;
        near[(axis + 2) % 3] = -tilt;
        expectBasis(normalize(near));
      }
    }
  expectBasis({-.6, .8, -0.});
}

TEST(TangentBasis, IsContinuousOnEachHalfOfTheSphere) {
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    Vec3 n = random.direction();
    if (std::fabs(n.z) < .01) continue;
    const Vec3 m = normalize(n + random.vector(1e-7));
    Vec3 a1, a2, b1, b2;
    tangentBasis(n, a1, a2);
    tangentBasis(m, b1, b2);
    EXPECT_TRUE(test::near(a1, b1, 2e-6));
    EXPECT_TRUE(test::near(a2, b2, 2e-6));
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
