/// Lines over pictures.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/render/look.h"

namespace rubble::render {
namespace {

WorldOptions quietOn(const char* backend) {
  WorldOptions options;
  options.backend = backend, options.threads = 1, options.timings = false;
  return options;
}

World cubeOnGround(int steps) {
  Scene scene;
  BodyDef cube, ground;
  cube.position = {0, 0, .5};
  ground.motion = Motion::Static;
  ground.shape = Shape::plane();
  scene.bodies = {ground, cube};
  World world(scene, quietOn("cpu"));
  for (int i = 0; i < steps; ++i) world.step();
  return world;
}

Overlays only(const char* name) { return overlaysNamed({name}); }

TEST(Overlay, ContactsAreDotsWithNormals) {
  const std::vector<Line> lines = overlayLines(cubeOnGround(10), only("contacts"), .5);
  ASSERT_EQ(lines.size(), 8u) << "four points";
  for (const Line& line : lines) EXPECT_NEAR(line.a.z, 0, 1e-3);
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(), [](const Line& line) { return line.a == line.b; }), 4);
}

TEST(Overlay, TheLongestForceHasItsLength) {
  const World world = cubeOnGround(30);
  const std::vector<Line> lines = overlayLines(world, only("forces"), .5);
  double longest = 0;
  for (const Line& line : lines) longest = std::max(longest, length(line.b - line.a));
  EXPECT_NEAR(longest, kLongestForce * .5, 1e-6);
}

TEST(Overlay, FramesOfJointsTurnWithTheirBodies) {
  Scene scene;
  scene.gravity = {};
  BodyDef a, b;
  b.position = {3, 0, 0};
  a.orientation = b.orientation = fromAxisAngle(Vec3{0, 0, 1}, .7);
  scene.bodies = {a, b};
  scene.joints = {jointAt(scene, JointType::Hinge, 0, 1, {1.5, 0, 0}, frameAlong({0, 1, 0}))};
  const World world(scene, quietOn("cpu"));
  for (const int side : {0, 1}) {
    const Frame frame = jointFrame(world, world.joints()[0], side);
    EXPECT_NEAR(length(frame.position - Vec3{1.5, 0, 0}), 0, 1e-6);
    EXPECT_NEAR(length(rotate(frame.orientation, Vec3{1, 0, 0}) - Vec3{0, 1, 0}), 0, 1e-6);
  }
  EXPECT_EQ(overlayLines(world, only("joints"), .5).size(), 9u)
      << "two frames, the gap, and two lines to the bodies";
}

TEST(Overlay, BoundsHoldTheirBody) {
  Scene scene;
  BodyDef cube;
  cube.orientation = fromAxisAngle(Vec3{0, 0, 1}, .785398163397448);
  scene.bodies = {cube};
  const std::vector<Line> lines = overlayLines(World(scene, quietOn("cpu")), only("bounds"), .5);
  ASSERT_EQ(lines.size(), 12u);
  double reach = 0;
  for (const Line& line : lines) reach = std::max(reach, line.a.x);
  EXPECT_NEAR(reach, std::sqrt(.5), 1e-6);
}

TEST(Overlay, UnknownOnesAreRefused) { EXPECT_THROW(overlaysNamed({"thoughts"}), Error); }

/// Redness of the middle of a picture of a line before (y < 0) or behind a wall.
double rednessWithLineAt(double y) {
  softwareContext();
  const std::vector<io::PictureBody> wall{bodyOf(Shape::box({3, .2, 3}))};
  const Camera camera{{0, -10, 0}, {0, 0, 0}, {0, 0, 1}, .4};
  Stage stage(wall, {0, 0, -9.81}, camera, 64, 64);
  const std::vector<Line> lines{{{-2, y, 0}, {2, y, 0}, 0xff0000, 6}};
  stage.renderer().setLines(lines);
  const io::Image image = stage.picture(camera, {});
  return channel(image, 32, 32, 0) - channel(image, 32, 32, 2);
}

TEST(Lines, AreFainterBehindBodies) {
  const double before = rednessWithLineAt(-1), behind = rednessWithLineAt(1);
  EXPECT_GT(before, 230);
  EXPECT_GT(behind, 25);
  EXPECT_LT(behind, .5 * before);
}

TEST(Lines, BehindTheEyeAreNotDrawn) {
  EXPECT_NEAR(rednessWithLineAt(-15), rednessWithLineAt(-30), 1) << "neither is seen";
  EXPECT_LT(rednessWithLineAt(-15), 60);
}

TEST(Stage, FollowsAWorldAsItIsDrawnBodyByBody) {
  softwareContext();
  World world = cubeOnGround(0);
  const Camera camera{{4, -8, 3}, {0, 0, .5}, {0, 0, 1}, .4};
  Stage slow(io::pictureBodies(world), world.gravity(), camera, 96, 64),
      fast(io::pictureBodies(world), world.gravity(), camera, 96, 64);
  fast.follow(world);
  BodyState state = world.state(world.bodies()[1]);
  state.position = {.4, .2, 1.1};
  state.orientation = fromAxisAngle(normalize(Vec3{1, 2, 3}), .8);
  world.setState(world.bodies()[1], state);
  fast.follow(world);
  EXPECT_EQ(fast.posesFrom(), "from the host's arrays");
  slow.setBodies(io::pictureBodies(world));
  EXPECT_EQ(likeness(slow.picture(camera, {}), fast.picture(camera, {})).largest, 0);
  // Another body: looked at one by one again.
  BodyDef ball;
  ball.shape = Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  ball.position = {-1.5, 0, .3};
  world.addBody(ball);
  fast.follow(world);
  slow.setBodies(io::pictureBodies(world));
  EXPECT_EQ(likeness(slow.picture(camera, {}), fast.picture(camera, {})).largest, 0);
  // Its frame is not that of the engine, which is about the center of mass.
  state.position = {-1.2, .3, .9};
  world.setState(world.bodies()[2], state);
  fast.follow(world);
  EXPECT_EQ(fast.posesFrom(), "from the host's arrays");
  slow.setBodies(io::pictureBodies(world));
  EXPECT_LT(likeness(slow.picture(camera, {}), fast.picture(camera, {})).largest, 3);
}

TEST(Surfaces, AreColoredByTheValuesOfTheirVertices) {
  softwareContext();
  // A sheet in the picture's plane, at rest on the left and hot on the right.
  io::PictureBody sheet = bodyOf(
      Shape::mesh({{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}}, {{0, 1, 2}, {0, 2, 3}}, true));
  sheet.deforms = true;
  sheet.key = io::kSoftKeys;
  sheet.vertexValues = {0, 1, 1, 0};
  sheet.value = 1;
  const std::vector<io::PictureBody> bodies{sheet};
  const Camera camera{{0, -10, 0}, {0, 0, 0}, {0, 0, 1}, .3};
  Stage stage(bodies, {0, 0, -9.81}, camera, 64, 64);
  stage.setBodies(bodies, io::ColorBy::Strain);
  EXPECT_EQ(stage.fullValue(), 1);
  const io::Image image = stage.picture(camera, {});
  EXPECT_GT(channel(image, 56, 32, 0), channel(image, 56, 32, 2) + 60) << "hot is red";
  EXPECT_GT(channel(image, 8, 32, 2), channel(image, 8, 32, 0)) << "cold is blue";
}

}  // namespace
}  // namespace rubble::render
