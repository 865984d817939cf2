/// Gimbals against the product of their rotations.
#include <forces/gimbal.h>

#include <vector>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// Three axes in the frame of B where all angles are 0, points of them, and angles.
struct HingeRow {
  Real tiltB, tiltA;
  Vec3 offsetB, offsetA;
  Real angle[3];  ///< of the third, the second and the first hinge

  explicit HingeRow(Random& random)
      : tiltB(random.uniform(-1, 1)),
        tiltA(random.uniform(-1, 1)),
        offsetB(random.vector()),
        offsetA(random.vector()) {
    for (Real& each : angle) each = random.uniform(-3, 3);
    angle[1] = random.uniform(-1.5, 1.5);  // within 90 degrees
  }
  GimbalJoint::Data data() const {
    return {{{0, 0, 0}, {0, 0, 0}, Quat{}, Quat{}}, offsetB, offsetA, GimbalTilts<Real>::of(tiltB, tiltA), 0};
  }
  /// Of A in the frame of B, moved from the inner hinge to the outer one, as MuJoCo does.
  Pose pose() const {
    const Vec3 second = rotate(fromAxisAngle(Vec3{1, 0, 0}, tiltB), Vec3{0, 1, 0}),
               tilted = rotate(fromAxisAngle(Vec3{0, 0, 1}, tiltA), Vec3{1, 0, 0}),
               third = rotate(fromAxisAngle(Vec3{1, 0, 0}, tiltB), tilted);
    const Vec3 points[3] = {offsetB + offsetA, offsetB, {0, 0, 0}}, axes[3] = {third, second, {0, 0, 1}};
    const Quat rest = fromAxisAngle(Vec3{1, 0, 0}, tiltB) * fromAxisAngle(Vec3{0, 0, 1}, tiltA);
    Pose a{points[0], rest};
    for (int k = 0; k < 3; ++k) {
      const Quat turn = fromAxisAngle(axes[k], angle[k]);
      a = {points[k] + rotate(turn, a.p - points[k]), turn * a.q};
    }
    return a;
  }
};

/// C of part P.
template <class P>
Real valueOf(const GimbalJoint::Data& data, const GimbalJoint::Memory& memory, const Pose& a) {
  Real c[1];
  P::constraint(data, memory, a, Pose{{0, 0, 0}, Quat{}}, c);
  return c[0];
}

TEST(GimbalJoint, HasTheAnglesOfItsHingesAndNoTravelHoweverTheyLie) {
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    const HingeRow row(random);
    const GimbalJoint::Data data = row.data();
    const Pose a = row.pose(), b{{0, 0, 0}, Quat{}};
    GimbalJoint::Memory memory{};
    memory.remember(data, a, b, {});
    EXPECT_NEAR(valueOf<GimbalAngle<0>>(data, memory, a), row.angle[0], 1e-9);
    EXPECT_NEAR(valueOf<GimbalAngle<1>>(data, memory, a), row.angle[1], 1e-9);
    EXPECT_NEAR(valueOf<GimbalAngle<2>>(data, memory, a), row.angle[2], 1e-9);
    EXPECT_NEAR(valueOf<GimbalTravel<0>>(data, memory, a), 0, 1e-9);
    EXPECT_NEAR(valueOf<GimbalTravel<1>>(data, memory, a), 0, 1e-9);
    EXPECT_NEAR(valueOf<GimbalTravel<2>>(data, memory, a), 0, 1e-9);
    // one hinge turns as its Jacobian says
    for (int k = 0; k < 3; ++k) {
      const CardanAngles angles = cardanOf(data, a, b);
      const CardanDerivatives by = angles.derivatives(Quat{});
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(dot(by.g[i], angles.axis(k)), i == k, 1e-9);
    }
  }
}

TEST(GimbalJoint, MovesAlongTheAxesOfBBesideItsHinges) {
  Random random(2);
  for (int n = 0; n < 50; ++n) {
    const HingeRow row(random);
    const Vec3 travel = random.vector();
    Pose a = row.pose();
    a.p += travel;
    const GimbalJoint::Memory memory{};
    EXPECT_NEAR(valueOf<GimbalTravel<0>>(row.data(), memory, a), travel.x, 1e-9);
    EXPECT_NEAR(valueOf<GimbalTravel<1>>(row.data(), memory, a), travel.y, 1e-9);
    EXPECT_NEAR(valueOf<GimbalTravel<2>>(row.data(), memory, a), travel.z, 1e-9);
  }
}

TEST(GimbalJoint, CountsItsOuterAnglesOverWholeTurns) {
  Random random(3);
  HingeRow row(random);
  const GimbalJoint::Data data = row.data();
  GimbalJoint::Memory memory{};
  for (Real turn = 0; turn < 20; turn += 0.8) {
    row.angle[0] = turn, row.angle[2] = -turn;
    memory.remember(data, row.pose(), Pose{{0, 0, 0}, Quat{}}, {});
    EXPECT_NEAR(valueOf<GimbalAngle<0>>(data, memory, row.pose()) + GimbalAngle<0>::turns(data, memory), turn,
                1e-9);
    EXPECT_NEAR(valueOf<GimbalAngle<2>>(data, memory, row.pose()) + GimbalAngle<2>::turns(data, memory),
                -turn, 1e-9);
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
