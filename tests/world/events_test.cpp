/// Events, sensors and forces out.
#include <gtest/gtest.h>
#include <rubble/worlds.h>

#include <algorithm>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

WorldOptions withEvents(int threads = 1) {
  WorldOptions options = test::options(4, "cpu", threads);
  options.events = true;
  return options;
}

TEST(Events, AContactBeginsStaysAndEnds) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::unitCube({0, 0, 1}));
  World world(scene, withEvents());
  const BodyId cube = world.bodyAt(1);
  int begins = 0, ends = 0, stays = 0;
  Vec3 impulse;
  for (int i = 0; i < 180; ++i) {
    if (i == 120) world.applyImpulse(cube, {0, 0, 3});
    world.step();
    for (const ContactEvent& e : world.events().contacts) {
      EXPECT_EQ(e.a, world.bodyAt(0));
      EXPECT_EQ(e.b, cube);
      begins += e.phase == Phase::Begin, ends += e.phase == Phase::End, stays += e.phase == Phase::Stay;
      if (i == 119) impulse = e.impulse;
      EXPECT_EQ(e.points.empty(), e.phase == Phase::End);
    }
  }
  EXPECT_EQ(begins, 2);  // the fall, and after the push
  EXPECT_EQ(ends, 1);
  EXPECT_GT(stays, 60);
  EXPECT_TRUE(test::near(impulse, Vec3{0, 0, 10. / 60}, 1e-3));
}

TEST(Events, LoadsAreTheWeightsThatRestOnABody) {
  World world(test::tower(3), test::options(20));
  test::run(world, 240);
  const ContactLoad middle = world.contactLoad(world.bodyAt(2)), ground = world.contactLoad(world.bodyAt(0));
  EXPECT_TRUE(test::near(middle.force, Vec3{0, 0, 10}, .05));  // 20 N from below, 10 N from above
  EXPECT_TRUE(test::near(ground.force, Vec3{0, 0, -30}, .1));
  EXPECT_TRUE(test::near(middle.torque, Vec3{}, .05));
  EXPECT_EQ(middle.points, 8);
  EXPECT_LT(middle.residual, 1e-3);
}

TEST(Events, ASensorReportsAndDoesNotPush) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  BodyDef gate = test::body(Shape::box({1, 1, .5}), {0, 0, 3});
  gate.motion = Motion::Static;
  gate.sensor = true;
  scene.bodies.push_back(gate);
  scene.bodies.push_back(test::unitCube({0, 0, 5}));
  World world(scene, withEvents());
  Scene plain = scene;
  plain.bodies.erase(plain.bodies.begin() + 1);
  World without(plain, withEvents());
  double begin = 0, end = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(), without.step();
    for (const ContactEvent& e : world.events().contacts) {
      if (!e.sensor) continue;
      if (e.phase == Phase::Begin) begin = world.state(world.bodyAt(2)).position.z;
      if (e.phase == Phase::End) end = world.state(world.bodyAt(2)).position.z;
    }
  }
  // it came in with its lower face at 3.5 and went out with its upper one at 2.5; a step is up to 0.13 m
  EXPECT_GT(begin, 3.87);
  EXPECT_LE(begin, 4.01);
  EXPECT_LE(end, 2.01);
  EXPECT_GT(end, 1.86);
  EXPECT_EQ(world.state(world.bodyAt(2)).position, without.state(without.bodyAt(1)).position);
}

TEST(Events, ABrokenJointIsReportedOnce) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  JointDef joint = test::ball(kWorld, {0, 0, .5}, 0, {0, 0, .5});
  joint.breakForce = 30;
  scene.joints.push_back(joint);
  World world(scene, withEvents());
  int told = 0;
  for (int i = 0; i < 60; ++i) {
    if (i == 20) world.applyForce(world.bodyAt(0), {0, 0, -100});
    world.step();
    told += static_cast<int>(world.events().joints.size());
    for (const JointEvent& e : world.events().joints) {
      EXPECT_EQ(i, 20);
      EXPECT_EQ(e.joint, world.joints()[0]);
      EXPECT_NEAR(length(e.force), 30, .1);
    }
  }
  EXPECT_EQ(told, 1);
}

TEST(Events, AreTheSameAtAnyNumberOfThreads) {
  World one(test::heap(4), withEvents(1)), many(test::heap(4), withEvents(3));
  std::size_t count = 0;
  for (int i = 0; i < 60; ++i) {
    one.step(), many.step();
    const auto &a = one.events().contacts, &b = many.events().contacts;
    ASSERT_EQ(a.size(), b.size());
    count += a.size();
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].phase, b[k].phase);
      EXPECT_EQ(a[k].a, b[k].a);
      EXPECT_EQ(a[k].b, b[k].b);
      EXPECT_EQ(a[k].impulse, b[k].impulse);
    }
    EXPECT_TRUE(std::is_sorted(a.begin(), a.end(), [](const ContactEvent& x, const ContactEvent& y) {
      return std::pair(x.a.index, x.b.index) < std::pair(y.a.index, y.b.index);
    }));
  }
  EXPECT_GT(count, 500u);
}

/// A tower whose second cube is pushed, whose top is removed, and on which another one falls.
Scene scripted() {
  Scene scene = test::tower(3);
  scene.bodies[2].name = "middle", scene.bodies[3].name = "top1";
  Event push, change;
  push.step = 4, push.setVelocity = {{"middle", {0.5, 0, 0}, {}}};
  change.step = 2, change.remove = {"top*"};
  change.add = {test::unitCube({0.1, 0, 3.2})};
  change.add[0].name = "late";
  scene.events = {push, change};
  return scene;
}

TEST(Script, RunsBeforeTheStepsOfItsEvents) {
  World world(scripted(), test::options(4)), byHand(test::tower(3), test::options(4));
  Worlds batch(test::options(4));
  batch.add(test::tower(1)), batch.add(scripted());
  for (int i = 0; i < 12; ++i) {
    if (i == 2) {
      byHand.removeBody(byHand.bodyAt(3));
      byHand.addBody(test::unitCube({0.1, 0, 3.2}));
    }
    if (i == 4) byHand.setVelocity(byHand.bodyAt(2), {0.5, 0, 0}, {});
    world.step(), byHand.step();
    EXPECT_EQ(world.hash(), byHand.hash()) << i;
  }
  batch.step(12);
  EXPECT_EQ(batch[1].state(batch[1].findBody("late")).position, world.state(world.findBody("late")).position);
}

TEST(Script, ContinuesFromSnapshotsAndSaveGames) {
  World world(scripted(), test::options(4));
  std::vector<Snapshot> snapshots;
  for (int i = 0; i < 8; ++i) snapshots.push_back(world.snapshot()), world.step();
  const std::uint64_t end = world.hash();
  World other(test::emptyScene(), test::options(4));
  for (const Snapshot& snapshot : snapshots) {
    for (World* each : {&world, &other}) {
      each->restore(each == &world ? snapshot : Snapshot::fromBytes(snapshot.bytes()));
      while (each->stepCount() < 8) each->step();
      EXPECT_EQ(each->hash(), end);
    }
  }
}

TEST(Script, ThatNamesNothingIsAnErrorOnce) {
  Scene scene = test::tower(1);
  scene.events.resize(2);
  scene.events[0].remove = {"nobody"}, scene.events[1].add = {test::unitCube({3, 0, 1})};
  World world(scene, test::options(4));
  EXPECT_THROW(world.step(), Error);
  EXPECT_EQ(world.stepCount(), 0);
  world.step();
  EXPECT_EQ(world.bodies().size(), 3u);
}

}  // namespace
}  // namespace rubble
