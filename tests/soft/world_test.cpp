/// Deformable objects as part of a world: ids, edits, snapshots, determinism, errors.
#include <gtest/gtest.h>

#include "tests/soft/soft_scenes.h"
#include "tests/support/many_threads.h"

namespace rubble {
namespace {

using namespace test;

/// Something of everything.
Scene medley() {
  Scene scene = emptyScene();
  scene.bodies.push_back(ground());
  for (int i = 0; i < 4; ++i) scene.bodies.push_back(unitCube({.3 * i, 0, 2.5 + 1.1 * i}));
  scene.deformables.push_back(jellyBox({0, 0, .2}, .6, 3));
  ClothDef cloth = clothSheet({-1, -1, 1.5}, {2, 0, 0}, {0, 2, 0}, 10, 10);
  cloth.fixed = {0, 10, 110, 120};
  scene.deformables.push_back(cloth);
  CableDef rope = straightCable({2, 0, 2}, {3, 0, 2}, 8);
  rope.fixed = {0};
  scene.deformables.push_back(rope);
  ParticlesDef sand;
  sand.radius = .05;
  for (int i = 0; i < 60; ++i)
    sand.vertices.push_back({-2 + .11 * (i % 4), .11 * (i / 4 % 4), .1 + .11 * (i / 16)});
  scene.deformables.push_back(sand);
  AttachmentDef hook;
  hook.object = 2, hook.vertices = {8}, hook.body = 4;
  scene.attachments.push_back(hook);
  return scene;
}

TEST(SoftWorld, GivesTheSameBitsAtAnyNumberOfThreads) {
  const test::ManyThreads manyThreads(4);
  World one(medley(), options(4)), three(medley(), options(4, "cpu", 3));
  run(one, 60), run(three, 60);
  EXPECT_EQ(one.hash(), three.hash());
}

TEST(SoftWorld, LockstepFindsNoDifference) {
  const test::ManyThreads manyThreads(4);
  World world(medley(), options(4, "lockstep", 3));
  run(world, 40);
  EXPECT_EQ(world.firstDifference(), "");
}

TEST(SoftWorld, SinglePrecisionStaysWithDouble) {
  World single(medley(), options(10)), reference(medley(), options(10, "reference"));
  run(single, 20), run(reference, 20);
  for (const DeformableId id : single.deformables()) {
    const std::vector<Vec3> a = single.positions(id), b = reference.positions(id);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT(length(a[i] - b[i]), 5e-3) << id.index << " " << i;
  }
}

TEST(SoftWorld, SnapshotGoesOnBitForBit) {
  World world(medley(), options(4));
  run(world, 30);
  const Snapshot snapshot = world.snapshot();
  run(world, 30);
  const std::uint64_t hash = world.hash();
  world.restore(snapshot);
  run(world, 30);
  EXPECT_EQ(world.hash(), hash);
}

TEST(SoftWorld, RemovingAnObjectLeavesTheOthersAsTheyAre) {
  World world(medley(), options(4));
  run(world, 30);
  const std::vector<DeformableId> ids = world.deformables();
  const std::vector<Vec3> sand = world.positions(ids[3]), ropeSpeed = world.velocities(ids[2]);
  world.removeDeformable(ids[1]);
  EXPECT_FALSE(world.alive(ids[1]));
  EXPECT_THROW(world.positions(ids[1]), Error);
  EXPECT_EQ(world.positions(ids[3]), sand);
  EXPECT_EQ(world.velocities(ids[2]), ropeSpeed);
  EXPECT_EQ(world.attachments().size(), 1u);
  run(world, 30);
  // the sand lies still whatever else goes
  for (std::size_t i = 0; i < sand.size(); ++i) EXPECT_LT(length(world.positions(ids[3])[i] - sand[i]), .2);
  const DeformableId fresh = world.addDeformable(jellyBox({4, 0, 1}, .3, 2));
  EXPECT_NE(fresh, ids[1]);
  run(world, 10);
  EXPECT_LT(momentumOf(world, fresh).center.z, 1.15);
}

TEST(SoftWorld, RemovingABodyTakesItsAttachmentsWithIt) {
  World world(medley(), options(4));
  run(world, 10);
  world.removeBody(world.bodyAt(4));
  EXPECT_TRUE(world.attachments().empty());
  run(world, 10);
}

TEST(SoftWorld, AWorldWithoutDeformableObjectsStepsAsBefore) {
  World plain(tower(5), options(4));
  World edited(tower(5), options(4));
  const DeformableId id = edited.addDeformable(jellyBox({5, 5, 5}, .3, 2));
  edited.removeDeformable(id);
  run(plain, 20), run(edited, 20);
  for (int i = 1; i <= 5; ++i)
    EXPECT_EQ(plain.state(plain.bodyAt(i)).position, edited.state(edited.bodyAt(i)).position);
}

template <class Change> std::string errorOf(Change&& change) {
  TetSolidDef box = jellyBox({0, 0, 0}, 1, 1);
  change(box);
  try {
    World world(sceneWith(box));
  } catch (const Error& e) {
    return e.path();
  }
  return "";
}

TEST(SoftWorld, BadInputIsNamed) {
  EXPECT_EQ(errorOf([](TetSolidDef&) {}), "");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { d.poissonRatio = .5; }), "deformables[0].poissonRatio");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { d.density = 0; }), "deformables[0].density");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { d.yieldStress = 0; }), "deformables[0].yieldStress");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { d.hardening = -1; }), "deformables[0].hardening");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { d.hardening = kUnbreakable; }), "deformables[0].hardening");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { std::swap(d.tetrahedra[2][0], d.tetrahedra[2][1]); }),
            "deformables[0].tetrahedra[2]");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { d.tetrahedra[1][3] = 99; }), "deformables[0].tetrahedra[1]");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { d.vertices.push_back({3, 3, 3}); }), "deformables[0].vertices[8]");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { d.fixed = {-1}; }), "deformables[0].fixed[0]");
  EXPECT_EQ(errorOf([](TetSolidDef& d) { d.start = {{0, 0, 0}}; }), "deformables[0].start");
  ClothDef cloth = clothSheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1, 1);
  cloth.vertices.push_back({2, 2, 2});
  cloth.triangles.push_back({0, 3, 4}), cloth.triangles.push_back({0, 3, 1});
  EXPECT_THROW(World{sceneWith(cloth)}, Error);
}

TEST(SoftWorld, KeepsBodiesAwakeThatLieOnCloth) {
  ClothDef sheet = clothSheet({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, 8, 8);
  for (int k = 0; k <= 8; ++k) sheet.fixed.insert(sheet.fixed.end(), {k, 72 + k});
  Scene scene = sceneWith(sheet);
  scene.bodies.push_back(ground());
  scene.bodies.push_back(body(Shape::sphere(.3), {0, 0, 1.4}));
  scene.bodies.push_back(body(Shape::box({.3, .3, .3}), {5, 0, .3}));
  WorldOptions slept = options(4);
  slept.params.sleeping = true;
  World world(scene, slept);
  run(world, 120);
  EXPECT_FALSE(world.asleep(world.bodies()[1]));
  EXPECT_TRUE(world.asleep(world.bodies()[2]));
}

TEST(SoftWorld, LetsVerticesThroughSensors) {
  ParticlesDef particles;
  particles.vertices = {{0, 0, 1}};
  particles.radius = .05;
  Scene scene = sceneWith(particles);
  BodyDef sensor = body(Shape::box({1, 1, .1}), {0, 0, .5});
  sensor.motion = Motion::Static;
  sensor.sensor = true;
  scene.bodies.push_back(sensor);
  World world(scene, options(4));
  run(world, 60);
  EXPECT_LT(world.positions(world.deformables()[0])[0].z, 0);
}

}  // namespace
}  // namespace rubble
