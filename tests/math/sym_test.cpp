/// Symmetric matrices and the 6x6 solve against Eigen.
#include "math/block3.h"

#include <math/sym.h>

#include "tests/support/eigen.h"
#include "tests/support/expect.h"
#include "tests/support/random.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::eigen;
using test::Random;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Eigen::Matrix3d eigenOf(const Sym3& m) {
  Eigen::Matrix3d out;
  out << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  return out;
}

/// B B^T + a little of the identity.
Matrix6 randomSpd(Random& random) {
  Matrix6 b;
  for (int i = 0; i < 36; ++i) b(i) = random.uniform(-1, 1);
  return b * b.transpose() + .05 * Matrix6::Identity();
}

Sym6 packed(const Matrix6& m) {
  Sym6 out;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) out.a[Sym6::index(i, j)] = m(i, j);
  return out;
}

Vector6 solved(const Matrix6& h, const Vector6& f) {
  Real x[6];
  for (int i = 0; i < 6; ++i) x[i] = f(i);
  solveLdlt(packed(h), x);
  return Eigen::Map<Vector6>(x);
}

Vector6 randomVector(Random& random) {
  Vector6 v;
  for (int i = 0; i < 6; ++i) v(i) = random.uniform(-1, 1);
  return v;
}

TEST(Sym3, OuterProductRotatedDiagonalAndSolveAgreeWithEigen) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = random.vector(), d{random.uniform(.1, 2), random.uniform(.1, 2), random.uniform(.1, 2)},
               b = random.vector();
    const Quat q = random.rotation();
    const double s = random.uniform(-2, 2);
    EXPECT_NEAR((eigenOf(outer(a, s)) - s * eigen(a) * eigen(a).transpose()).norm(), 0, 1e-14);
    const Sym3 m = rotateDiagonal(q, d);
    const Eigen::Matrix3d r = eigen(q).toRotationMatrix();
    EXPECT_NEAR((eigenOf(m) - r * eigen(d).asDiagonal() * r.transpose()).norm(), 0, 1e-14);
    EXPECT_NEAR((eigen(m * a) - eigenOf(m) * eigen(a)).norm(), 0, 1e-14);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR((eigen(m.column(k)) - eigenOf(m).col(k)).norm(), 0, 0);
    const Eigen::Vector3d expected = eigenOf(m).llt().solve(eigen(b));
    EXPECT_NEAR((eigen(solve(Block3{m, b})) - expected).norm(), 0, 1e-12 * expected.norm());
  }
}

TEST(Sym3, SolveDoesNotDependOnTheScaleOfTheMatrix) {
  Random random(2);
  for (const double scale : {1e-8, 1e8}) {
    const Sym3 unit = rotateDiagonal(random.rotation(), {.5, 1, 2});
    const Sym3 m{scale * unit.xx, scale * unit.xy, scale * unit.xz,
                 scale * unit.yy, scale * unit.yz, scale * unit.zz};
    const Vec3 b = random.vector();
    EXPECT_TRUE(test::near(solve(Block3{m, b}) * scale, solve(Block3{unit, b}), 1e-12));
  }
}

TEST(Sym6, PackPutsEveryEntryOfTheBlockInItsPlace) {
  Random random(3);
  Block6 b;
  b.ll = outer(random.vector()), b.aa = outer(random.vector());
  b.al0 = random.vector(), b.al1 = random.vector(), b.al2 = random.vector();
  Eigen::Matrix3d al;
  al << eigen(b.al0), eigen(b.al1), eigen(b.al2);
  Matrix6 expected;
  expected << eigenOf(b.ll), al.transpose(), al, eigenOf(b.aa);
  const Sym6 h = pack(b);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) EXPECT_EQ(h(i, j), expected(i, j)) << i << " " << j;
}

TEST(SolveLdlt, AgreesWithEigenOnRandomMatrices) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Matrix6 h = randomSpd(random);
    const Vector6 f = randomVector(random), expected = h.ldlt().solve(f);
    EXPECT_NEAR((solved(h, f) - expected).norm(), 0, 1e-10 * expected.norm());
  }
}

TEST(SolveLdlt, AgreesWithEigenOnBadlyScaledMatrices) {
  // rows in units that differ by 1e4 and 1e8, as mass and inertia of a long rod do
  Random random(5);
  for (const double spread : {1e4, 1e8}) {
    for (int i = 0; i < 100; ++i) {
      const Matrix6 unit = randomSpd(random);
      Vector6 scale;
      for (int k = 0; k < 6; ++k) scale(k) = std::sqrt(random.logUniform(1 / spread, 1));
      const Vector6 g = randomVector(random);
      const Matrix6 h = scale.asDiagonal() * unit * scale.asDiagonal();
      const Vector6 f = scale.cwiseProduct(g);
      const Vector6 expected = unit.llt().solve(g);
      EXPECT_NEAR((scale.asDiagonal() * solved(h, f) - expected).norm(), 0, 1e-9 * expected.norm()) << spread;
    }
  }
}

TEST(SolveLdlt, LeavesASmallResidualOnStiffRows) {
  // inertia of 1 with rows of 1e4 and 1e8 on top, as a hard contact makes it: the residual counts
  Random random(6);
  for (const double stiffness : {1e4, 1e8}) {
    for (int i = 0; i < 100; ++i) {
      Matrix6 h = Matrix6::Identity();
      for (int k = 0; k < 3; ++k) {
        const Vector6 j = randomVector(random);
        h += stiffness * j * j.transpose();
      }
      const Vector6 f = randomVector(random), x = solved(h, f);
      EXPECT_LT((h * x - f).norm(), 1e-12 * stiffness * (1 + x.norm())) << stiffness;
      EXPECT_NEAR((x - h.ldlt().solve(f)).norm(), 0, 1e-14 * stiffness * x.norm() + 1e-12);
    }
  }
}

TEST(SolveLdlt, FloorsThePivotsOfASingularMatrix) {
  Matrix6 h = Matrix6::Identity();
  h(0, 1) = h(1, 0) = 1;
  const Vector6 x = solved(h, Vector6::Ones());
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(std::isfinite(x(i))) << i;
  EXPECT_NEAR(x(0) + x(1), 1, 1e-9);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
