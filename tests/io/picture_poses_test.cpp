#include <gtest/gtest.h>

#include "io/picture_poses.h"
#include "io/recording.h"

namespace rubble::io {
namespace {

/// Boxes and hulls in the air; hulls have their center of mass elsewhere than their frame.
Scene falling() {
  Scene scene;
  for (int i = 0; i < 12; ++i) {
    BodyDef body;
    body.position = {1.5 * i, 0, 3};
    body.orientation = fromAxisAngle(normalize(Vec3{1, .2 * i, .5}), .4 * i);
    body.angularVelocity = {1, -2, .5 * i};
    if (i % 2 == 0)
      body.shape = Shape::hull({{-.4, -.4, -.4}, {.9, -.4, -.4}, {-.4, .5, -.4}, {-.4, -.4, .7}});
    scene.bodies.push_back(body);
  }
  return scene;
}

void expectSame(const std::vector<PictureBody>& found, const std::vector<PictureBody>& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].key, wanted[i].key);
    EXPECT_EQ(found[i].shape.type, wanted[i].shape.type);
    EXPECT_LT(length(found[i].position - wanted[i].position), 1e-6);
    const Quat turn = conjugate(found[i].orientation) * wanted[i].orientation;
    EXPECT_LT(length(turn.v), 1e-6);
  }
}

TEST(WatchedBodies, AreWhereALookAtEachOneSaysThatTheyAre) {
  World world(falling());
  WatchedBodies watched;
  std::vector<PictureBody> bodies;
  std::int64_t epoch = -1;
  watched.update(world, ColorBy::Body, bodies, epoch);
  const Vec3 before = bodies[0].position;
  for (int i = 0; i < 20; ++i) {
    world.step();
    watched.update(world, ColorBy::Body, bodies, epoch);
    expectSame(bodies, pictureBodies(world));
    const RecordedFrame fast = recordedFrame(world, poseSources(world)), slow = recordedFrame(world);
    ASSERT_EQ(fast.poses.size(), slow.poses.size());
    EXPECT_EQ(fast.step, slow.step);
    for (std::size_t k = 0; k < slow.poses.size(); ++k)
      EXPECT_LT(length(fast.poses[k].position - slow.poses[k].position), 1e-6);
  }
  EXPECT_GT(length(bodies[0].position - before), .3) << "they fall";
}

TEST(WatchedBodies, ComeAndGo) {
  World world(falling());
  WatchedBodies watched;
  std::vector<PictureBody> bodies, early;
  std::int64_t epoch = -1, earlyEpoch = -1;
  watched.update(world, ColorBy::Body, early, earlyEpoch);
  world.removeBody(world.bodies()[3]);
  BodyDef ball;
  ball.shape = Shape::sphere(.3);
  world.addBody(ball);
  world.step();
  watched.update(world, ColorBy::Body, bodies, epoch);
  expectSame(bodies, pictureBodies(world));
  world.step();
  // Into the list from before the change as well.
  watched.update(world, ColorBy::Body, early, earlyEpoch);
  expectSame(early, pictureBodies(world));
}

/// The first body hangs on a rope, and a sheet lies next to them. Both are drawn as further entries after
/// the bodies.
Scene fallingBesideARopeAndASheet() {
  Scene scene = falling();
  JointDef rope;
  rope.type = JointType::Rope;
  rope.bodyA = 0, rope.bodyB = kWorld;
  rope.anchorB = {0, 0, 6};
  rope.length = 4;
  scene.joints.push_back(rope);
  scene.deformables.push_back(clothSheet({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, 4, 4));
  return scene;
}

TEST(WatchedBodies, LoseTheTubeOfARopeThatIsRemoved) {
  Scene scene = fallingBesideARopeAndASheet();
  scene.deformables.clear();
  World world(scene);
  WatchedBodies watched;
  std::vector<PictureBody> bodies;
  std::int64_t epoch = -1;
  watched.update(world, ColorBy::Body, bodies, epoch);
  ASSERT_EQ(bodies.size(), world.bodies().size() + 1);
  world.removeJoint(world.joints()[0]);
  for (int i = 0; i < 3; ++i) {
    world.step();
    watched.update(world, ColorBy::Body, bodies, epoch);
    expectSame(bodies, pictureBodies(world));
  }
}

TEST(WatchedBodies, LoseASheetThatIsRemovedAndFindARopeThatIsAdded) {
  World world(fallingBesideARopeAndASheet());
  const JointDef rope = world.definition(world.joints()[0]);
  world.removeJoint(world.joints()[0]);
  WatchedBodies watched;
  std::vector<PictureBody> bodies;
  std::int64_t epoch = -1;
  watched.update(world, ColorBy::Body, bodies, epoch);
  ASSERT_EQ(bodies.size(), world.bodies().size() + 1);
  world.removeDeformable(world.deformables()[0]);
  for (int i = 0; i < 4; ++i) {
    if (i == 2) world.addJoint(rope, world.bodies()[0], {});
    world.step();
    watched.update(world, ColorBy::Body, bodies, epoch);
    expectSame(bodies, pictureBodies(world));
  }
}

TEST(WatchedBodies, HaveTheirValuesAndTheVerticesOfDeformables) {
  Scene scene = falling();
  scene.deformables.push_back(clothSheet({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, 4, 4));
  World world(scene);
  WatchedBodies watched;
  std::vector<PictureBody> bodies;
  std::int64_t epoch = -1;
  for (int i = 0; i < 3; ++i) {
    world.step();
    watched.update(world, i == 2 ? ColorBy::Speed : ColorBy::Body, bodies, epoch);
    const std::vector<PictureBody> wanted = pictureBodies(world, ColorBy::Speed);
    expectSame(bodies, wanted);
    EXPECT_EQ(bodies.back().shape.geometry->points, wanted.back().shape.geometry->points);
    if (i == 2) {
      EXPECT_EQ(bodies.front().value, wanted.front().value);
    }
  }
}

}  // namespace
}  // namespace rubble::io
