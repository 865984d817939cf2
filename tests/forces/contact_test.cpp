/// Contact points: forces from the energy, Hessian blocks, momentum, and lanes against single points.
#include <forces/contact_pair.h>
#include <solver/row.h>

#include <cstring>

#include <Eigen/Dense>

#include "tests/support/core.h"
#include "tests/support/eigen.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::eigen;
using test::Random;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Displacement displacement(const Vec6& d) { return {d.lin, 0, d.ang, 0}; }

struct ContactCase {
  ContactRows rows;
  Vec6 a, b;
};

/// Lane4 points with everything of them at random; `friction` large makes them stick.
ContactCase randomContact(Random& random, Real friction) {
  ContactCase x{};
  ContactRows& r = x.rows;
  r.n = random.direction();
  r.offset = random.vector(2);
  r.muDynamic = friction;
  r.most = 1e30;
  r.start = 10;
  r.length = .5;
  r.perLoad = contactRule(testConstants(), r.start, r.length).perLoad;
  r.a = 0, r.b = 1;
  for (int k = 0; k < kLanes; ++k) {
    PointLoad& load = r.load[k];
    PointSlip& slip = r.slip[k];
    r.place[k].rA = random.vector();
    r.place[k].c0 = random.uniform(-.1, .1);
    slip.drift1 = random.uniform(-.1, .1), slip.drift2 = random.uniform(-.1, .1);
    slip.mu = friction;
    load.lambdaN = random.uniform(0, 5);
    load.lambda1 = random.uniform(-1, 1), load.lambda2 = random.uniform(-1, 1);
    load.kN = random.logUniform(10, 1000), slip.kT = random.logUniform(10, 1000);
  }
  x.a = randomVec6(random, .02), x.b = randomVec6(random, .02);
  return x;
}

ContactForces<Real> forcesOf(const ContactCase& x, int lane) {
  return contactForces(true, contactFrame<Real>(x.rows, lane), displacement(x.a), displacement(x.b));
}

Block6 blockOf(const ContactCase& x, bool onA, int lane) {
  Block6 block;
  accumulateContact<Real>(true, x.rows, onA, displacement(x.a), displacement(x.b), lane, block);
  return block;
}

Vec3 leverOf(const ContactRows& r, int lane, bool onA) {
  return onA ? r.place[lane].rA : r.place[lane].rA + r.offset;
}

TEST(Contact, MeasuresDisplacementsOfThePointOnBothBodies) {
  Random random(1);
  for (int n = 0; n < 20; ++n) {
    const ContactCase x = randomContact(random, 1);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Vec3 d = x.a.lin + cross(x.a.ang, leverOf(x.rows, lane, true)) - x.b.lin -
                     cross(x.b.ang, leverOf(x.rows, lane, false));
      Vec3 t1, t2;
      tangentBasis(x.rows.n, t1, t2);
      const ContactForces<Real> f = forcesOf(x, lane);
      EXPECT_NEAR(f.cN, x.rows.place[lane].c0 + dot(x.rows.n, d), 1e-14);
      EXPECT_NEAR(f.c1, x.rows.slip[lane].drift1 + dot(t1, d), 1e-14);
      EXPECT_NEAR(f.c2, x.rows.slip[lane].drift2 + dot(t2, d), 1e-14);
    }
  }
}

TEST(Contact, InsideTheConePushesByTheGradientOfItsEnergy) {
  Random random(2);
  int pushing = 0;
  for (int n = 0; n < 40; ++n) {
    const ContactCase x = randomContact(random, 1e6);
    const int lane = n % kLanes;
    const ContactForces<Real> f = forcesOf(x, lane);
    if (f.fN <= .5) continue;
    ++pushing;
    const auto energy = [&](const ContactCase& y) {
      const ContactForces<Real> g = forcesOf(y, lane);
      const ContactRows& r = y.rows;
      return augmentedEnergy(r.load[lane].kN, r.load[lane].lambdaN, g.cN) +
             augmentedEnergy(r.slip[lane].kT, r.load[lane].lambda1, g.c1) +
             augmentedEnergy(r.slip[lane].kT, r.load[lane].lambda2, g.c2);
    };
    for (const bool onA : {true, false}) {
      const Block6 block = blockOf(x, onA, lane);
      const Vec6 force{block.fl, block.fa};
      constexpr Real h = 1e-4;
      for (int i = 0; i < 6; ++i) {
        const auto at = [&](Real s) {
          ContactCase y = x;
          Vec6& d = onA ? y.a : y.b;
          d.lin += s * h * unitVec6(i).lin, d.ang += s * h * unitVec6(i).ang;
          return energy(y);
        };
        EXPECT_NEAR(component(force, i), -(at(1) - at(-1)) / (2 * h), 1e-6) << onA << " " << i;
      }
    }
  }
  EXPECT_GT(pushing, 10);
}

TEST(Contact, HessianIsTheJacobianAroundTheMatrixOfThePoint) {
  Random random(3);
  for (int n = 0; n < 60; ++n) {
    const ContactCase x = randomContact(random, n % 2 ? .3 : 1e6);
    const int lane = n % kLanes;
    const ContactForces<Real> f = forcesOf(x, lane);
    Vec3 t1, t2;
    tangentBasis(x.rows.n, t1, t2);
    Eigen::Matrix3d axes, w;
    axes << eigen(x.rows.n), eigen(t1), eigen(t2);
    w << x.rows.load[lane].kN, 0, 0, 0, f.t.w11(), f.t.w12(), 0, f.t.w12(), f.t.w22();
    for (const bool onA : {true, false}) {
      Eigen::Matrix<double, 3, 6> j;
      j << Eigen::Matrix3d::Identity(), -eigen(crossMatrix(leverOf(x.rows, lane, onA)));
      const Matrix6 expected = j.transpose() * axes * w * axes.transpose() * j;
      const Sym6 h = pack(blockOf(x, onA, lane));
      for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 6; ++k)
          EXPECT_NEAR(h(i, k), expected(i, k), 1e-11 * expected.norm()) << i << " " << k;
    }
  }
}

TEST(Contact, ForcesOnBothBodiesHaveNoNetForceAndNoNetMoment) {
  Random random(4);
  for (int n = 0; n < 40; ++n) {
    const ContactCase x = randomContact(random, .4);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Block6 a = blockOf(x, true, lane), b = blockOf(x, false, lane);
      EXPECT_TRUE(test::near(a.fl + b.fl, Vec3{}, 1e-12));
      // about the center of B: A's lies at `offset`
      EXPECT_TRUE(test::near(a.fa + cross(x.rows.offset, a.fl) + b.fa, Vec3{}, 1e-11));
    }
  }
}

TEST(Contact, PushesButNeverPulls) {
  ContactCase x{};
  x.rows.most = 1e30;
  x.rows.n = {0, 0, 1};
  x.rows.load[0].kN = 100;
  x.rows.slip[0].mu = .5;
  x.rows.place[0].c0 = .2;
  EXPECT_NEAR(forcesOf(x, 0).fN, 20, 1e-12);
  EXPECT_NEAR(blockOf(x, true, 0).fl.z, -20, 1e-12);
  EXPECT_NEAR(blockOf(x, false, 0).fl.z, 20, 1e-12);
  x.rows.place[0].c0 = -.2;
  EXPECT_EQ(forcesOf(x, 0).fN, 0);
}

TEST(Contact, LimitsTheNormalForceToItsCeiling) {
  ContactCase x{};
  x.rows.most = 7;
  x.rows.n = {0, 0, 1};
  x.rows.load[0].kN = 100;
  x.rows.place[0].c0 = .2;
  EXPECT_EQ(forcesOf(x, 0).fN, 7);
}

TEST(Contact, DualUpdateTakesOverTheForcesAndKeepsThemInTheCone) {
  Random random(5);
  const StepConstants c = testConstants();
  int sliding = 0;
  for (int n = 0; n < 40; ++n) {
    ContactCase x = randomContact(random, .4);
    x.rows.muDynamic = .25;
    const ContactCase before = x;
    for (int lane = 0; lane < kLanes; ++lane) {
      const ContactForces<Real> f = forcesOf(before, lane);
      updateContactDuals<Real>(c, x.rows, displacement(x.a), displacement(x.b), lane);
      const ContactRows& r = x.rows;
      EXPECT_EQ(r.load[lane].lambdaN, f.fN);
      EXPECT_EQ(r.load[lane].lambda1, f.t.f1);
      EXPECT_EQ(r.load[lane].lambda2, f.t.f2);
      const bool sticks = f.t.inside > 0;
      const Real size = std::hypot(r.load[lane].lambda1, r.load[lane].lambda2);
      // a point that yields keeps the friction of its manifold: whether that slides is found between the
      // steps
      EXPECT_LE(size, .4 * f.fN * (1 + 1e-12));
      EXPECT_EQ(r.slip[lane].mu, .4);
      const bool loaded = f.fN > 0;
      EXPECT_EQ(r.load[lane].kN > before.rows.load[lane].kN, loaded && f.cN != 0);
      EXPECT_EQ(r.slip[lane].kT > before.rows.slip[lane].kT, loaded && sticks);
      sliding += !sticks;
    }
  }
  EXPECT_GT(sliding, 20);
  EXPECT_LT(sliding, 140);
}

TEST(Contact, DeepInOneAnotherItsStiffnessFollowsNoLoad) {
  Random random(8);
  StepConstants c = testConstants();
  c.contactPolicy = StiffnessPolicy::FollowLoad;
  ContactCase x = randomContact(random, .4);
  ContactRows& r = x.rows;
  const Real ceiling = kDeepStiffness * r.start;
  for (const Real share : {.5, 2.}) {
    const bool deep = share > 1;
    for (int lane = 0; lane < kLanes; ++lane) {
      r.place[lane].c0 = share * (1 - c.alpha) * kDeepShare * r.length;
      r.load[lane].kN = r.start, r.load[lane].lambdaN = 1e3 * c.loadAcceleration * ceiling * c.dt * c.dt;
      updateContactDuals<Real>(c, r, {}, {}, lane);
      EXPECT_EQ(r.load[lane].kN == ceiling, deep);
      EXPECT_EQ(r.load[lane].kN > 100 * ceiling, !deep);
    }
  }
}

TEST(Contact, FourLanesEqualSinglePoints) {
  Random random(6);
  const StepConstants c = testConstants();
  for (int n = 0; n < 40; ++n) {
    const ContactCase x = randomContact(random, .4);
    const Displacement a = displacement(x.a), b = displacement(x.b);
    for (const bool onA : {true, false}) {
      Block6T<Real4> four;
      accumulateContact<Real4>(true, x.rows, onA, a, b, 0, four);
      for (int lane = 0; lane < kLanes; ++lane) {
        const Block6 one = blockOf(x, onA, lane);
        const auto same = [&](const Vec3T<Real4>& v, const Vec3& w) {
          return v.x[lane] == w.x && v.y[lane] == w.y && v.z[lane] == w.z;
        };
        for (int i = 0; i < 3; ++i) {
          EXPECT_TRUE(same(four.ll.column(i), one.ll.column(i))) << i;
          EXPECT_TRUE(same(four.aa.column(i), one.aa.column(i))) << i;
        }
        EXPECT_TRUE(same(four.al0, one.al0) && same(four.al1, one.al1) && same(four.al2, one.al2));
        EXPECT_TRUE(same(four.fl, one.fl) && same(four.fa, one.fa));
      }
    }
    ContactRows together = x.rows, single = x.rows;
    updateContactDuals<Real4>(c, together, a, b, 0);
    for (int lane = 0; lane < kLanes; ++lane) updateContactDuals<Real>(c, single, a, b, lane);
    EXPECT_EQ(std::memcmp(&together, &single, sizeof single), 0);
  }
}

#if defined(RUBBLE_HAS_REAL8)

TEST(ContactPair, HasTheBitsOfEachContactAlone) {
  Random random(7);
  const StepConstants c = testConstants();
  for (int n = 0; n < 40; ++n) {
    ContactCase x[2] = {randomContact(random, .4), randomContact(random, .4)};
    const Displacement a[2] = {displacement(x[0].a), displacement(x[1].a)},
                       b[2] = {displacement(x[0].b), displacement(x[1].b)};
    const ContactPair pair{{&x[0].rows, &x[1].rows}, {&a[0], &a[1]}, {&b[0], &b[1]}};
    for (const bool onA : {true, false}) {
      const bool sides[2] = {onA, n % 2 == 0};
      Block6T<Real8> both;
      accumulateContacts(true, pair, sides, both);
      const auto* const lanes = reinterpret_cast<const Real*>(&both);
      for (int half = 0; half < 2; ++half) {
        Block6T<Real4> one;
        accumulateContact<Real4>(true, x[half].rows, sides[half], a[half], b[half], 0, one);
        const auto* const expected = reinterpret_cast<const Real*>(&one);
        for (int k = 0; k < 27 * kLanes; ++k)
          EXPECT_EQ(lanes[k / kLanes * 8 + 4 * half + k % kLanes], expected[k]) << k;
      }
    }
    ContactRows rows[2] = {x[0].rows, x[1].rows};
    updateContactDuals(c, rows[0], rows[1], {{&rows[0], &rows[1]}, {&a[0], &a[1]}, {&b[0], &b[1]}});
    for (int half = 0; half < 2; ++half) {
      updateContactDuals<Real4>(c, x[half].rows, a[half], b[half], 0);
      EXPECT_EQ(std::memcmp(&rows[half], &x[half].rows, sizeof rows[half]), 0);
    }
  }
}

TEST(ContactPair, ARowOfZerosAddsZeros) {
  Random random(8);
  const ContactCase x = randomContact(random, .4);
  const Displacement a = displacement(x.a), b = displacement(x.b), still{};
  const ContactRows none{};
  Block6T<Real8> both;
  accumulateContacts(true, {{&x.rows, &none}, {&a, &still}, {&b, &still}}, {true, true}, both);
  const auto* const lanes = reinterpret_cast<const Real*>(&both);
  for (int k = 0; k < 27 * 8; ++k)
    if (k % 8 >= kLanes) {
      EXPECT_EQ(lanes[k], 0) << k;
    }
}

#endif

TEST(Contact, TurnsWithTheWorld) {
  Random random(7);
  for (int n = 0; n < 40; ++n) {
    // without drift and tangential multipliers, which lie in the tangent basis, everything else is a vector
    ContactCase x = randomContact(random, .4);
    for (PointSlip& slip : x.rows.slip) slip.drift1 = slip.drift2 = 0;
    for (PointLoad& load : x.rows.load) load.lambda1 = load.lambda2 = 0;
    const Quat turn = random.rotation();
    ContactCase y = x;
    y.rows.n = rotate(turn, x.rows.n);
    y.rows.offset = rotate(turn, x.rows.offset);
    for (int k = 0; k < kLanes; ++k) y.rows.place[k].rA = rotate(turn, leverOf(x.rows, k, true));
    const auto turned = [&](const Vec6& d) { return Vec6{rotate(turn, d.lin), rotate(turn, d.ang)}; };
    y.a = turned(x.a), y.b = turned(x.b);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Block6 before = blockOf(x, true, lane), after = blockOf(y, true, lane);
      EXPECT_TRUE(test::near(rotate(turn, before.fl), after.fl, 1e-10));
      EXPECT_TRUE(test::near(rotate(turn, before.fa), after.fa, 1e-10));
      const Vec3 v{.3, -.2, .7};
      EXPECT_TRUE(test::near(rotate(turn, before.aa * v), after.aa * rotate(turn, v), 1e-8));
    }
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
