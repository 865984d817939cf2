#include <cmath>

#include <gtest/gtest.h>

#include "apps/viewer/dragger.h"
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

/// A block of 1 m on a plane, and a cloth that hangs by a side, z up.
OpenedScene blockOnGround(const Request&, int side) {
  OpenedScene opened;
  BodyDef ground;
  ground.motion = Motion::Static;
  ground.shape = Shape::plane();
  BodyDef block;
  block.name = "block";
  block.position = {0, 0, .5};
  opened.job.scene.bodies = {ground, block};
  ClothDef cloth = clothSheet({3, 0, 4}, {1, 0, 0}, {0, 0, -1}, 4, 4);
  cloth.fixed = {0, 1, 2, 3, 4};
  opened.job.scene.deformables = {cloth};
  opened.world.threads = 1;
  opened.world.params.iterations = side == 0 ? 4 : 8;
  return opened;
}

/// The same with a block that appears at step 20.
OpenedScene withAnEvent(const Request& request, int side) {
  OpenedScene opened = blockOnGround(request, side);
  Event event;
  event.step = 20;
  event.add = {opened.job.scene.bodies[1]};
  event.add[0].name = "late";
  event.add[0].position = {-3, 0, 2};
  opened.job.scene.events = {event};
  return opened;
}

const Request kBlock{"block", {}, ""};

TEST(Dragger, AHeldBodyFollowsTheMouse) {
  Player player(blockOnGround, kBlock);
  Dragger dragger;
  const BodyId block = player.world().findBody("block");
  ASSERT_TRUE(dragger.take(player, block, {0, 0, 1}));
  dragger.pull(player, {0, 0, 3});
  for (int i = 0; i < 240; ++i) player.step();
  // The grip is a spring of 3 Hz: the weight stretches it by g / (2 pi 3)^2 = 28 mm.
  EXPECT_NEAR(player.world().state(block).position.z, 2.5 - .028, .1);
  dragger.release(player);
  EXPECT_TRUE(player.world().joints().empty());
  for (int i = 0; i < 120; ++i) player.step();
  EXPECT_LT(player.world().state(block).position.z, .8);
}

TEST(Dragger, AHeldBodyFollowsAMouseThatMoves) {
  Player player(blockOnGround, kBlock);
  Dragger dragger;
  for (int i = 0; i < 60; ++i) player.step();
  const BodyId block = player.world().findBody("block");
  ASSERT_TRUE(dragger.take(player, block, {0, -.5, .7}));
  for (int i = 0; i < 120; ++i) {
    dragger.pull(player, {0, -.5, .7 + .01 * i});
    player.step();
  }
  EXPECT_GT(player.world().state(block).position.z, 1.2);
}

TEST(Dragger, AHeldVertexFollowsTheMouse) {
  Player player(blockOnGround, kBlock);
  Dragger dragger;
  const DeformableId cloth = player.world().deformables().front();
  const int corner = 24;
  const Vec3 before = player.world().positions(cloth)[24];
  ASSERT_TRUE(dragger.take(player, cloth, corner));
  for (int i = 0; i < 60; ++i) {
    dragger.pull(player, before + Vec3{0, .01 * i, 0});
    player.step();
  }
  EXPECT_GT(player.world().positions(cloth)[24].y, .3);
  dragger.release(player);
  EXPECT_TRUE(player.world().attachments().empty());
  EXPECT_EQ(player.world().bodies().size(), 2u) << "the grip is gone";
}

TEST(Dragger, WhatDoesNotMoveIsNotHeld) {
  Player player(blockOnGround, kBlock);
  Dragger dragger;
  EXPECT_FALSE(dragger.take(player, player.world().bodyAt(0), {0, 0, 0}));
  EXPECT_FALSE(dragger.take(player, player.world().deformables().front(), 0)) << "a fixed vertex";
  EXPECT_FALSE(dragger.holds());
}

TEST(Dragger, AShotFliesWhereItWasAimed) {
  Player player(blockOnGround, kBlock);
  const BodyId ball = shoot(player, {0, -20, 5}, {0, 1, 0}, .5),
               second = shoot(player, {5, -20, 5}, {0, 1, 0}, .5);
  player.step();
  EXPECT_GT(player.world().state(ball).position.y, -20 + .3);
  EXPECT_NEAR(player.world().state(ball).position.x, 0, 1e-6);
  EXPECT_NE(player.world().definition(ball).name, player.world().definition(second).name);
}

TEST(Dragger, ABoxIsDroppedOntoAPoint) {
  Player player(blockOnGround, kBlock);
  const BodyId box = dropBox(player, {-4, 0, 0}, .25);
  for (int i = 0; i < 120; ++i) player.step();
  EXPECT_NEAR(player.world().state(box).position.z, .25, .01);
  EXPECT_NEAR(player.world().state(box).position.x, -4, .01);
}

TEST(Player, PausedItStandsStillAndDoesNotCatchUp) {
  Player player(blockOnGround, kBlock);
  player.paused = true;
  player.play(10);
  EXPECT_EQ(player.now(), 0);
  player.paused = false;
  player.play(10);
  EXPECT_EQ(player.now(), 4) << "at most a few steps a frame";
  player.play(player.dt() / 2);
  player.play(player.dt());
  EXPECT_LE(player.now(), 6);
}

TEST(Player, EveryStepIsFoundAgainBitForBit) {
  Player player(withAnEvent, kBlock);
  Dragger dragger;
  std::vector<std::uint64_t> hashes{player.world().hash()};
  const BodyId block = player.world().findBody("block");
  for (int i = 0; i < 60; ++i) {
    // The hand pulls on the way: what it did is done again.
    if (i == 12) dragger.take(player, block, {0, 0, 1});
    if (dragger.holds()) dragger.pull(player, {0, 0, 1 + .05 * (i - 12)});
    if (i == 33) dragger.release(player);
    if (i == 41) shoot(player, {0, -20, 1}, {0, 1, 0}, .5);
    player.step();
    hashes.push_back(player.world().hash());
  }
  for (const int step : {59, 13, 12, 47, 20, 21, 60, 34, 1, 60}) {
    player.seek(step);
    EXPECT_EQ(player.now(), step);
    EXPECT_EQ(player.world().hash(), hashes[static_cast<std::size_t>(step)]) << "step " << step;
  }
  EXPECT_EQ(player.history().branches().size(), 1u) << "looking back changes nothing";
}

TEST(Player, AnInputAtAnEarlierStepBeginsABranch) {
  Player player(blockOnGround, kBlock);
  for (int i = 0; i < 40; ++i) player.step();
  const std::uint64_t first = player.world().hash();
  player.seek(17);
  shoot(player, {0, -6, .5}, {0, 1, 0}, .5);
  ASSERT_EQ(player.history().branches().size(), 2u);
  EXPECT_EQ(player.history().branch().begins, 17);
  for (int i = 0; i < 23; ++i) player.step();
  const std::uint64_t second = player.world().hash();
  EXPECT_NE(second, first);
  player.choose(0);
  EXPECT_EQ(player.now(), 40);
  EXPECT_EQ(player.world().hash(), first);
  EXPECT_EQ(player.world().bodies().size(), 2u);
  player.choose(1);
  EXPECT_EQ(player.world().hash(), second);
  EXPECT_EQ(player.world().bodies().size(), 3u);
}

TEST(Player, ParametersAreChangedWhileItRuns) {
  Player player(blockOnGround, kBlock);
  for (int i = 0; i < 10; ++i) player.step();
  player.changeParams("iterations", [](Params& params) { params.iterations = 9; });
  player.step();
  EXPECT_EQ(player.world().params().iterations, 9);
  player.seek(5);
  EXPECT_EQ(player.world().params().iterations, 4);
  player.seek(11);
  EXPECT_EQ(player.world().params().iterations, 9);
}

TEST(Player, TwoSidesTakeTheSameSteps) {
  Player player(blockOnGround, kBlock, 2);
  shoot(player, {0, -6, .5}, {0, 1, 0}, .5);
  for (int i = 0; i < 30; ++i) player.step();
  EXPECT_EQ(player.world(0).stepCount(), player.world(1).stepCount());
  EXPECT_EQ(player.world(1).bodies().size(), 3u);
  EXPECT_EQ(player.world(1).params().iterations, 8);
  EXPECT_NE(player.world(0).hash(), player.world(1).hash());
}

TEST(Player, MeasuringIterationsLeavesTheWorldAsItWas) {
  Player player(blockOnGround, kBlock);
  for (int i = 0; i < 20; ++i) player.step();
  const std::uint64_t before = player.world().hash();
  const std::vector<IterationError> errors = iterationErrors(player.world());
  EXPECT_EQ(player.world().hash(), before);
  ASSERT_EQ(errors.size(), 4u);
  EXPECT_GT(errors[1].change, 0);
  EXPECT_LT(errors[3].change, errors[1].change) << "iterations converge";
}

}  // namespace
}  // namespace rubble::viewer
