/// Every part of every joint of the list: derivatives by finite differences, momentum, frame invariance.
#include <forces/forces.h>

#include <algorithm>

#include "tests/forces/joint_cases.h"
#include "tests/support/core.h"
#include "tests/support/typed.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

template <class F> struct JointTest : ::testing::Test {};

struct JointNames {
  template <class F> static std::string GetName(int) { return F::kName; }
};
TYPED_TEST_SUITE(JointTest, test::AsTypes<JointTypes>::Types, JointNames);

constexpr int kCases = 30;

TYPED_TEST(JointTest, JacobianIsTheDerivativeOfTheConstraint) {
  using F = TypeParam;
  Random random(1);
  constexpr Real h = 1e-3;
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    forEachPart<F>([&]<int I, class P>() {
      for (int side = 0; side < kSides<F>; ++side) {
        Vec6 j[P::kRows];
        P::jacobian(x.data, x.memory, x.a, x.b, side, j);
        for (int i = 0; i < 6; ++i) {
          // central differences of fourth order
          const auto at = [&](Real s) { return constraintOf<P>(moved(x, side, (s * h) * unitVec6(i))); };
          const Rows<P> p1 = at(1), m1 = at(-1), p2 = at(2), m2 = at(-2);
          for (int row = 0; row < P::kRows; ++row) {
            const Real slope = (8 * (p1.c[row] - m1.c[row]) - (p2.c[row] - m2.c[row])) / (12 * h);
            EXPECT_NEAR(component(j[row], i), slope, 1e-7)
                << "part " << I << ", side " << side << ", row " << row << ", coordinate " << i;
          }
        }
      }
    });
  }
}

/// Norms of the columns of sum F d2C/dx2 of one body, by finite differences along the retraction.
template <class P, class F> Vec6 columnNorms(const JointCase<F>& x, int side, const Real (&force)[P::kRows]) {
  constexpr Real h = 1e-3;
  const auto energy = [&](const Vec6& dx) {
    const Rows<P> rows = constraintOf<P>(moved(x, side, dx));
    Real sum = 0;
    for (int row = 0; row < P::kRows; ++row) sum += force[row] * rows.c[row];
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

TYPED_TEST(JointTest, CurvatureOfEachPartIsTheColumnNormsOfItsSecondDerivative) {
  using F = TypeParam;
  Random random(2);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    forEachPart<F>([&]<int I, class P>() {
      Real force[P::kRows];
      // lengths have their whole curvature under tension only
      for (Real& f : force) f = P::kAxis ? random.uniform(.5, 2) : random.uniform(-2, 2);
      for (int side = 0; side < kSides<F>; ++side) {
        const Vec6 g = P::curvature(x.data, x.memory, x.a, x.b, side, force),
                   norms = columnNorms<P>(x, side, force);
        for (int i = 0; i < 6; ++i)
          EXPECT_NEAR(component(g, i), component(norms, i), 2e-5 * (1 + component(norms, i)))
              << "part " << I << ", side " << side << ", coordinate " << i;
      }
    });
  }
}

TYPED_TEST(JointTest, ForcesOnAllBodiesCancelUnlessTheWorldTakesPart) {
  using F = TypeParam;
  if (F::kGrounded) return;
  Random random(3);
  for (int n = 0; n < kCases; ++n) {
    JointCase<F> x = randomJointCase<F>(random);
    const Vec3 about = random.vector(3);
    forEachPart<F>([&]<int I, class P>() {
      JointCase<F> y = x;
      // rows that hold anchors together act at two points: closed joints have no net moment
      if constexpr (std::is_same_v<P, AnchorRows>) closeAnchors(y);
      Vec3 force[P::kRows]{}, moment[P::kRows]{};
      for (int side = 0; side < kSides<F>; ++side) {
        Vec6 j[P::kRows];
        P::jacobian(y.data, y.memory, y.a, y.b, side, j);
        for (int row = 0; row < P::kRows; ++row)
          force[row] += j[row].lin, moment[row] += j[row].ang + cross(poseOf(y, side).p - about, j[row].lin);
      }
      for (int row = 0; row < P::kRows; ++row) {
        EXPECT_TRUE(test::near(force[row], Vec3{}, 1e-13)) << I;
        EXPECT_TRUE(test::near(moment[row], Vec3{}, 1e-12)) << I << " " << row;
      }
    });
  }
}

/// The generalised force of multipliers on one side.
template <class P, class F> Vec6 forceOn(const JointCase<F>& x, int side, const Real (&c)[P::kRows]) {
  Vec6 j[P::kRows];
  P::jacobian(x.data, x.memory, x.a, x.b, side, j);
  Vec6 sum{{0, 0, 0}, {0, 0, 0}};
  for (int row = 0; row < P::kRows; ++row) sum.lin -= c[row] * j[row].lin, sum.ang -= c[row] * j[row].ang;
  return sum;
}

TYPED_TEST(JointTest, TurnsAndShiftsWithTheWorld) {
  using F = TypeParam;
  Random random(4);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    const Quat turn = random.rotation();
    const JointCase<F> y = image(x, turn, random.vector(10));
    forEachPart<F>([&]<int I, class P>() {
      const Rows<P> cx = constraintOf<P>(x), cy = constraintOf<P>(y);
      Real sx = 0, sy = 0;
      for (int row = 0; row < P::kRows; ++row) sx += cx.c[row] * cx.c[row], sy += cy.c[row] * cy.c[row];
      EXPECT_NEAR(std::sqrt(sx), std::sqrt(sy), 1e-12) << I;
      // the force of the penalty k C, whatever axes the rows use
      for (int side = 0; side < kSides<F>; ++side) {
        const Vec6 fx = forceOn<P>(x, side, cx.c), fy = forceOn<P>(y, side, cy.c);
        EXPECT_TRUE(test::near(rotate(turn, fx.lin), fy.lin, 1e-11)) << I;
        EXPECT_TRUE(test::near(rotate(turn, fx.ang), fy.ang, 1e-11)) << I;
      }
    });
  }
}

TYPED_TEST(JointTest, DoesNotSeeTheSignOfAQuaternion) {
  using F = TypeParam;
  Random random(5);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    JointCase<F> y = x;
    y.a.q = {-x.a.q.s, -x.a.q.v};
    forEachPart<F>([&]<int I, class P>() {
      const Rows<P> cx = constraintOf<P>(x), cy = constraintOf<P>(y);
      for (int row = 0; row < P::kRows; ++row) EXPECT_NEAR(cx.c[row], cy.c[row], 1e-13) << I;
      for (int side = 0; side < kSides<F>; ++side)
        EXPECT_TRUE(test::near(forceOn<P>(x, side, cx.c).ang, forceOn<P>(y, side, cx.c).ang, 1e-12)) << I;
    });
  }
}

TYPED_TEST(JointTest, ReportsTheForceThatItsBodiesFeelInTheBlockOfEach) {
  using F = TypeParam;
  Random random(6);
  StepConstants c = testConstants();
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    const JointSpec<F> spec = specOf<F>(x.data);
    Joint<F> joint{};
    joint.memory = x.memory;
    joint.length = 1;
    JointBody bodies[kSides<F>];
    for (int side = 0; side < kSides<F>; ++side)
      bodies[side] = side == 0 ? JointBody{2, {.1, .2, .3}, {}, {}} : JointBody{20, {1, 2, 3}, {}, {}};
    beginJointAt(c, spec, joint, x.a, x.b, bodies);
    // after a dual update the multipliers are the forces; with k = 0 the blocks hold them alone
    updateJointDuals(c, spec, joint, x.a, x.b);
    for (int side = 0; side < kSides<F>; ++side) {
      Vec6 sum{{0, 0, 0}, {0, 0, 0}};
      forEachPart<F>([&]<int I, class P>() {
        auto& rows = partOf<I>(joint.parts);
        if constexpr (P::kAxis) {
          rows.limit.k = rows.drive.k = rows.friction.k = 0;
          const Vec6 own = forceOn<P>(x, side, {axisLoad(rows)});
          sum.lin += own.lin, sum.ang += own.ang;
        } else {
          rows.state.k = 0;
          const Vec6 own = forceOn<P>(x, side, rows.lambda);
          sum.lin += own.lin, sum.ang += own.ang;
        }
      });
      Block6 block;
      accumulateAt(spec, joint, x.a, x.b, side, block);
      EXPECT_TRUE(test::near(block.fl, sum.lin, 1e-9 * (1 + length(sum.lin))));
      EXPECT_TRUE(test::near(block.fa, sum.ang, 1e-9 * (1 + length(sum.ang))));
      EXPECT_GT(length(block.fl) + length(block.fa), 0);
    }
  }
}

/// An aggregate feels the forces on those of its bodies that the joint has, each at its place.
TYPED_TEST(JointTest, PushesAnAggregateAsItPushesTheBodiesInside) {
  using F = TypeParam;
  Random random(7);
  const StepConstants c = testConstants();
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    const JointSpec<F> spec = specOf<F>(x.data);
    Joint<F> joint{};
    joint.memory = x.memory, joint.length = 1;
    JointBody bodies[kSides<F>];
    for (JointBody& body : bodies) body = {2, {.1, .2, .3}, {}, {}};
    beginJointAt(c, spec, joint, x.a, x.b, bodies);
    Vec3 shift[kSides<F>];
    for (Vec3& s : shift) s = random.vector();
    for (unsigned inside = 1; inside < 1u << kSides<F>; ++inside) {
      Vec6 sum{{0, 0, 0}, {0, 0, 0}};
      for (int side = 0; side < kSides<F>; ++side) {
        if (!(inside >> side & 1u)) continue;
        Block6 own;
        accumulateAt(spec, joint, x.a, x.b, side, own);
        sum.lin += own.fl, sum.ang += own.fa + cross(shift[side], own.fl);
      }
      Block6 block;
      accumulateJointOfGroup(spec, joint, x.a, x.b, inside, shift, block);
      EXPECT_TRUE(test::near(block.fl, sum.lin, 1e-9 * (1 + length(sum.lin)))) << inside;
      EXPECT_TRUE(test::near(block.fa, sum.ang, 1e-9 * (1 + length(sum.ang)))) << inside;
    }
  }
}

/// A joint with loaded angular rows, and its force on B at the present poses with the linearization at
/// `from`.
template <class F> struct LoadedJoint {
  JointSpec<F> spec;
  Joint<F> joint{};
  LoadedJoint(const JointCase<F>& x, Random& random) : spec(specOf<F>(x.data)) {
    StepConstants c = testConstants();
    joint.length = 1, joint.memory = x.memory;
    const JointBody bodies[kSides<F>] = {{1, {.1, .1, .1}, {}, {}}, {1, {.1, .1, .1}, {}, {}}};
    beginJointAt(c, spec, joint, x.a, x.b, bodies);
    forEachPart<F>([&]<int I, class P>() {
      auto& rows = partOf<I>(joint.parts);
      if constexpr (P::kAxis) {
        rows.limit.active = isAngular<F, P>();
        rows.limit.lambda = random.uniform(-5, 5);
      } else {
        if (!isAngular<F, P>()) partOf<I>(spec.parts).mode = GroupMode::Off;
        for (Real& lambda : rows.lambda) lambda = random.uniform(-5, 5);
      }
    });
    joint.acting = actingRows(spec, joint);
  }
  Block6 block(const JointCase<F>& from, const JointCase<F>& now) const {
    Block6 sum;
    accumulateFrom(spec, joint, from, now.a, now.b, 1, sum);
    return sum;
  }
};
template <class F> class TurningJoint : public ::testing::Test {};
using TurningJoints = ::testing::Types<FixedJoint, HingeJoint, SliderJoint, UniversalJoint, SwingTwistJoint,
                                       SixDofJoint, GimbalJoint>;
TYPED_TEST_SUITE(TurningJoint, TurningJoints);

TYPED_TEST(TurningJoint, HasItsErrorsToFirstOrderInWhatTurnsDuringAnIteration) {
  using F = TypeParam;
  Random random(31);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    const LoadedJoint<F> joint(x, random);
    JointAngularRows<F> turns{};
    linearizeAngularRows(joint.spec, joint.joint, x.a, x.b, x.a.q, x.b.q, turns);
    forEachPart<F>([&]<int I, class P>() {
      if constexpr (isAngular<F, P>()) {
        constexpr Real h = 1e-4;
        const JointCase<F> y = moved(moved(x, 0, h * unitVec6(3 + n % 3)), 1, h * unitVec6(3 + (n + 1) % 3));
        Real then[P::kRows];
        partErrors<P>(joint.spec, joint.joint, partOf<I>(joint.joint.parts), y.a, y.b, then);
        const AngularRows& rows = turns.law[firstAngularLaw<F, I>()];
        for (int i = 0; i < P::kRows; ++i)
          EXPECT_NEAR(rows.row[i].error + dot(rows.row[i].turn, turnedSince(turns.from, y.a.q, y.b.q)),
                      then[i], 100 * h * h)
              << I << " " << i;
      }
    });
  }
}

TYPED_TEST(TurningJoint, FeelsNothingOfARotationAsAWholeDuringAnIteration) {
  using F = TypeParam;
  Random random(32);
  for (int n = 0; n < kCases; ++n) {
    const JointCase<F> x = randomJointCase<F>(random);
    const LoadedJoint<F> joint(x, random);
    const Quat turn = expRotation({.9, -.7, 1.1});
    const JointCase<F> y = image(x, turn, {0, 0, 0});
    const Vec3 expected = rotate(turn, joint.block(x, x).fa);
    EXPECT_GT(length(expected), 0) << n;
    EXPECT_TRUE(test::near(joint.block(x, y).fa, expected, 1e-9 * (1 + length(expected)))) << n;
  }
}

/// A body that has several sides of a joint feels the sum of them: the derivative of the constraint as it
/// moves.
TEST(GearJoint, ABodyOfSeveralSidesFeelsTheSumOfThem) {
  Random random(12);
  const int owners[][4] = {{0, 1, 2, 2}, {0, 1, 1, 3}, {0, 1, 2, 0}};
  for (const int(&body)[4] : owners)
    for (int n = 0; n < kCases; ++n) {
      JointCase<GearJoint> x = randomJointCase<GearJoint>(random);
      for (int side = 1; side < 4; ++side)
        for (int k = 0; k < side; ++k)
          if (body[k] == body[side]) poseOf(x, side) = poseOf(x, k);
      x.data.frameA = frameNear(random, x.a.frameBody.q * x.data.baseA, x.a.q);
      x.data.frameB = frameNear(random, x.b.frameBody.q * x.data.baseB, x.b.q);
      x.memory = {};
      x.memory.remember(x.data, x.a, x.b, {});
      JointSpec<GearJoint> spec = specOf<GearJoint>(x.data);
      spec.a = body[0], spec.b = body[1], spec.frameBodyA = body[2], spec.frameBodyB = body[3];
      Joint<GearJoint> joint{};
      joint.memory = x.memory;
      for (int side = 0; side < 4; ++side) {
        if (!isFirstSide(spec, side)) continue;
        Vec6 j[1];
        jacobianOf<GearAxis>(spec, joint, x.a, x.b, side, j);
        constexpr Real h = 1e-4;
        for (int i = 3; i < 6; ++i) {
          const auto at = [&](Real s) {
            JointCase<GearJoint> y = x;
            for (int k = 0; k < 4; ++k)
              if (body[k] == body[side]) y = moved(y, k, (s * h) * unitVec6(i));
            return constraintOf<GearAxis>(y).c[0];
          };
          EXPECT_NEAR(component(j[0], i), (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h), 1e-7);
        }
      }
    }
}

TEST(FixedJoint, MeasuresTheAngleFromTheWantedOrientation) {
  Random random(8);
  for (int n = 0; n < kCases; ++n) {
    JointCase<FixedJoint> x = randomJointCase<FixedJoint>(random);
    x.data.aToB = conjugate(x.b.q) * x.a.q;
    const Vec3 turn = .001 * random.direction();
    x.a.q = expRotation(turn) * x.a.q;
    const auto rows = constraintOf<OrientationRows>(x);
    // in the frame of B
    EXPECT_TRUE(test::near(rotate(x.b.q, Vec3{rows.c[0], rows.c[1], rows.c[2]}), turn, 1e-9));
  }
}

/// A hinge with A rotated by `angle` about x.
JointCase<HingeJoint> turned(Real angle) {
  JointCase<HingeJoint> x{};
  x.a.q = fromAxisAngle(Vec3{1, 0, 0}, angle);
  return x;
}

TEST(HingeJoint, CountsItsAngleOverWholeTurns) {
  JointCase<HingeJoint> x{};
  for (Real angle = 0; angle < 40; angle += .9) {
    x.a.q = turned(angle).a.q;
    x.memory.remember(x.data, x.a, x.b, {});
    EXPECT_NEAR(constraintOf<TwistAxis>(x).c[0] + TwistAxis::turns(x.data, x.memory), angle, 1e-12);
  }
  for (Real angle = 40; angle > -40; angle -= 1.3) {
    x.a.q = turned(angle).a.q;
    x.memory.remember(x.data, x.a, x.b, {});
    EXPECT_NEAR(constraintOf<TwistAxis>(x).c[0] + TwistAxis::turns(x.data, x.memory), angle, 1e-12);
  }
}

TEST(HingeJoint, AngleDoesNotJumpInAStepAcrossHalfATurn) {
  JointCase<HingeJoint> x = turned(3.1);
  x.memory.remember(x.data, x.a, x.b, {});
  x.a.q = turned(3.3).a.q;
  EXPECT_NEAR(constraintOf<TwistAxis>(x).c[0], 3.3, 1e-12);
}

TEST(SwingTwistJoint, ConeIsTheAngleBetweenTheAxes) {
  Random random(9);
  for (int n = 0; n < kCases; ++n) {
    JointCase<SwingTwistJoint> x = randomJointCase<SwingTwistJoint>(random);
    x.data.coneY = 1;
    const Vec3 a = rotate(x.a.q * x.data.frameA, Vec3{1, 0, 0}),
               b = rotate(x.b.q * x.data.frameB, Vec3{1, 0, 0});
    EXPECT_NEAR(constraintOf<DirectionAxis<SwingCone>>(x).c[0], std::atan2(length(cross(a, b)), dot(a, b)),
                1e-12);
  }
}

/// Swing about y and about z alone are exact up to half a turn, with any twist.
TEST(SixDofJoint, SwingIsTheAngleOfARotationAboutOneAxis) {
  for (const Real angle : {-2.9, -1.6, .3, 2.2, 3.0})
    for (const Real twist : {0., 1.3, -2.}) {
      JointCase<SixDofJoint> x{};
      x.a.q = fromAxisAngle(Vec3{0, 1, 0}, angle) * fromAxisAngle(Vec3{1, 0, 0}, twist);
      EXPECT_NEAR(constraintOf<DirectionAxis<SwingY>>(x).c[0], angle, 1e-12);
      EXPECT_NEAR(constraintOf<DirectionAxis<SwingZ>>(x).c[0], 0, 1e-12);
      EXPECT_NEAR(constraintOf<TwistAxis>(x).c[0], twist, 1e-12);
      x.a.q = fromAxisAngle(Vec3{0, 0, 1}, angle) * fromAxisAngle(Vec3{1, 0, 0}, twist);
      EXPECT_NEAR(constraintOf<DirectionAxis<SwingZ>>(x).c[0], angle, 1e-12);
    }
}

TEST(DistanceJoint, HasNoTransversalCurvatureUnderCompression) {
  Random random(10);
  JointCase<DistanceJoint> x = randomJointCase<DistanceJoint>(random);
  const Real push[1] = {-2};
  const Vec6 g = DistanceAxis::curvature(x.data, x.memory, x.a, x.b, 0, push);
  EXPECT_EQ(length(g.lin), 0);
  EXPECT_GT(length(g.ang), 0);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
