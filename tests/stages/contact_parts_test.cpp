/// Parts of contacts in closed form: paths of points on round bodies, drift and cones of points, impulses,
/// one-way surfaces, rules of materials.
#include <gtest/gtest.h>

#include <vector>

#include "stages/bounces/impact.h"
#include "stages/contacts/one_way.h"
#include "stages/contacts/rolling.h"
#include "stages/contacts/stored_points.h"
#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// A point of body A at lever r with outward normal `out`, for a rotation in one step. `own`: the shape,
/// which is the body's own, or a part at `at` of its compound.
Vec3 swept(const ShapeData& own, const Vec3& dw, const Vec3& r, const Vec3& out, bool isPart = false,
           const Vec3& at = {}) {
  BodyParams params[2]{};
  ShapePart part{own, at, {}, 0, -1};
  int index[] = {0, 0, 0, 1};
  Pair pair{0, 1, true, 0, 0};
  int activePair = 0;
  Quat orientation[2]{};
  params[0].shape = isPart ? ShapeData{{1, 1, 1}, 0, ShapeKind::Compound, 0} : own;
  SolverData s{};
  s.params = params, s.orientation = orientation, s.shapePart = &part, s.shapeIndex = index, s.pair = &pair,
  s.activePair = &activePair;
  ContactRows rows{};
  rows.a = 0, rows.b = 1, rows.n = out, rows.manifold = 0;
  return sweptBy(s, rows, true, dw, expRotation(dw), r);
}

TEST(SweptPoint, OfARollingShapeGoesAlongTheArc) {
  constexpr Real kRadius = .3, kHalf = .5;
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Vec3 dw = random.vector(.6), out = random.direction(), round = kRadius * out;
    const ShapeData ball{{0, 0, 0}, kRadius, ShapeKind::Sphere, -1},
        rod{{0, 0, kHalf}, kRadius, ShapeKind::Capsule, -1}, brick{{.3, .2, .1}, 0, ShapeKind::Box, -1};
    EXPECT_TRUE(test::near(swept(ball, dw, round, out), cross(dw, round), 1e-12));
    // the end of the axis moves with the body, and the round part rolls
    const Vec3 end{0, 0, kHalf}, moved = rotate(expRotation(dw), end) - end;
    EXPECT_TRUE(test::near(swept(rod, dw, end + round, out), moved + cross(dw, round), 1e-12));
    const Vec3 corner{.3, .2, .1}, turned = rotate(expRotation(dw), corner) - corner;
    EXPECT_TRUE(test::near(swept(brick, dw, corner, out), turned, 1e-12));
    // parts of a compound: their centers move with it
    const Vec3 at = random.vector(), carried = rotate(expRotation(dw), at) - at;
    EXPECT_TRUE(test::near(swept(ball, dw, at + round, out, true, at), carried + cross(dw, round), 1e-12));
    EXPECT_TRUE(test::near(swept(brick, dw, at + corner, out, true, at), carried + turned, 1e-12));
    // a wheel that turns about its axis rolls
    const ShapeData wheel{{kRadius, kRadius, .1}, 0, ShapeKind::Cylinder, -1};
    const Vec3 turn{0, 0, dw.z}, across = normalize(Vec3{out.x, out.y, 0}), rim = kRadius * across,
                                 hub = rotate(expRotation(turn), at) - at;
    EXPECT_TRUE(test::near(swept(wheel, turn, at + rim, across, true, at), hub + cross(turn, rim),
                           dot(turn, turn) < kUnrolled2 ? 1e-4 : 1e-12));
    // slow rotations count as those of material points, which is the same to second order
    const Vec3 slow = dw * Real(1e-3);
    EXPECT_TRUE(test::near(swept(ball, slow, round, out), cross(slow, round), 1e-6));
  }
}

/// Two boxes with a contact whose points have random levers and have moved at random.
struct Touching {
  StepConstants step = testConstants();
  BodyParams params[2]{};
  Vec3d position[2]{};
  Quat orientation[2]{};
  BodyTarget target[2]{};
  ContactRows rows{};
  Displacement a{}, b{};
  SolverData view{};

  explicit Touching(Random& random) {
    for (int i = 0; i < 2; ++i) {
      params[i].shape = {{.3, .2, .1}, 0, ShapeKind::Box, -1};
      params[i].kind = BodyKind::Dynamic, params[i].inertia = Vec3{2, 2, 2} + random.vector(.5);
      orientation[i] = random.rotation();
      target[i].mass = massMatrix(random.uniform(1, 3), params[i].inertia, orientation[i]);
    }
    rows.a = 0, rows.b = 1, rows.n = random.direction(), rows.offset = random.vector();
    rows.start = 10, rows.length = .5, rows.most = 1e30;
    for (int k = 0; k < kLanes; ++k) rows.place[k].rA = random.vector(), rows.place[k].c0 = -.01 * k;
    // rotations below the threshold of sweptBy()
    a = {random.vector(.01), 0, random.vector(.002), 0}, b = {random.vector(.01), 0, random.vector(.002), 0};
    view.step = &step, view.params = params, view.position = position, view.orientation = orientation;
    view.target = target;
  }
  /// Displacement of point k on A relative to that on B.
  Vec3 moved(int k) const {
    const Vec3 rA = rows.place[k].rA, rB = rA + rows.offset;
    return a.dp + cross(a.dw, rA) - b.dp - cross(b.dw, rB);
  }
};

TEST(StoredPoints, AddTheirMotionToTheDriftThatTheyHad) {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    Touching x(random);
    x.rows.muStatic = .6, x.rows.muDynamic = .4;
    const StoredFrame frame = storedFrame(x.rows.n, x.a, x.b);
    for (int k = 0; k < kLanes; ++k) {
      const bool slips = k % 2 == 1;
      x.rows.load[k] = {10, 0, slips ? Real(4) : Real(1), 100};
      x.rows.slip[k].mu = .4, x.rows.slip[k].kT = 100;
      x.rows.slip[k].drift1 = .01, x.rows.slip[k].drift2 = -.02;
      PointBefore before;
      before.drift1 = -.03, before.drift2 = .05;
      const StoredPoint stored = storedPoint(x.view, x.rows, frame, k, false, before);
      EXPECT_EQ(stored.sticks, !slips);
      // one that slips keeps what its row has not corrected; one that sticks, all drift since it stuck
      const Real start1 = slips ? .01 : -.03, start2 = slips ? -.02 : .05;
      EXPECT_NEAR(stored.memory.drift1, start1 + dot(frame.t1, x.moved(k)), 1e-5);
      EXPECT_NEAR(stored.memory.drift2, start2 + dot(frame.t2, x.moved(k)), 1e-5);
    }
  }
}

TEST(ContactRows, StartWithinTheirConeWhicheverWayTheyWerePulled) {
  Random random(5);
  Touching x(random);
  PairRows pair{};
  pair.bodies = {0, 1}, pair.mu = .5;
  for (int round = 0; round < 20; ++round) {
    Manifold m{};
    m.count = 1, m.activePoints = 1;
    const Real pull = random.uniform(1, 20), angle = random.uniform(0, 6.28);
    m.lambdaN[0] = 10, m.lambda1[0] = pull * std::cos(angle), m.lambda2[0] = pull * std::sin(angle);
    m.kN[0] = m.kT[0] = 100;
    const Quad<Real> load = pointRows<Real>(x.view, m, pair, {}, x.rows, 0).load;
    const Real decay = load.x / m.lambdaN[0];
    EXPECT_NEAR(std::hypot(load.y, load.z), std::min(decay * pull, pair.mu * load.x), 1e-9);
    EXPECT_NEAR(load.y * m.lambda2[0], load.z * m.lambda1[0], 1e-9) << "the direction stays";
  }
}

/// The row of a ball on a slab that is also free must not be stiffer than the ball is heavy.
TEST(RollingRow, StartsAsStiffAsTheLighterBodyIsHeavy) {
  Random random(7);
  Touching x(random);
  SurfaceData surface{};
  surface.rolling = .01;
  Manifold manifold{};
  manifold.normal = {0, 0, 1};
  Pair pair{};
  pair.owner = 0, pair.other = 1;
  RollingRows rolling{};
  int activePair = 0, before = -1, hasRows = 1;
  x.view.surfaces = 1, x.view.surface = &surface, x.view.manifold = &manifold, x.view.pair = &pair;
  x.view.rolling = &rolling, x.view.activePair = &activePair, x.view.manifoldBefore = &before;
  x.view.hasRows = &hasRows;
  const auto stiffness = [&](Real massA, Real massB) {
    for (BodyParams& p : x.params) p.surface = 0, p.radius = .4;
    x.params[0].mass = massA, x.params[1].mass = massB;
    BuildRolling{}(x.view, 0);
    return rolling.kRoll;
  };
  EXPECT_GT(stiffness(2, 2), 0);
  EXPECT_EQ(stiffness(2, 1000), stiffness(2, 2));
  EXPECT_EQ(stiffness(1000, 2), stiffness(2, 2));
  x.params[0].kind = BodyKind::Static;
  EXPECT_EQ(stiffness(0, 2), stiffness(2, 2));
}

TEST(Impact, PushesAsManyStrikesAlongTheNormalWould) {
  Random random(6);
  for (int round = 0; round < 20; ++round) {
    Touching x(random);
    const Impact impact(x.view, x.rows);
    const BodyMotion still{{0, 0, 0}, {0, 0, 0}};
    BodyMotion pushed[2] = {still, still}, struck[2] = {still, still};
    const Real p[kLanes] = {1, .5, 0, 2}, times = 1.5;
    impact.push(p, times, pushed[0], pushed[1]);
    for (int k = 0; k < kLanes; ++k) impact.strike(k, times * p[k] * x.rows.n, struck[0], struck[1]);
    for (int i = 0; i < 2; ++i) {
      EXPECT_TRUE(test::near(pushed[i].v, struck[i].v, 1e-12));
      EXPECT_TRUE(test::near(pushed[i].w, struck[i].w, 1e-12));
    }
    EXPECT_TRUE(test::near(x.target[0].mass.mass * pushed[0].v, -x.target[1].mass.mass * pushed[1].v, 1e-12));
  }
}

/// Boxes that lie against one another at rest and are pulled apart are free of one another at once.
TEST(ActivePoints, AreThoseThatDoNotStayOpenAtTheTargets) {
  Random random(9);
  Touching x(random);
  x.step.inactiveRows = true;
  Vec3 still[2]{};
  int bound[2]{};
  x.view.velocity = x.view.angularVelocity = still, x.view.impactSpeedBound = bound;
  PairPose pose{};
  pose.length = .5, pose.t = {0, 0, .2};
  PointAt point{};
  point.lever = {0, 0, .1}, point.depth = 0;
  for (const Real opens : {-.1, 0., .9, 1.1, 50.}) {
    ActivationRule isActive{};
    isActive.b.dp = {0, 0, opens * kInactiveGap * pose.length};
    EXPECT_EQ(isActive(x.view, {0, 1}, pose, {0, 0, 1}, point, 0), opens < 1) << opens;
    EXPECT_TRUE(isActive(x.view, {0, 1}, pose, {0, 0, 1}, point, 1)) << "it carries load";
  }
}

TEST(OneWay, HoldsWithinSixtyDegreesOfItsDirection) {
  const Vec3 way{0, 0, 1};
  const auto normalAt = [](Real cosine) { return Vec3{std::sqrt(1 - cosine * cosine), 0, cosine}; };
  for (const Real cosine : {.5, .51, 1.}) EXPECT_TRUE(isInFront(way, normalAt(cosine))) << cosine;
  for (const Real cosine : {.49, 0., -1.}) EXPECT_FALSE(isInFront(way, normalAt(cosine))) << cosine;
  EXPECT_TRUE(isInFront({0, 0, 0}, {0, 0, -1})) << "other surfaces have no direction";
}

TEST(MaterialRules, AreFoundForTwoKindsInEitherOrder) {
  // sorted by world, then by kinds
  std::vector<MaterialRule> rules;
  for (const auto& [world, low, high] : {std::array{0, 1, 1}, {0, 1, 3}, {0, 2, 5}, {1, 1, 2}, {1, 2, 5}})
    rules.push_back({world, low, high, 0, 0, 0, 0, 0, 0});
  SolverData s{};
  s.materialRules = static_cast<int>(rules.size()), s.materialRule = rules.data();
  for (int world = 0; world < 2; ++world)
    for (int a = 0; a < 7; ++a)
      for (int b = 0; b < 7; ++b) {
        const MaterialRule* expected = nullptr;
        for (const MaterialRule& r : rules)
          if (r.world == world && r.low == std::min(a, b) && r.high == std::max(a, b)) expected = &r;
        EXPECT_EQ(ruleOf(s, world, a, b), expected) << world << ": " << a << ", " << b;
      }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
