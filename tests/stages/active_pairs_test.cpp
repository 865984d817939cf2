/// Pairs without a manifold could not have taken part in the step.

#include "tests/support/core_world.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// Number of active points of a pair, by a full test at x^t.
int countActivePoints(const SolverData& s, const Pair& p) {
  const OrderedPair o = ordered(p);
  const PairPose pose = pairPose(s, o);
  const Manifold m = newManifold(collide(s.params[o.a].shape, s.params[o.b].shape, pose), pose);
  const ActivationRule isActivePoint = activationRule(s, o);
  int count = 0;
  for (int k = 0; k < m.count; ++k)
    count += isActivePoint(s, o, pose, m.normal, pointAt(m, k, m.normal, pose.qA, pose.qB, pose.t), 0);
  return count;
}

struct Seen {
  int apart = 0, near = 0;
};
/// Runs steps and looks at all pairs of each when its manifolds are found.
Seen watch(CoreWorld& world, int steps) {
  // more than any body here has
  Seen seen;
  CpuExecutor& executor = world.executor();
  bool due = false;
  executor.observe([&](std::string_view stage, std::string_view) {
    if (!due || stage != "rows") return;
    due = false;
    const SolverData& s = world.view();
    for (int i = 0; i < s.counters->pairs; ++i) {
      (s.isActive[i] ? seen.near : seen.apart) += 1;
      if (s.isActive[i]) continue;
      EXPECT_EQ(countActivePoints(s, s.pair[i]), 0)
          << "bodies " << s.pair[i].owner << " and " << s.pair[i].other;
    }
  });
  for (int n = 0; n < steps; ++n) {
    due = true;
    world.begin();
    step(executor);
  }
  return seen;
}

BodyDef brick(const Vec3& half, const Vec3& position, const Quat& orientation) {
  BodyDef body;
  body.shape = Shape::box(half);
  body.position = position;
  body.orientation = orientation;
  return body;
}

TEST(ActivePairs, NoPointOfAPairWithoutManifoldTakesPartInTheStep) {
  for (const double speed : {.05, .5, 5., 50.}) {
    Random random(static_cast<unsigned>(1 + speed));
    CoreWorld world;
    world.settings().gravity = {0, 0, -10};
    for (int i = 0; i < 250; ++i) {
      BodyDef body = brick({random.uniform(.1, .4), random.uniform(.1, .4), random.uniform(.1, .4)},
                           random.vector(2.5), random.rotation());
      if (i % 3 == 1) body.shape = Shape::capsule(.15, .2);
      if (i % 3 == 2) body.shape = Shape::sphere(.3);
      body.velocity = random.vector(speed);
      body.angularVelocity = random.vector(2 * speed);
      if (i % 10 == 0) body.motion = i % 20 == 0 ? Motion::Static : Motion::Kinematic;
      world.add(body);
    }
    world.finish();
    const Seen seen = watch(world, 30);
    EXPECT_GT(seen.near, 1000) << "at " << speed << " m/s";
    if (speed < 1) {
      EXPECT_GT(seen.apart, 1000) << "at " << speed << " m/s";
    }
  }
}

TEST(ActivePairs, BricksAcrossAGapHaveNoManifold) {
  // two piles rotated by 45 degrees, 2 cm apart: their bounding boxes overlap, the bodies do not touch
  CoreWorld world;
  BodyDef ground;
  ground.motion = Motion::Static;
  ground.shape = Shape::plane();
  world.add(ground);
  const Vec3 half{.2, .1, .1};
  const Quat turn = fromAxisAngle(Vec3{0, 0, 1}, .7853981634);
  const int levels = 10;
  for (int side = 0; side < 2; ++side)
    for (int k = 0; k < levels; ++k)
      world.add(brick(half,
                      rotate(turn, Vec3{0, side * (2 * half.y + .02), 0}) + Vec3{0, 0, half.z * (2 * k + 1)},
                      turn));
  world.finish();
  watch(world, 10);
  const Seen seen = watch(world, 1);
  EXPECT_EQ(seen.near, 2 * levels) << "each brick on the one below it, the lowest on the ground";
  EXPECT_GE(seen.apart, levels);
}

TEST(ActivePairs, ThatWereApartMeetInTime) {
  // starts apart with a known distance, and is driven into the other by a force: stops at it
  CoreWorld world;
  world.settings().gravity = {0, 0, 0};
  const Vec3 half{.2, .1, .1};
  const Quat turn = fromAxisAngle(Vec3{0, 0, 1}, .7853981634);
  BodyDef fixed = brick(half, {0, 0, 0}, turn);
  fixed.motion = Motion::Static;
  world.add(fixed);
  const Vec3 across = rotate(turn, Vec3{0, 1, 0});
  const int mover = world.add(brick(half, across * (2 * half.y + .02), turn));
  world.finish();
  const Seen before = watch(world, 3);
  EXPECT_GT(before.apart, 0);
  const SolverData& s = world.view();
  Real deepest = 0;
  for (int n = 0; n < 120; ++n) {
    s.force[mover] = across * (Real(-2) * s.params[mover].mass);
    watch(world, 1);
    deepest = max(deepest, 2 * half.y - dot(across, Vec3(s.position[mover])));
  }
  EXPECT_LT(deepest, 2e-3);
  EXPECT_LT(dot(across, Vec3(s.position[mover])), 2 * half.y + 1e-3) << "it has come to the other";
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
