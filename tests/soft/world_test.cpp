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

TEST(SoftChange, ToItsOwnDefinitionKeepsEveryBit) {
  for (const char* backend : {"cpu", "reference"}) {
    World world(medley(), options(4, backend));
    run(world, 30);
    const Snapshot start = world.snapshot();
    run(world, 10);
    const std::uint64_t untouched = world.hash();
    world.restore(start);
    for (const DeformableId id : world.deformables()) {
      const Deformable same = world.definition(id);
      world.setDefinition(id, same);
    }
    run(world, 10);
    EXPECT_EQ(world.hash(), untouched) << backend;
  }
}

TEST(SoftChange, OfStiffnessMovesABeamToItsNewSag) {
  // the deflection is that of a beam which had the new stiffness from the start
  const auto sag = [](double before, double after) {
    TetSolidDef beam = clampedBeam(4, 1, before);
    beam.viscosity = 1e6;
    World world(sceneWith(beam), options(10));
    run(world, 40);
    if (after != before) {
      const std::vector<Vec3> at = world.positions(world.deformables()[0]);
      beam.youngsModulus = after;
      world.setDefinition(world.deformables()[0], beam);
      EXPECT_EQ(world.positions(world.deformables()[0]), at);
    }
    run(world, 80);
    double low = 1;
    for (const Vec3& v : world.positions(world.deformables()[0])) low = std::min(low, v.z);
    return low;
  };
  const double soft = sag(5e6, 5e6), stiff = sag(2e7, 2e7);
  EXPECT_LT(soft, 2.5 * stiff);
  EXPECT_NEAR(sag(2e7, 5e6), soft, 0.05 * std::fabs(soft));
  EXPECT_NEAR(sag(5e6, 2e7), stiff, 0.05 * std::fabs(soft));
}

TEST(SoftChange, KeepsTearsVelocitiesAndPlasticStrain) {
  Scene scene = medley();
  World world(scene, options(4));
  run(world, 20);
  for (const DeformableId id : world.deformables()) {
    const std::vector<Vec3> x = world.positions(id), v = world.velocities(id);
    Deformable def = world.definition(id);
    common(def).material.dynamicFriction = 0.1, common(def).gravityScale = 0.5;
    common(def).collideSurface = !common(def).collideSurface;
    common(def).userData = 5;
    world.setDefinition(id, def);
    EXPECT_EQ(world.positions(id), x);
    EXPECT_EQ(world.velocities(id), v);
    EXPECT_EQ(world.userData(id), 5u);
  }
  run(world, 20);
  // a torn sheet stays torn, and a sheet can be let go
  World torn(sceneWith([] {
               ClothDef sheet = clothSheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 4);
               for (int i = 0; i < 5; ++i) sheet.fixed.push_back(i), sheet.fixed.push_back(20 + i);
               sheet.tearStretch = 1.3, sheet.youngsModulus = 1e5;
               return sheet;
             }()),
             options(6));
  const DeformableId id = torn.deformables()[0];
  std::vector<Vec3> pulled = torn.positions(id);
  for (std::size_t i = 20; i < 25; ++i) pulled[i].y += 1;
  torn.setVertices(id, pulled, std::vector<Vec3>(pulled.size()));
  run(torn, 30);
  const std::size_t left = torn.surface(id).triangles.size();
  ASSERT_LT(left, 32u);
  ClothDef loose = std::get<ClothDef>(torn.definition(id));
  loose.fixed.clear(), loose.tearStretch = kUnbreakable;
  torn.setDefinition(id, loose);
  run(torn, 60);
  EXPECT_EQ(torn.surface(id).triangles.size(), left);
  for (const Vec3& v : torn.velocities(id)) EXPECT_LT(v.z, -8);
}

TEST(SoftChange, OfFixedVerticesStopsThem) {
  World world(sceneWith(clothSheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 4)), options(4));
  const DeformableId id = world.deformables()[0];
  run(world, 20);
  ClothDef held = std::get<ClothDef>(world.definition(id));
  for (int i = 0; i < 25; ++i) held.fixed.push_back(i);
  const std::vector<Vec3> at = world.positions(id);
  world.setDefinition(id, held);
  run(world, 10);
  EXPECT_EQ(world.positions(id), at);
}

TEST(SoftChange, RefusesAnotherKindNameOrNumberOfVertices) {
  World world(medley(), options(4));
  const DeformableId cloth = world.deformables()[1];
  const std::uint64_t before = world.hash();
  EXPECT_THROW(world.setDefinition(cloth, world.definition(world.deformables()[2])), Error);
  EXPECT_THROW(world.setDefinition(cloth, clothSheet({}, {1, 0, 0}, {0, 1, 0}, 3, 3)), Error);
  Deformable other = world.definition(cloth);
  common(other).name = "other";
  EXPECT_THROW(world.setDefinition(cloth, other), Error);
  EXPECT_EQ(world.hash(), before);
}

}  // namespace
}  // namespace rubble
