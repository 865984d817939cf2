/// Inertial targets [S 2], mass matrices [S 8] and the spin of a free body.
#include <solver/block.h>

#include <algorithm>
#include <cmath>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// A free body stepped by torqueFreeSpin and the exact exponential.
struct FreeBody {
  Vec3 inertia;
  Quat q;
  Vec3 w;  ///< world axes

  void step(Real dt, const Vec3& torque = {0, 0, 0}) {
    w = rotate(q, torqueFreeSpin(rotateInverse(q, w), rotateInverse(q, torque), inertia, dt));
    q = normalize(expRotation(dt * w) * q);
  }
  Vec3 momentum() const { return rotate(q, mul(inertia, rotateInverse(q, w))); }
  Real energy() const { return dot(w, momentum()) / 2; }
};

constexpr Real kDt = 1. / 60;
const Vec3 kInertia{1, 2, 3};

struct SpinRun {
  Real lowEnergy, highEnergy;  ///< over that at the start
  Real lowMomentum, highMomentum;
  Real worstDirection = 0;  ///< [rad]
  int flips = 0;            ///< turns of the middle axis against its first direction
};

SpinRun spin(const Vec3& w0, int steps) {
  FreeBody body{kInertia, Quat{}, w0};
  const Vec3 l0 = body.momentum();
  const Real e0 = body.energy();
  SpinRun run{1, 1, 1, 1};
  Real side = 1;
  for (int i = 0; i < steps; ++i) {
    body.step(kDt);
    const Vec3 l = body.momentum();
    run.lowEnergy = std::min(run.lowEnergy, body.energy() / e0),
    run.highEnergy = std::max(run.highEnergy, body.energy() / e0);
    run.lowMomentum = std::min(run.lowMomentum, length(l) / length(l0)),
    run.highMomentum = std::max(run.highMomentum, length(l) / length(l0));
    run.worstDirection = std::max(run.worstDirection, std::atan2(length(cross(l, l0)), dot(l, l0)));
    const Real along = rotateInverse(body.q, body.w).y;
    if (along * side < -.5 * std::fabs(w0.y)) ++run.flips, side = -side;
  }
  return run;
}

TEST(MassMatrix, IsRotatedIntoTheWorld) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Quat q = random.rotation();
    const MassMatrix m = massMatrix(5, kInertia, q);
    EXPECT_EQ(m.mass, 5);
    const Vec3 a = random.vector();
    EXPECT_TRUE(test::near(m.inertia * a, rotate(q, mul(kInertia, rotateInverse(q, a))), 1e-14));
  }
}

TEST(InertialTarget, FollowsVelocityAndAcceleration) {
  EXPECT_TRUE(test::near(inertialDisplacement(Vec3{1, 2, 3}, Vec3{0, 0, -10}, .1), Vec3{.1, .2, .2}, 1e-15));
}

TEST(InertialEnergy, HasTheInertialForceAsItsGradient) {
  Random random(2);
  const Pose y = randomPose(random);
  const MassMatrix m = massMatrix(2, kInertia, random.rotation());
  // the force leaves the derivative of [S 7] out, which is 1 up to the angle between x and y
  for (const Real angle : {1e-3, 1e-2}) {
    const Pose x{y.p + random.vector(angle), expRotation(angle * random.direction()) * y.q};
    Block6 block;
    setInertialForce(block, m, x, y, 1 / (kDt * kDt));
    const Vec6 force{block.fl, block.fa};
    constexpr Real h = 1e-6;
    for (int i = 0; i < 6; ++i) {
      const Real slope = (inertialEnergy(m, retract(x, h * unitVec6(i)), y, kDt) -
                          inertialEnergy(m, retract(x, -h * unitVec6(i)), y, kDt)) /
                         (2 * h);
      const Real scale = angle / (kDt * kDt) * 3;
      EXPECT_NEAR(component(force, i), -slope, scale * (1e-7 + (i < 3 ? 0 : angle))) << i;
    }
  }
}

TEST(TorqueFreeSpin, ConservesMomentumAndEnergyOfATumblingBody) {
  const SpinRun run = spin({2, 3, 4}, 600);
  EXPECT_GT(run.lowEnergy, .9995);
  EXPECT_LT(run.highEnergy, 1.0005);
  EXPECT_GT(run.lowMomentum, .9995);
  EXPECT_LT(run.highMomentum, 1.0005);
}

TEST(TorqueFreeSpin, TurnsTheIntermediateAxisOver) {
  // A tilt of 0.01 grows by the rate w sqrt((I3 - I2)(I2 - I1) / (I1 I3)) = 2.9 /s: it turns over near 2 s
  // and near 6 s.
  const SpinRun run = spin({.05, 5, .05}, 540);
  EXPECT_EQ(run.flips, 2);
  EXPECT_GT(run.lowEnergy, .9990);
  EXPECT_LT(run.highEnergy, 1.0010);
  // I w at the end of a step is half a step off the momentum that the rule keeps
  EXPECT_LT(run.worstDirection, .03);
}

TEST(TorqueFreeSpin, ConservesTheDiscreteMomentumToRoundOff) {
  // The momentum that the rule carries from step to step, in the world: R Pi-(w) before a step equals R
  // Pi+(w1).
  const auto discrete = [](const FreeBody& b, Real sign) {
    const Vec3 w = rotateInverse(b.q, b.w), x = kDt * w, iw = mul(kInertia, w);
    const Real a = length(x), c = (1 - (a / 2) / std::tan(a / 2)) / (a * a);
    return rotate(b.q, iw + (sign / 2) * cross(x, iw) + c * cross(x, cross(x, iw)));
  };
  for (const Vec3 w0 : {Vec3{2, 3, 4}, Vec3{.05, 5, .05}, Vec3{.1, 20, .1}}) {
    FreeBody body{kInertia, Quat{}, w0};
    const Vec3 first = discrete(body, -1);
    for (int i = 0; i < 600; ++i) {
      body.step(kDt);
      ASSERT_TRUE(test::near(discrete(body, -1), first, 1e-5 * length(first))) << i;
    }
  }
}

TEST(MomentumCurve, IsThatOfTheCotangentAndHasItsSlope) {
  const auto curve = [](Real a2) {
    const Real a = std::sqrt(a2);
    return (1 - a / 2 / std::tan(a / 2)) / a2;
  };
  for (const Real a2 : {.01, .3, 1., 2., 4.}) {
    const Real step = a2 / 1000, slope = (curve(a2 + step) - curve(a2 - step)) / (2 * step);
    EXPECT_NEAR(momentumCurve(a2).value, curve(a2), 1e-6) << a2;
    EXPECT_NEAR(momentumCurve(a2).slope, slope, 3e-6) << a2;
  }
}

TEST(TorqueFreeSpin, KeepsASpinAboutAPrincipalAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 w;
    w[axis] = 7;
    EXPECT_TRUE(test::near(torqueFreeSpin(w, {0, 0, 0}, kInertia, kDt), w, 1e-14));
  }
}

TEST(TorqueFreeSpin, GivesTheTorqueDividedByTheInertiaFromRest) {
  // to first order in dt; the gyroscopic part is of second order here
  const Vec3 torque{.1, .2, .3};
  const Vec3 w = torqueFreeSpin({0, 0, 0}, torque, kInertia, kDt);
  EXPECT_TRUE(test::near(w, kDt * Vec3{.1, .1, .1}, 1e-6));
  EXPECT_TRUE(test::near(torqueFreeSpin({3, 0, 0}, {6, 0, 0}, {2, 2, 2}, .5), Vec3{4.5, 0, 0}, 1e-15));
}

TEST(TorqueFreeSpin, PlanarSpinWithTorqueIsExact) {
  Vec3 w{0, 0, 2};
  for (int i = 0; i < 60; ++i) w = torqueFreeSpin(w, {0, 0, 6}, kInertia, kDt);
  EXPECT_TRUE(test::near(w, Vec3{0, 0, 4}, 1e-12));
}

TEST(TorqueFreeSpin, KeepsTheMomentumAboveOneRadianAStep) {
  const Vec3 w{10, 70, 10}, after = torqueFreeSpin(w, {0, 0, 0}, kInertia, kDt);
  EXPECT_TRUE(
      test::near(SpinMomentum({kInertia, kDt, 1})(after), SpinMomentum({kInertia, kDt, -1})(w), 1e-9 * 140));
}

TEST(SpinMomentum, OfAFreeBodyIsTheSameAtBothEndsOfItsStep) {
  // R(t + dt) Pi-(w) = R(t) Pi+(w), with R(t) = 1; the series is cut at 1e-6 for a turn of 2 rad
  Random random(6);
  for (const Real turn : {.1, 1., 2.}) {
    const Vec3 w = (turn / kDt) * random.direction();
    const Vec3 begin = SpinMomentum({kInertia, kDt, 1})(w), end = SpinMomentum({kInertia, kDt, -1})(w);
    EXPECT_TRUE(test::near(rotate(expRotation(kDt * w), end), begin, 3e-6 * length(begin))) << turn;
  }
}

TEST(SpinAt, KeepsTheMomentumOfABodyThatWasStoppedOnItsWay) {
  Random random(7);
  const Quat start = random.rotation();
  const Vec3 w{4, 9, -6};
  const Quat there = expRotation(kDt * w) * start, here = expRotation(.4 * kDt * w) * start;
  const auto momentum = [&](const Quat& q, const Vec3& spin) {
    return rotate(q, SpinMomentum({kInertia, kDt, -1})(rotateInverse(q, spin)));
  };
  EXPECT_TRUE(test::near(momentum(here, spinAt(here, there, w, kInertia, kDt)), momentum(there, w), 1e-9));
}

/// A step of a body with the inertial rotation y and a slightly larger actual rotation.
struct TurnedByRows {
  Quat start, x, y;
  Vec3 inertia, turn;
  TurnedByRows(Random& random, const Vec3& inertia, Real free, Real added)
      : start(random.rotation()), inertia(inertia) {
    y = expRotation(free * random.direction());
    x = expRotation(added * random.direction()) * y;
    turn = logRotation(x);
  }
  Vec3 spin() const { return spinAfterRows(start, x, turn, y, inertia, kDt); }
  /// Of the free spin, and what rows have given.
  Vec3 momentum() const {
    const Vec3 given = (2 / kDt) * shortArc(x * conjugate(y)).v;
    return freeMomentum(start, logRotation(y) / kDt, inertia, kDt) +
           massMatrix(1, inertia, start).inertia * given;
  }
};

TEST(SpinAfterRows, HasTheMomentumThatRowsGave) {
  Random random(8);
  for (int i = 0; i < 50; ++i) {
    const TurnedByRows body(random, {1, random.uniform(1.1, 1.9), 2}, random.uniform(0, .6), .05);
    const Vec3 wanted = body.momentum(),
               has = angularMomentum(body.x * body.start, body.spin(), body.inertia, kDt);
    EXPECT_TRUE(test::near(has, wanted, 1e-5 * length(wanted)));
  }
}

TEST(SpinAfterRows, KeepsTheSpinAboutAnAxisOfSymmetryThatIsTurned) {
  const Vec3 inertia{1, 1, 2}, w{0, 0, 30};
  const Quat y = expRotation(kDt * w), x = expRotation(Vec3{.05, 0, 0}) * y;
  const Vec3 spin = spinAfterRows(Quat{}, x, logRotation(x), y, inertia, kDt);
  EXPECT_NEAR(rotateInverse(x, spin).z, rotateInverse(x, logRotation(x)).z / kDt, 1e-9);
}

TEST(SpinAfterRows, IsThatOfTheTurnWithoutRows) {
  Random random(9);
  for (const Real turn : {0., 1e-3, .5, 1.5}) {
    const TurnedByRows body(random, kInertia, turn, 0);
    EXPECT_TRUE(test::near(body.spin(), body.turn / kDt, 1e-12));
  }
}

TEST(SpinAfterRows, IsNotCarriedAwayAboutTheLongAxisOfARod) {
  Random random(10);
  for (int i = 0; i < 50; ++i) {
    const TurnedByRows body(random, {1, 1, 1e-3}, .8, .5);
    EXPECT_LT(length(body.spin() - body.turn / kDt), 2 * std::sqrt(3.) * length(body.turn) * .5 / kDt);
  }
}

TEST(FollowedShare, IsOneInFreeFallAndZeroAtRest) {
  const Vec3 g{0, 0, -10};
  EXPECT_NEAR(followedShare({1, 0, -2 - 10 * kDt}, {1, 0, -2}, g, kDt), 1, 1e-12);
  EXPECT_EQ(followedShare({0, 0, 0}, {0, 0, 0}, g, kDt), 0);
  EXPECT_NEAR(followedShare({0, 0, -5 * kDt}, {0, 0, 0}, g, kDt), .5, 1e-12);
  EXPECT_EQ(followedShare({0, 0, 5}, {0, 0, 0}, g, kDt), 0);
  EXPECT_EQ(followedShare({0, 0, -5}, {0, 0, 0}, g, kDt), 1);
  EXPECT_EQ(followedShare({0, 0, -5}, {0, 0, 0}, {0, 0, 0}, kDt), 0);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
