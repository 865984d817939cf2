/// Heaps of jointed bodies throw nothing off, however bodies land on one another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::Random;

using test::kGravity;

/// Adds a box with a joint to `parent` at the point `anchor` of the parent and `own` of the box, in body
/// frames. The box has the orientation of its parent.
void addLimb(Scene& scene, int parent, const Vec3& half, const Vec3& anchor, const Vec3& own,
             JointType type) {
  const BodyDef& to = scene.bodies[static_cast<std::size_t>(parent)];
  BodyDef limb = to;
  limb.shape = Shape::box(half);
  limb.position = to.position + rotate(to.orientation, anchor - own);
  JointDef joint = test::ball(parent, anchor, static_cast<int>(scene.bodies.size()), own);
  joint.type = type;
  scene.bodies.push_back(limb);
  scene.joints.push_back(joint);
}

BodyDef turnedBox(const Vec3& half, const Vec3& position, Random& random) {
  BodyDef def = test::body(Shape::box(half), position, random.uniform(.1, 1));
  def.orientation = random.rotation();
  def.density = random.uniform(300, 3000);
  return def;
}

/// Layers of two pairs of cubes each. A ball or fixed joint connects the cubes of a pair at their faces. No
/// two pairs touch at the start.
Scene pairs(std::uint64_t seed, double height) {
  Random random(seed);
  Scene scene = test::emptyScene({0, 0, -kGravity});
  scene.bodies.push_back(test::ground());
  for (double z = 1; z < height; z += 1.1)
    for (const double x : {-.6, .6}) {
      scene.bodies.push_back(turnedBox({.2, .2, .2}, {x, 0, z}, random));
      const JointType type = random.below(2) == 0 ? JointType::Ball : JointType::Fixed;
      addLimb(scene, static_cast<int>(scene.bodies.size()) - 1, {.2, .2, .2}, {.24, 0, 0}, {-.24, 0, 0},
              type);
    }
  return scene;
}

/// A column of figures: a trunk with a head, two arms and two legs on ball joints. No two figures touch at
/// the start.
Scene figures(std::uint64_t seed, double height) {
  Random random(seed);
  Scene scene = test::emptyScene({0, 0, -kGravity});
  scene.bodies.push_back(test::ground());
  for (double z = 1.2; z < height; z += 1.9) {
    const int trunk = static_cast<int>(scene.bodies.size());
    scene.bodies.push_back(
        turnedBox({.2, .12, .3}, {random.uniform(-.2, .2), random.uniform(-.2, .2), z}, random));
    addLimb(scene, trunk, {.1, .1, .1}, {0, 0, .32}, {0, 0, -.12}, JointType::Fixed);
    for (const double side : {-1., 1.}) {
      addLimb(scene, trunk, {.2, .06, .06}, {side * .22, 0, .24}, {-side * .22, 0, 0}, JointType::Ball);
      addLimb(scene, trunk, {.07, .07, .25}, {side * .12, 0, -.32}, {0, 0, .27}, JointType::Ball);
    }
  }
  return scene;
}

/// What a fall shows: the largest speed of a center [m/s], and how far the energy rose above its lowest so
/// far, over that at the start.
struct Fall {
  double speed = 0, rise = 0;
};
Fall fall(const Scene& scene, int iterations, int steps) {
  World world(scene, test::options(iterations));
  const auto energy = [&] {
    double sum = 0;
    for (const BodyId id : world.bodies()) {
      const BodyState s = world.state(id);
      const MassProperties mass = world.massOf(id);
      if (!(mass.mass > 0)) continue;
      const Vec3 w = rotate(conjugate(s.orientation), s.angularVelocity);
      sum += mass.mass * (dot(s.velocity, s.velocity) / 2 + kGravity * s.position.z) +
             (mass.inertia.x * w.x * w.x + mass.inertia.y * w.y * w.y + mass.inertia.z * w.z * w.z) / 2;
    }
    return sum;
  };
  const double start = energy();
  double lowest = start;
  Fall out;
  for (int i = 0; i < steps; ++i) {
    world.step();
    for (const BodyId id : world.bodies()) out.speed = std::max(out.speed, length(world.state(id).velocity));
    const double now = energy();
    out.rise = std::max(out.rise, (now - lowest) / start);
    lowest = std::min(lowest, now);
  }
  return out;
}

void expectNothingIsThrownOff(Scene (*build)(std::uint64_t, double)) {
  constexpr double kHeight = 12;
  for (const int iterations : {4, 10})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Fall f = fall(build(seed, kHeight), iterations, 300);
      // the head of a figure may whip a little ahead of the rest
      EXPECT_LT(f.speed, 1.2 * std::sqrt(2 * kGravity * kHeight))
          << iterations << " iterations, seed " << seed;
      EXPECT_LT(f.rise, .01) << iterations << " iterations, seed " << seed;
    }
}

TEST(JointedHeap, OfPairsOfCubesIsNeverFasterThanItsFallAndGainsNoEnergy) { expectNothingIsThrownOff(pairs); }
TEST(JointedHeap, OfFiguresIsNeverFasterThanItsFallAndGainsNoEnergy) { expectNothingIsThrownOff(figures); }

}  // namespace
}  // namespace rubble
