/// Contact rows of vertices: forces and warm start.
#include <forces/point_contact.h>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

PointContact touching(Random& random) {
  PointContact p{};
  p.v[0] = 0, p.body = -1, p.weight[0] = 1;
  p.n = random.direction();
  p.active = 1, p.length = .1;
  p.mu = p.muStatic = p.muDynamic = .5;
  return p;
}

/// Equally stiff along all axes and far within its cone, it is a spring in space.
TEST(PointContact, ThatSticksIsASpringAlongAllAxes) {
  Random random(1);
  for (int k = 0; k < 20; ++k) {
    PointContact p = touching(random);
    p.mu = p.muStatic = p.muDynamic = 1e6;
    p.kN = p.kT = 300, p.lambdaN = 100;
    const Vec3 d = random.vector(.1);
    Block3 block;
    p.accumulateVertex(testConstants(), false, d, 0, block);
    EXPECT_TRUE(test::near(block.f, -(p.kN * d + p.lambdaN * p.n), 1e-9));
  }
}

/// The direction of the pull decides neither its size nor the stiffness that holds it.
TEST(PointContact, StartsWithinItsConeWhicheverWayItWasPulled) {
  Random random(2);
  StepConstants c = testConstants();
  c.contactPolicy = StiffnessPolicy::FollowLoad;
  constexpr Real kLoad = 1e6;  // stiffens the rows [N]
  for (const Real pull : {1 * kLoad, 4 * kLoad, 20 * kLoad}) {
    Real stiffness = 0;
    for (int k = 0; k < 12; ++k) {
      PointContact p = touching(random), old = p;
      const Real angle = .5 * k;
      old.keptN = 10 * kLoad, old.kept1 = pull * std::cos(angle), old.kept2 = pull * std::sin(angle);
      old.kN = old.kT = 100, old.stick = 1;
      beginPointContact(c, p, {1, 0, 0, 0}, &old);
      const Real size = std::hypot(p.lambda1, p.lambda2), decay = p.lambdaN / old.keptN;
      EXPECT_NEAR(size, std::min(decay * pull, p.muStatic * p.lambdaN), 1e-9 * kLoad);
      EXPECT_NEAR(p.lambda1 * old.kept2, p.lambda2 * old.kept1, 1e-9 * kLoad * kLoad) << "direction";
      if (k == 0) stiffness = p.kT;
      EXPECT_NEAR(p.kT, stiffness, 1e-9 * stiffness) << angle;
      EXPECT_GT(p.kT, 2 * p.start) << "the load stiffens it";
    }
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
