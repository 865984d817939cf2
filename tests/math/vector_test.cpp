/// Vectors, quaternions and 3x3 matrices against Eigen.
#include <math/hd.h>

#include "tests/support/eigen.h"
#include "tests/support/expect.h"
#include "tests/support/random.h"

namespace rubble {
namespace {

using test::eigen;
using test::Random;

constexpr double kTight = 1e-14;

TEST(Vector, AgreesWithEigen) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = random.vector(), b = random.vector();
    const double s = random.uniform(-2, 2);
    EXPECT_NEAR(dot(a, b), eigen(a).dot(eigen(b)), kTight);
    EXPECT_NEAR((eigen(cross(a, b)) - eigen(a).cross(eigen(b))).norm(), 0, kTight);
    EXPECT_NEAR((eigen(s * a - b / s) - (s * eigen(a) - eigen(b) / s)).norm(), 0,
                kTight * (1 + 1 / std::fabs(s)));
    EXPECT_NEAR((eigen(mul(a, b)) - eigen(a).cwiseProduct(eigen(b))).norm(), 0, kTight);
    EXPECT_NEAR((eigen(abs(a)) - eigen(a).cwiseAbs()).norm(), 0, 0);
    EXPECT_NEAR(length(a), eigen(a).norm(), kTight);
    EXPECT_NEAR(lengthSquared(a), eigen(a).squaredNorm(), kTight);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(a[k], eigen(a)(k));
  }
}

template <class R> void expectUnitOrFallback(int smallest) {
  const Vec3T<R> fallback{1, 0, 0}, a{0, R(-.75), R(1)};
  for (int power = 0; power > smallest; --power) {
    const Vec3T<R> n = normalize(a * std::ldexp(R(1), power), fallback);
    if (2 * power > smallest)
      EXPECT_EQ(n, normalize(a, fallback)) << power;
    else
      EXPECT_EQ(n, fallback) << power;
  }
}

TEST(Vector, NormalizeGivesAUnitVectorOrFallsBackWhereASquareLosesBits) {
  EXPECT_EQ(normalize(Vec3{}, Vec3{1, 0, 0}), (Vec3{1, 0, 0}));
  expectUnitOrFallback<float>(-127);
  expectUnitOrFallback<double>(-1023);
}

TEST(Quaternion, ProductAndRotationAgreeWithEigen) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Quat p = random.rotation(), q = random.rotation();
    const Vec3 a = random.vector();
    EXPECT_NEAR((eigen(p * q).coeffs() - (eigen(p) * eigen(q)).coeffs()).norm(), 0, kTight);
    EXPECT_NEAR((eigen(conjugate(p)).coeffs() - eigen(p).inverse().coeffs()).norm(), 0, kTight);
    EXPECT_NEAR((eigen(rotate(p, a)) - eigen(p) * eigen(a)).norm(), 0, kTight);
    EXPECT_NEAR((eigen(rotateInverse(p, a)) - eigen(p).inverse() * eigen(a)).norm(), 0, kTight);
    EXPECT_NEAR((eigen(rotationMatrix(p)) - eigen(p).toRotationMatrix()).norm(), 0, kTight);
  }
}

TEST(Quaternion, FromAxisAngleAgreesWithEigen) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Vec3 axis = random.direction();
    const double angle = random.uniform(-7, 7);
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle, eigen(axis)));
    EXPECT_NEAR((eigen(fromAxisAngle(axis, angle)).coeffs() - expected.coeffs()).norm(), 0, kTight);
  }
}

TEST(Quaternion, NormalizeGivesUnitLengthAndKeepsTheRotation) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Quat q = random.rotation();
    const double scale = random.logUniform(1e-3, 1e3);
    const Quat n = normalize(Quat{q.s * scale, q.v * scale});
    EXPECT_NEAR(n.s * n.s + dot(n.v, n.v), 1, kTight);
    EXPECT_NEAR((eigen(n).coeffs() - eigen(q).coeffs()).norm(), 0, kTight);
  }
}

TEST(Matrix, AgreesWithEigen) {
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    const Mat3 m{random.vector(), random.vector(), random.vector()},
        n{random.vector(), random.vector(), random.vector()};
    const Vec3 a = random.vector();
    EXPECT_NEAR((eigen(m * n) - eigen(m) * eigen(n)).norm(), 0, kTight);
    EXPECT_NEAR((eigen(m + 2. * n) - (eigen(m) + 2 * eigen(n))).norm(), 0, kTight);
    EXPECT_NEAR((eigen(m * a) - eigen(m) * eigen(a)).norm(), 0, kTight);
    EXPECT_NEAR((eigen(transpose(m)) - eigen(m).transpose()).norm(), 0, 0);
    EXPECT_NEAR((eigen(mulTransposed(m, a)) - eigen(m).transpose() * eigen(a)).norm(), 0, kTight);
    EXPECT_NEAR((eigen(crossMatrix(a) * m.c0) - eigen(a).cross(eigen(m.c0))).norm(), 0, kTight);
  }
}

TEST(Scalar, IsFiniteKnowsInfinitiesAndNotANumber) {
  using namespace RUBBLE_CORE;
  constexpr double kInf = std::numeric_limits<double>::infinity(),
                   kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(isFinite(Real(0)) && isFinite(Real(-1e300)));
  EXPECT_FALSE(isFinite(Real(kInf)) || isFinite(Real(-kInf)) || isFinite(Real(kNan)));
  for (int i = 0; i < 3; ++i) {
    rubble::Vec3 a{1, 2, 3};
    EXPECT_TRUE(RUBBLE_CORE::isFinite(a));
    a[i] = kNan;
    EXPECT_FALSE(RUBBLE_CORE::isFinite(a)) << i;
    a[i] = -kInf;
    EXPECT_FALSE(RUBBLE_CORE::isFinite(a)) << i;
  }
}

TEST(Scalar, AtomicCountersCountAndRaise) {
  int count = 5;
  EXPECT_EQ(RUBBLE_CORE::atomicCount(&count, 3), 5);
  EXPECT_EQ(count, 8);
  RUBBLE_CORE::atomicRaise(&count, 6);
  EXPECT_EQ(count, 8);
  RUBBLE_CORE::atomicRaise(&count, 11);
  EXPECT_EQ(count, 11);
}

TEST(Scalar, HashSpreadsNeighboringNumbers) {
  // neighboring inputs differ in about half of the 32 bits
  double flipped = 0;
  constexpr int kInputs = 4096;
  for (std::uint32_t i = 0; i < kInputs; ++i)
    flipped += __builtin_popcount(RUBBLE_CORE::hash32(i) ^ RUBBLE_CORE::hash32(i + 1));
  EXPECT_NEAR(flipped / kInputs, 16, .3);
}

}  // namespace
}  // namespace rubble
