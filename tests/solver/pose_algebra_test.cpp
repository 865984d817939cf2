/// [S 7] and [S 9] against their definitions.
#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

TEST(PoseDifference, IsTheDefinitionOnTheShortArc) {
  Random random(1);
  int flipped = 0;
  for (int i = 0; i < 100; ++i) {
    const Pose a = randomPose(random), b = randomPose(random);
    Quat d = a.q * conjugate(b.q);
    flipped += d.s < 0;
    const Real sign = d.s < 0 ? -1 : 1;
    const Vec6 difference = RUBBLE_CORE::difference(a, b);
    EXPECT_TRUE(test::near(difference.lin, a.p - b.p, 1e-15));
    EXPECT_TRUE(test::near(difference.ang, 2 * sign * d.v, 1e-15));
  }
  EXPECT_GT(flipped, 20);
  EXPECT_LT(flipped, 80);
}

TEST(PoseDifference, DoesNotSeeTheSignOfAQuaternion) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Pose a = randomPose(random), b = randomPose(random), minus{a.p, {-a.q.s, -a.q.v}};
    EXPECT_TRUE(test::near(difference(a, b).ang, difference(minus, b).ang, 1e-15));
  }
}

TEST(PoseDifference, IsAntisymmetric) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Pose a = randomPose(random), b = randomPose(random);
    const Vec6 ab = difference(a, b), ba = difference(b, a);
    EXPECT_TRUE(test::near(ab.lin, -ba.lin, 1e-15));
    EXPECT_TRUE(test::near(ab.ang, -ba.ang, 1e-15));
  }
}

TEST(PoseDifference, IsTheRotationVectorForSmallTurnsAndWorldFramed) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Pose x = randomPose(random);
    const Vec3 turn = 1e-4 * random.direction();
    const Pose turned{x.p, expRotation(turn) * x.q};
    EXPECT_TRUE(test::near(difference(turned, x).ang, turn, 1e-12));
  }
}

TEST(Retract, IsTheDefinition) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Pose x = randomPose(random);
    const Vec6 dx = randomVec6(random);
    const Quat q = normalize(
        Quat{x.q.s - dot(dx.ang, x.q.v) / 2, x.q.v + (x.q.s * dx.ang + cross(dx.ang, x.q.v)) / 2.});
    const Pose moved = retract(x, dx);
    EXPECT_TRUE(test::near(moved.p, x.p + dx.lin, 1e-15));
    EXPECT_NEAR(moved.q.s, q.s, 1e-15);
    EXPECT_TRUE(test::near(moved.q.v, q.v, 1e-15));
    EXPECT_NEAR(moved.q.s * moved.q.s + dot(moved.q.v, moved.q.v), 1, 1e-15);
  }
}

TEST(Retract, ThenDifferenceGivesTheUpdateShortenedByTheNormalisation) {
  // (1, dw / 2) is normalised, so 2 u = dw / sqrt(1 + |dw|^2 / 4) exactly
  Random random(6);
  for (int i = 0; i < 50; ++i) {
    const Pose x = randomPose(random);
    const Vec6 dx = randomVec6(random);
    const Vec6 back = difference(retract(x, dx), x);
    EXPECT_TRUE(test::near(back.lin, dx.lin, 1e-14));
    EXPECT_TRUE(test::near(back.ang, dx.ang / std::sqrt(1 + dot(dx.ang, dx.ang) / 4), 1e-14));
  }
}

TEST(Retract, AgreesWithTheExponentialToSecondOrder) {
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    const Pose x = randomPose(random);
    const Vec3 turn = .01 * random.direction();
    const Quat exact = expRotation(turn) * x.q;
    // tan(a/2) against a/2: a^3 / 12
    EXPECT_TRUE(test::sameRotation(retract(x, {{0, 0, 0}, turn}).q, exact, 1e-6 / 11.9));
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
