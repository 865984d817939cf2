/// The block of one body against dense matrices.
#include <solver/row.h>

#include "tests/support/core.h"
#include "tests/support/eigen.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::eigen;
using test::Random;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Vector6 eigenOf(const Vec6& a) {
  Vector6 out;
  out << eigen(a.lin), eigen(a.ang);
  return out;
}
Matrix6 hessianOf(const Block6& block) {
  const Sym6 h = pack(block);
  Matrix6 out;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) out(i, j) = h(i, j);
  return out;
}
Vector6 forceOf(const Block6& block) { return eigenOf({block.fl, block.fa}); }

/// A block and the same as dense matrices.
struct Both {
  Block6 block;
  Matrix6 h = Matrix6::Zero();
  Vector6 f = Vector6::Zero();
};

Both randomBoth(Random& random) {
  Both both;
  const Pose x = randomPose(random), y = randomPose(random);
  const Quat q = random.rotation();
  const Vec3 inertia{.3, .5, .7};
  const Real mass = 2, inverseDt2 = 3600;
  setInertialForce(both.block, massMatrix(mass, inertia, q), x, y, inverseDt2);
  setInertialHessian(both.block, massMatrix(mass, inertia, q), inverseDt2);
  const Eigen::Matrix3d r = eigen(q).toRotationMatrix();
  both.h.topLeftCorner<3, 3>() = inverseDt2 * mass * Eigen::Matrix3d::Identity();
  both.h.bottomRightCorner<3, 3>() = inverseDt2 * r * eigen(inertia).asDiagonal() * r.transpose();
  both.f = -both.h * eigenOf(difference(x, y));
  for (int i = 0; i < 5; ++i) {
    const Vec6 j = randomVec6(random);
    const Real force = random.uniform(-100, 100), k = random.logUniform(1, 1e5);
    accumulateRow(both.block, j, force, k);
    both.f -= force * eigenOf(j);
    both.h += k * eigenOf(j) * eigenOf(j).transpose();
  }
  const Vec6 g{{1, 2, 3}, {4, 5, 6}};
  accumulateCurvature(both.block, g);
  both.h += eigenOf(g).asDiagonal();
  return both;
}

TEST(Block, AccumulatesRowsAsOuterProducts) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Both both = randomBoth(random);
    EXPECT_NEAR((hessianOf(both.block) - both.h).norm(), 0, 1e-12 * both.h.norm());
    EXPECT_NEAR((forceOf(both.block) - both.f).norm(), 0, 1e-12 * both.f.norm());
  }
}

TEST(Block, NewtonStepIsTheDenseSolution) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Both both = randomBoth(random);
    const Vector6 expected = both.h.llt().solve(both.f);
    EXPECT_NEAR((eigenOf(newtonStep(both.block)) - expected).norm(), 0, 1e-11 * expected.norm());
  }
}

TEST(Block, DescendReachesTheInertialTargetInOneStepWithoutRows) {
  Random random(3);
  const Pose y = randomPose(random);
  Pose x{y.p + random.vector(.1), expRotation(.01 * random.direction()) * y.q};
  const MassMatrix m = massMatrix(2, {.3, .5, .7}, y.q);
  Block6 block;
  setInertialForce(block, m, x, y, 3600);
  setInertialHessian(block, m, 3600);
  ASSERT_EQ(descend(block, m, 3600, x), Descent::Newton);
  EXPECT_TRUE(test::near(x.p, y.p, 1e-14));
  EXPECT_TRUE(test::sameRotation(x.q, y.q, 1e-6));
}

TEST(Block, DescendTakesNoStepThatIsNotFinite) {
  Random random(4);
  const Both both = randomBoth(random);
  for (int i = 0; i < 6; ++i) {
    Block6 broken = both.block;
    (i < 3 ? broken.fl : broken.fa)[i % 3] = std::numeric_limits<Real>::quiet_NaN();
    Pose x = randomPose(random);
    const Pose before = x;
    EXPECT_EQ(descend(broken, massMatrix(1, {1, 1, 1}, Quat{}), 3600, x), Descent::Failed) << i;
    EXPECT_EQ(x.p, before.p);
    EXPECT_EQ(x.q, before.q);
  }
}

/// A block that is not positive definite stands for one whose digits are lost.
TEST(Block, StepsWithMoreEnergyThanTheirForcesDoWorkAreReplaced) {
  Random random(9);
  constexpr Real kInverseDt2 = 3600;
  int replaced = 0;
  for (int i = 0; i < 200; ++i) {
    const MassMatrix m = massMatrix(2, {.3, .5, .7}, random.rotation());
    const Real mass = kInverseDt2 * m.mass;
    const Sym3 inertia = kInverseDt2 * m.inertia;
    const Pose start{random.vector(.01), expRotation(random.vector(.01))};
    Block6 block;
    setInertialForce(block, m, start, {}, kInverseDt2);
    setInertialHessian(block, m, kInverseDt2);
    for (int row = 0; row < 5; ++row)
      accumulateRow(block, randomVec6(random), random.uniform(-100, 100), random.logUniform(1, 1e5));

    const Vec6 newton = newtonStep(block), diagonal = diagonalStep(block), force{block.fl, block.fa};
    EXPECT_TRUE(isWithinWork(block, mass, inertia, newton)) << i;
    EXPECT_FALSE(isWithinWork(block, mass, inertia, -newton)) << i;
    EXPECT_TRUE(isWithinWork(block, mass, inertia, diagonal)) << i;
    EXPECT_GE(dot(force, diagonal), (1 - 1e-12) * dot(diagonal, product(block, diagonal))) << i;
    const Vector6 expected = hessianOf(block) * eigenOf(newton);
    EXPECT_NEAR((eigenOf(product(block, newton)) - expected).norm(), 0, 1e-12 * expected.norm());

    Block6 broken = block;
    broken.al0 *= 20, broken.al1 *= 20, broken.al2 *= 20;
    Pose x = start;
    const bool isTrusted = isWithinWork(broken, mass, inertia, trustedStep(broken, start.q));
    const Descent how = descend(broken, m, kInverseDt2, x);
    EXPECT_EQ(how, isTrusted ? Descent::Newton : Descent::Diagonal) << i;
    if (how != Descent::Diagonal) continue;
    ++replaced;
    EXPECT_EQ(x.p, retract(start, diagonalStep(broken)).p);
    EXPECT_LE(mass * dot(x.p - start.p, x.p - start.p), 2 * (1 + 1e-12) * dot(force, diagonalStep(broken)))
        << i;
  }
  EXPECT_GT(replaced, 20);
}

/// dx . I dx <= 2 f . dx, on either side of equality.
TEST(Block, WorkOfARotationIsComparedWithItsOwnInertia) {
  Random random(10);
  for (int i = 0; i < 20; ++i) {
    const Sym3 inertia = 3600 * massMatrix(2, {.3, .5, .7}, random.rotation()).inertia;
    const Vec6 dx{{0, 0, 0}, random.vector(.1)};
    Block6 block{};
    block.fa = .505 * (inertia * dx.ang);
    EXPECT_TRUE(isWithinWork(block, Real(7200), inertia, dx)) << i;
    block.fa = .495 * (inertia * dx.ang);
    EXPECT_FALSE(isWithinWork(block, Real(7200), inertia, dx)) << i;
  }
}

TEST(Block, CurvatureNormsAreThoseOfTheColumnsOfS) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = random.vector(), b = random.vector();
    const Eigen::Vector3d ea = eigen(a), eb = eigen(b);
    const Eigen::Matrix3d s = .5 * (ea * eb.transpose() + eb * ea.transpose()) -
                              ea.dot(eb) * Eigen::Matrix3d::Identity();
    const Vec3 norms = turningColumnNorms(a, b);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(norms[c], s.col(c).norm(), 1e-7);
  }
  EXPECT_EQ(turningColumnNorms({0, 0, 0}, {1, 2, 3}), (Vec3{0, 0, 0}));
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
