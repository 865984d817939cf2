/// Sorting bodies in memory changes nothing that the API shows.
#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <utility>

#include "tests/support/expect.h"
#include "tests/support/sorted.h"

namespace rubble {
namespace {

/// Sums of the solver are taken in another order: after one step states differ by round-off.
constexpr double kRoundOff = 2e-5;  // [m]
constexpr int kSettled = 90;

class Order : public ::testing::TestWithParam<const char*> {
 protected:
  World world(bool sorted, int steps = kSettled) const {
    return test::towersAfter(GetParam(), steps, sorted);
  }
};

TEST_P(Order, OfBodiesChangesNoneOfTheirStates) {
  World as = world(false), sorted = world(true);
  EXPECT_LT(test::apart(as, sorted), kRoundOff);
  EXPECT_EQ(as.bodies(), sorted.bodies());
  // without a warm start the towers would sink
  test::run(as, 10), test::run(sorted, 10);
  EXPECT_LT(test::apart(as, sorted), 10 * kRoundOff);
}

TEST_P(Order, KeepsContactsAndWhatTheyBear) {
  World as = world(false), sorted = world(true);
  const double weight = 10. * test::kTowers * test::kTowers * test::kTowerHeight;
  EXPECT_NEAR(sorted.contactLoad(sorted.bodyAt(0)).force.z, -weight, .01 * weight);
  std::set<std::pair<int, int>> pairs[2];
  for (const ContactPoint& c : as.contacts()) pairs[0].emplace(c.a.index, c.b.index);
  for (const ContactPoint& c : sorted.contacts()) {
    EXPECT_LT(c.a.index, c.b.index);
    pairs[1].emplace(c.a.index, c.b.index);
  }
  EXPECT_EQ(pairs[0], pairs[1]);
}

TEST_P(Order, KeepsContactsRecycled) {
  World as(test::tower(6), test::options(10, GetParam())),
      sorted(test::tower(6), test::options(10, GetParam()));
  test::run(as, 60), test::run(sorted, 60);
  sorted.sortBodies();
  const StepReport a = as.step(), b = sorted.step();
  EXPECT_GT(a.recycled, 0);
  EXPECT_EQ(b.recycled, a.recycled);
  EXPECT_EQ(b.contacts, a.contacts);
}

TEST_P(Order, EditsFindTheirBodies) {
  const Scene scene = test::shuffledTowers();
  const int pushed = test::cubeOfCourse(scene, 2), lifted = test::cubeOfCourse(scene, 2, 1),
            moved = test::cubeOfCourse(scene, 2, 2);
  const int gone = test::cubeOfCourse(scene, 2, 3), sunk = test::cubeOfCourse(scene, 0, 4);
  World as = world(false), sorted = world(true);
  for (World* w : {&as, &sorted}) {
    w->removeBody(w->bodyAt(gone));
    const BodyId fresh = w->addBody(test::unitCube({-9, 9, .5}));
    EXPECT_EQ(fresh.index, w->bodyAt(gone).index);
    w->applyImpulse(w->bodyAt(pushed), {0, 0, 3});
    w->applyForce(w->bodyAt(lifted), {0, 0, 70});
    BodyState state = w->state(w->bodyAt(moved));
    state.position = {-9, -9, .5};
    w->setState(w->bodyAt(moved), state);
    w->setCollide(w->bodyAt(sunk), w->bodyAt(0), false);
    w->addBody(test::unitCube({9, 9, .5}));
    w->step();
    EXPECT_GT(w->state(w->bodyAt(pushed)).velocity.z, 2.5);
    EXPECT_GT(w->state(w->bodyAt(lifted)).velocity.z, .5);
    EXPECT_NEAR(w->state(w->bodyAt(moved)).position.x, -9, 1e-3);
  }
  test::run(as, 20), test::run(sorted, 20);
  EXPECT_LT(test::apart(as, sorted), 1e-3);
  EXPECT_LT(sorted.state(sorted.bodyAt(sunk)).position.z, .2);
}

TEST_P(Order, ExclusionsStandThroughIt) {
  Scene scene = test::shuffledTowers();
  std::vector<int> sunk;
  for (int i = 0; i < 8; ++i) sunk.push_back(test::cubeOfCourse(scene, 0, 3 * i));
  for (const int i : sunk) scene.exclusions.push_back({0, i});
  World w(scene, test::options(10, GetParam()));
  test::run(w, 2);
  w.sortBodies();
  test::run(w, 60);
  for (int i = 0; i < test::kTowers * test::kTowers; ++i) {
    const int cube = test::cubeOfCourse(scene, 0, i);
    const bool falls = std::find(sunk.begin(), sunk.end(), cube) != sunk.end();
    EXPECT_EQ(w.state(w.bodyAt(cube)).position.z < -1, falls) << i;
  }
}

TEST_P(Order, JointsHoldTheSameBodies) {
  World as = world(false), sorted = world(true);
  ASSERT_FALSE(sorted.joints().empty());
  for (const JointId id : sorted.joints()) {
    EXPECT_EQ(sorted.bodiesOf(id), as.bodiesOf(id));
    EXPECT_LT(sorted.state(id).gap, 1e-3);
  }
  test::run(sorted, 30);
  for (const JointId id : sorted.joints()) EXPECT_LT(sorted.state(id).gap, 1e-3);
  // a joint that is made now, too
  const Scene scene = test::shuffledTowers();
  const BodyId a = sorted.bodyAt(test::cubeOfCourse(scene, 2)),
               b = sorted.bodyAt(test::cubeOfCourse(scene, 2, 9));
  JointDef rope;
  rope.type = JointType::Rope;
  const double before = length(sorted.state(a).position - sorted.state(b).position);
  rope.length = .9 * before;
  sorted.addJoint(rope, a, b);
  test::run(sorted, 60);
  EXPECT_NEAR(length(sorted.state(a).position - sorted.state(b).position), rope.length, .05);
}

TEST_P(Order, ArraysStayById) {
  World w = world(false);
  const std::int64_t before = w.epoch();
  w.sortBodies();
  w.step();
  EXPECT_NE(w.epoch(), before);
  const ArrayView position = w.array(StateArray::Position);
  const auto rowIs = [&](BodyId id) {
    Vec3 row;
    for (int k = 0; k < 3; ++k)
      std::memcpy(
          &row[k],
          static_cast<const char*>(position.data) + id.index * position.strides[0] + k * position.strides[1],
          sizeof(double));
    return row == w.state(id).position;
  };
  for (const BodyId id : w.bodies()) EXPECT_TRUE(rowIs(id)) << id.index;
  // a view lives on, and a second sort does not end it
  w.sortBodies();
  test::run(w, 2);
  EXPECT_EQ(w.array(StateArray::Position).data, position.data);
  for (const BodyId id : w.bodies()) EXPECT_TRUE(rowIs(id)) << id.index;

  const int rows[2] = {w.bodyAt(4).index, w.bodyAt(11).index};
  const double values[2][3] = {{1, 2, 30}, {4, 5, 60}};
  w.scatter(StateArray::Position, packedArray(rows, 2), packedArray(values[0], 2, 3));
  EXPECT_EQ(w.state(w.bodyAt(4)).position, (Vec3{1, 2, 30}));
  EXPECT_EQ(w.state(w.bodyAt(11)).position, (Vec3{4, 5, 60}));
  EXPECT_TRUE(rowIs(w.bodyAt(4)) && rowIs(w.bodyAt(11)) && rowIs(w.bodyAt(5)));
}

TEST_P(Order, PosesAndSolverStatesAreById) {
  World as = world(false), sorted = world(true);
  sorted.beginPoses();
  const PoseFrame frame = sorted.takePoses();
  for (const BodyId id : sorted.bodies()) {
    double z;
    std::memcpy(&z,
                static_cast<const char*>(frame.position.data) + id.index * frame.position.strides[0] +
                    2 * frame.position.strides[1],
                sizeof z);
    EXPECT_EQ(z, sorted.state(id).position.z);
  }
  const std::vector<SolverState> a = as.solverStates(), b = sorted.solverStates();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    EXPECT_NEAR(a[k].multiplier, b[k].multiplier, .02 * a[k].multiplier + .1) << k;
}

TEST_P(Order, QueriesFindTheSameBodies) {
  World as = world(false), sorted = world(true);
  std::vector<RayQuery> rays;
  for (int i = 0; i < 12; ++i) {
    RayQuery ray;
    ray.origin = {.25 * i, .2 * i, 12};
    ray.direction = {0, 0, -1};
    ray.maxDistance = 20;
    if (i % 3 == 0) ray.filter.ignore = as.bodyAt(0);
    rays.push_back(ray);
  }
  const std::vector<RayHit> a = as.castRays(rays), b = sorted.castRays(rays);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    ASSERT_EQ(a[k].hit, b[k].hit);
    if (a[k].hit) {
      EXPECT_EQ(a[k].body, b[k].body) << k;
    }
  }
  OverlapQuery ball;
  ball.shape = Shape::sphere(1);
  ball.position = {1, 1, 1};
  EXPECT_EQ(as.overlaps({&ball, 1}), sorted.overlaps({&ball, 1}));
}

TEST_P(Order, EventsGoOnAsIfNothingHadHappened) {
  WorldOptions options = test::options(10, GetParam());
  options.events = true;
  World w(test::tower(5), options);
  test::run(w, 60);
  w.sortBodies();
  ASSERT_TRUE(w.step().sorted);
  ASSERT_EQ(w.events().contacts.size(), 5u);
  for (const ContactEvent& event : w.events().contacts) {
    EXPECT_EQ(event.phase, Phase::Stay);
    EXPECT_LT(event.a.index, event.b.index);
  }
}

TEST_P(Order, WhatSleepsSleepsOnAndWakesWhole) {
  WorldOptions options = test::options(4, GetParam());
  options.params.sleeping = true;
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  // two towers, whose cubes take turns
  for (int i = 0; i < 3; ++i)
    for (const double x : {10., 0.}) scene.bodies.push_back(test::unitCube({x, 0, .5 + i}));
  World w(scene, options);
  test::run(w, 120);
  w.sortBodies();
  ASSERT_TRUE(w.step().sorted);
  for (int i = 1; i <= 6; ++i) EXPECT_TRUE(w.asleep(w.bodyAt(i))) << i;
  w.applyImpulse(w.bodyAt(1), {.1, 0, 0});
  EXPECT_EQ(w.step().sleepingBodies, 3);
  for (int i = 1; i <= 6; ++i) EXPECT_EQ(w.asleep(w.bodyAt(i)), i % 2 == 0) << i;
}

TEST_P(Order, SnapshotsKnowIt) {
  World w = world(false);
  const Snapshot before = w.snapshot();
  test::run(w, 3);
  const std::uint64_t unsorted = w.hash();
  w.restore(before);
  w.sortBodies();
  w.step();
  const Snapshot after = w.snapshot();
  test::run(w, 5);
  const std::uint64_t sorted = w.hash();
  const Vec3 place = w.state(w.bodyAt(13)).position;
  w.restore(before);
  test::run(w, 3);
  EXPECT_EQ(w.hash(), unsorted);
  w.restore(after);
  test::run(w, 5);
  EXPECT_EQ(w.hash(), sorted);
  EXPECT_EQ(w.state(w.bodyAt(13)).position, place);
  // and another world restores it
  World other(test::shuffledTowers(), test::options(10, GetParam()));
  other.restore(after);
  test::run(other, 5);
  EXPECT_EQ(other.hash(), sorted);
  EXPECT_EQ(other.state(other.bodyAt(13)).position, place);
}

TEST_P(Order, IsTheSameEachTime) {
  const auto hash = [&] {
    World w = world(true);
    test::run(w, 20);
    EXPECT_EQ(w.firstDifference(), "");
    return w.hash();
  };
  EXPECT_EQ(hash(), hash());
}

/// A cloth on two posts with a box attached to one of its corners, and other boxes in random order.
Scene trampoline() {
  Scene scene = test::emptyScene();
  for (const double x : {3., -5., .2, 7., -9.})
    scene.bodies.push_back(test::body(Shape::box({.2, .2, .2}), {x, 0, x == .2 ? 1.25 : .2}));
  scene.bodies.push_back(test::ground());
  ClothDef cloth = clothSheet({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, 8, 8);
  for (const int corner : {0, 8, 72, 80}) cloth.fixed.push_back(corner);
  scene.deformables.push_back(cloth);
  AttachmentDef tie;
  tie.object = 0, tie.body = 2, tie.vertices = {40};
  scene.attachments.push_back(tie);
  return scene;
}

TEST_P(Order, OfBodiesOnSoftThingsChangesNoneOfTheirStates) {
  World as(trampoline(), test::options(10, GetParam())), sorted(trampoline(), test::options(10, GetParam()));
  test::run(as, 40), test::run(sorted, 40);
  ASSERT_FALSE(as.vertexContacts().empty());
  sorted.sortBodies();
  for (int i = 0; i < 10; ++i) {
    const StepReport a = as.step(), b = sorted.step();
    EXPECT_EQ(b.sorted, i == 0);
    EXPECT_EQ(b.vertexContacts, a.vertexContacts);
  }
  EXPECT_LT(test::apart(as, sorted), 10 * kRoundOff);
}

TEST_P(Order, IsMadeAsOftenAsAsked) {
  WorldOptions options = test::options(1, GetParam());
  options.params.sortInterval = 4;
  World often(test::shuffledTowers(), options), never(test::shuffledTowers(), test::options(1, GetParam()));
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(often.step().sorted, i % 4 == 0) << i;
    EXPECT_FALSE(never.step().sorted);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, Order, ::testing::Values("cpu", "reference", "lockstep"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace rubble
