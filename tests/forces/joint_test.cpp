/// Every joint of the list: derivatives by finite differences, momentum, frame invariance.
#include <forces/forces.h>

#include <algorithm>

#include "tests/forces/joint_cases.h"
#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

template <class F> struct JointTest : ::testing::Test {};

template <class List> struct AsTypes;
template <class... F> struct AsTypes<TypeList<F...>> { using Types = ::testing::Types<F...>; };
struct JointNames {
  template <class F> static std::string GetName(int) { return F::kName; }
};
TYPED_TEST_SUITE(JointTest, AsTypes<JointTypes>::Types, JointNames);

template <class F> struct Rows { Real c[F::kRows]; };
template <class F> Rows<F> constraintOf(const JointCase<F>& x) {
  Rows<F> rows;
  F::constraint(x.data, x.a, x.b, rows.c);
  return rows;
}
/// The case with one body moved along the retraction [S 9].
template <class F> JointCase<F> moved(JointCase<F> x, int side, const Vec6& dx) {
  Pose& pose = side == 0 ? x.a : x.b;
  pose = retract(pose, dx);
  return x;
}

constexpr int kCases = 30;

TYPED_TEST(JointTest, JacobianIsTheDerivativeOfTheConstraint) {
  using F = TypeParam;
  Random random(1);
  constexpr Real h = 1e-3;
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    for (int side = 0; side < 2; ++side) {
      Vec6 j[F::kRows];
      F::jacobian(x.data, x.a, x.b, side, j);
      for (int i = 0; i < 6; ++i) {
        // central differences of fourth order
        const auto at = [&](Real s) { return constraintOf(moved(x, side, (s * h) * unitVec6(i))); };
        const Rows<F> p1 = at(1), m1 = at(-1), p2 = at(2), m2 = at(-2);
        for (int row = 0; row < F::kRows; ++row) {
          const Real slope = (8 * (p1.c[row] - m1.c[row]) - (p2.c[row] - m2.c[row])) / (12 * h);
          EXPECT_NEAR(component(j[row], i), slope, 1e-7) << "side " << side << ", row " << row << ", coordinate " << i;
        }
      }
    }
  }
}

/// Norms of the columns of sum F d2C/dx2 of one body, by finite differences along the retraction.
template <class F> Vec6 columnNorms(const JointCase<F>& x, int side, const Real (&force)[F::kRows]) {
  constexpr Real h = 1e-3;
  const auto energy = [&](const Vec6& dx) {
    const Rows<F> rows = constraintOf(moved(x, side, dx));
    Real sum = 0;
    for (int row = 0; row < F::kRows; ++row) sum += force[row] * rows.c[row];
    return sum;
  };
  const auto second = [&](int i, int j, Real step) {
    const auto at = [&](Real si, Real sj) {
      const Vec6 ei = (si * step) * unitVec6(i), ej = (sj * step) * unitVec6(j);
      return energy({ei.lin + ej.lin, ei.ang + ej.ang});
    };
    return (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * step * step);
  };
  Vec6 norms{{0, 0, 0}, {0, 0, 0}};
  for (int i = 0; i < 6; ++i) {
    Real sum = 0;
    for (int j = 0; j < 6; ++j) {
      const Real d = (4 * second(i, j, h) - second(i, j, 2 * h)) / 3;
      sum += d * d;
    }
    (i < 3 ? norms.lin : norms.ang)[i % 3] = std::sqrt(sum);
  }
  return norms;
}

TYPED_TEST(JointTest, CurvatureOfEachGroupIsTheColumnNormsOfItsSecondDerivative) {
  using F = TypeParam;
  Random random(2);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    for (const RowGroup& group : F::kGroups) {
      Real force[F::kRows] = {};
      for (int row = group.begin; row < group.begin + group.count; ++row) force[row] = random.uniform(-2, 2);
      for (int side = 0; side < 2; ++side) {
        const Vec6 g = F::curvature(x.data, x.a, x.b, side, force), norms = columnNorms(x, side, force);
        for (int i = 0; i < 6; ++i) EXPECT_NEAR(component(g, i), component(norms, i), 1e-5) << "side " << side << ", coordinate " << i;
      }
    }
  }
}

TYPED_TEST(JointTest, CurvatureOfAllGroupsIsAtLeastThatOfTheirSum) {
  using F = TypeParam;
  Random random(9);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    Real force[F::kRows];
    for (Real& f : force) f = random.uniform(-2, 2);
    for (int side = 0; side < 2; ++side) {
      const Vec6 g = F::curvature(x.data, x.a, x.b, side, force), norms = columnNorms(x, side, force);
      for (int i = 0; i < 6; ++i) EXPECT_GE(component(g, i), component(norms, i) - 1e-5) << "side " << side << ", coordinate " << i;
    }
  }
}

TYPED_TEST(JointTest, ForcesOnBothBodiesCancel) {
  using F = TypeParam;
  Random random(3);
  for (int n = 0; n < kCases; ++n) {
    JointCase<F> x = randomJointCase<F>(random);
    // a linear row acts at two anchors: closed joints have no net moment
    closeAnchors(x);
    Vec6 ja[F::kRows], jb[F::kRows];
    F::jacobian(x.data, x.a, x.b, 0, ja);
    F::jacobian(x.data, x.a, x.b, 1, jb);
    const Vec3 about = random.vector(3);
    for (int row = 0; row < F::kRows; ++row) {
      EXPECT_TRUE(test::near(ja[row].lin + jb[row].lin, Vec3{}, 1e-13));
      const Vec3 moment = ja[row].ang + cross(x.a.p - about, ja[row].lin) + jb[row].ang + cross(x.b.p - about, jb[row].lin);
      EXPECT_TRUE(test::near(moment, Vec3{}, 1e-12)) << row;
    }
  }
}

/// The generalised force of random multipliers on one side, in groups.
template <class F> Vec6 forceOn(const JointCase<F>& x, int side, const Real (&c)[F::kRows]) {
  Vec6 j[F::kRows];
  F::jacobian(x.data, x.a, x.b, side, j);
  Vec6 sum{{0, 0, 0}, {0, 0, 0}};
  for (int row = 0; row < F::kRows; ++row) sum.lin -= c[row] * j[row].lin, sum.ang -= c[row] * j[row].ang;
  return sum;
}

TYPED_TEST(JointTest, TurnsAndShiftsWithTheWorld) {
  using F = TypeParam;
  Random random(4);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    const Quat turn = random.rotation();
    const Vec3 shift = random.vector(10);
    const auto image = [&](const Pose& p) { return Pose{rotate(turn, p.p) + shift, turn * p.q}; };
    const JointCase<F> y{x.data, image(x.a), image(x.b)};
    const Rows<F> cx = constraintOf(x), cy = constraintOf(y);
    for (int g = 0; g < F::kGroupCount; ++g) {
      Real sx = 0, sy = 0;
      for (int row = F::kGroups[g].begin; row < F::kGroups[g].begin + F::kGroups[g].count; ++row)
        sx += cx.c[row] * cx.c[row], sy += cy.c[row] * cy.c[row];
      EXPECT_NEAR(std::sqrt(sx), std::sqrt(sy), 1e-12) << g;
    }
    // the force of the penalty k C, whatever axes the rows use
    for (int side = 0; side < 2; ++side) {
      const Vec6 fx = forceOn(x, side, cx.c), fy = forceOn(y, side, cy.c);
      EXPECT_TRUE(test::near(rotate(turn, fx.lin), fy.lin, 1e-12));
      EXPECT_TRUE(test::near(rotate(turn, fx.ang), fy.ang, 1e-12));
    }
  }
}

TYPED_TEST(JointTest, DoesNotSeeTheSignOfAQuaternion) {
  using F = TypeParam;
  Random random(5);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    JointCase<F> y = x;
    y.a.q = {-x.a.q.s, -x.a.q.v};
    const Rows<F> cx = constraintOf(x), cy = constraintOf(y);
    for (int row = 0; row < F::kRows; ++row) EXPECT_NEAR(cx.c[row], cy.c[row], 1e-14);
    for (int side = 0; side < 2; ++side) {
      const Vec6 fx = forceOn(x, side, cx.c), fy = forceOn(y, side, cx.c);
      EXPECT_TRUE(test::near(fx.ang, fy.ang, 1e-13));
    }
  }
}

TYPED_TEST(JointTest, HasNoErrorWhereItWasMade) {
  using F = TypeParam;
  Random random(6);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = closedJointCase<F>(random);
    const Rows<F> rows = constraintOf(x);
    for (int row = 0; row < F::kRows; ++row) EXPECT_NEAR(rows.c[row], 0, 1e-14) << row;
  }
}

TYPED_TEST(JointTest, LeverIsTheSquaredDistanceOfTheAnchor) {
  using F = TypeParam;
  Random random(7);
  const JointCase<F> x = randomJointCase<F>(random);
  EXPECT_EQ(F::lever2(x.data, 0), lengthSquared(x.data.anchorA));
  EXPECT_EQ(F::lever2(x.data, 1), lengthSquared(x.data.anchorB));
}

TEST(FixedJoint, MeasuresTheAngleFromTheWantedOrientation) {
  Random random(8);
  for (int n = 0; n < kCases; ++n) {
    JointCase<FixedJoint> x = closedJointCase<FixedJoint>(random);
    const Vec3 turn = .001 * random.direction();
    x.a.q = expRotation(turn) * x.a.q;
    const Rows<FixedJoint> rows = constraintOf(x);
    // in the frame of B
    EXPECT_TRUE(test::near(rotate(x.b.q, Vec3{rows.c[3], rows.c[4], rows.c[5]}), turn, 1e-9));
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
