#include <cmath>

#include <gtest/gtest.h>

#include "apps/viewer/fuzzy.h"
#include "apps/viewer/orbit.h"
#include "apps/viewer/player.h"

namespace rubble::viewer {
namespace {

TEST(Fuzzy, LettersMustComeInOrder) {
  EXPECT_GE(fuzzyScore("p1k", "pile-1k"), 0);
  EXPECT_GE(fuzzyScore("PILE", "pile-1k"), 0);
  EXPECT_EQ(fuzzyScore("k1", "pile-1k"), -1);
  EXPECT_EQ(fuzzyScore("pilex", "pile-1k"), -1);
  EXPECT_EQ(fuzzyScore("", "pile-1k"), 0);
}

TEST(Fuzzy, WordsAndRunsComeFirst) {
  EXPECT_GT(fuzzyScore("tow", "tower"), fuzzyScore("tow", "t-o-w"));
  const std::vector<std::string> texts{"many-pyramids", "pyramid", "pile-removal", "pile-1k"};
  EXPECT_EQ(fuzzySearch("pyr", texts).front(), 1u);
  EXPECT_EQ(fuzzySearch("pr", texts).front(), 2u) << "both letters begin a word";
  EXPECT_EQ(fuzzySearch("", texts).size(), 4u);
  EXPECT_TRUE(fuzzySearch("zz", texts).empty());
}

render::Camera camera() { return {{0, -10, 0}, {0, 0, 0}, {0, 0, 1}, 2 * std::atan(.5)}; }

TEST(Orbit, TurningKeepsTheDistanceAndTheTarget) {
  Orbit orbit(camera());
  orbit.turn(.3, -.2);
  const render::Camera turned = orbit.camera();
  EXPECT_NEAR(length(turned.eye - turned.target), 10, 1e-12);
  EXPECT_EQ(turned.target, (Vec3{0, 0, 0}));
  for (int i = 0; i < 50; ++i) orbit.turn(0, 1);
  EXPECT_LT(length(cross(normalize(orbit.camera().eye), Vec3{0, 0, 1})), .03) << "it ends near the pole";
  EXPECT_GT(length(cross(normalize(orbit.camera().eye), Vec3{0, 0, 1})), .01) << "and never on it";
}

TEST(Orbit, WhatIsPannedStaysUnderTheMouse) {
  // A tenth of the height at the target is 1 m.
  Orbit orbit(camera());
  const Vec3 before = orbit.ray(.5, .5, 2);
  orbit.pan(.1, .05);
  const render::Camera panned = orbit.camera();
  const Vec3 ray = orbit.ray(.5 + .1 / 2, .5 - .05, 2);
  const Vec3 there = panned.eye + ray * (10 / ray.y);
  EXPECT_NEAR(length(there), 0, 1e-9);
  EXPECT_NEAR(before.y, 1, 1e-12);
}

TEST(Orbit, ZoomGoesNearer) {
  Orbit orbit(camera());
  orbit.zoom(2);
  EXPECT_NEAR(length(orbit.camera().eye), 5, 1e-12);
}

/// A block of 1 m on a plane, z up.
Opened blockOnGround(const std::string&) {
  Opened opened;
  BodyDef ground;
  ground.motion = Motion::Static;
  ground.shape = Shape::plane();
  BodyDef block;
  block.name = "block";
  block.position = {0, 0, .5};
  opened.job.scene.bodies = {ground, block};
  opened.world.threads = 1;
  return opened;
}

TEST(Player, AHeldBodyFollowsTheMouse) {
  Player player(blockOnGround);
  player.open("block");
  const BodyId block = player.world().find("block");
  ASSERT_TRUE(player.grab(block, {0, 0, 1}));
  player.pull({0, 0, 3});
  for (int i = 0; i < 240; ++i) player.step();
  // The grip is a spring of 3 Hz: the weight stretches it by g / (2 pi 3)^2 = 28 mm.
  const BodyState lifted = player.world().state(block);
  EXPECT_NEAR(lifted.position.z, 2.5 - .028, .1);
  player.release();
  EXPECT_TRUE(player.world().joints().empty());
  for (int i = 0; i < 120; ++i) player.step();
  EXPECT_LT(player.world().state(block).position.z, .8);
}

TEST(Player, AHeldBodyFollowsAMouseThatMoves) {
  Player player(blockOnGround);
  player.open("block");
  for (int i = 0; i < 120; ++i) player.step();
  const BodyId block = player.world().find("block");
  ASSERT_TRUE(player.grab(block, {0, -.5, .7}));
  for (int i = 0; i < 120; ++i) {
    player.pull({0, -.5, .7 + .01 * i});
    player.step();
  }
  EXPECT_GT(player.world().state(block).position.z, 1.2);
}

TEST(Player, WhatDoesNotMoveIsNotHeld) {
  Player player(blockOnGround);
  player.open("block");
  EXPECT_FALSE(player.grab(player.world().bodyAt(0), {0, 0, 0}));
  EXPECT_FALSE(player.held());
}

TEST(Player, PausedItStandsStillAndDoesNotCatchUp) {
  Player player(blockOnGround);
  player.open("block");
  player.paused = true;
  player.play(10);
  EXPECT_EQ(player.world().stepCount(), 0);
  player.paused = false;
  player.play(10);
  EXPECT_EQ(player.world().stepCount(), 4) << "at most a few steps a frame";
  player.play(player.world().params().dt / 2);
  player.play(player.world().params().dt);
  EXPECT_LE(player.world().stepCount(), 6);
  player.restart();
  EXPECT_EQ(player.world().stepCount(), 0);
}

TEST(Player, AShotFliesWhereItWasAimed) {
  Player player(blockOnGround);
  player.open("block");
  const BodyId ball = player.shoot({0, -20, 5}, {0, 1, 0}, .5);
  player.step();
  const BodyState state = player.world().state(ball);
  EXPECT_GT(state.position.y, -20 + .3);
  EXPECT_NEAR(state.position.x, 0, 1e-6);
  EXPECT_EQ(player.world().definition(ball).name, "shot");
}

}  // namespace
}  // namespace rubble::viewer
