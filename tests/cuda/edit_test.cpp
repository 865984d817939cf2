// Edits and reads between steps, through the tables of the host.
#include "tests/cuda/cuda_scenes.h"

namespace rubble::test {
namespace {

class CudaEdit : public CudaTest {};

TEST_F(CudaEdit, AddsAndRemovesAsTheCpuDoes) {
  World cpu(brickPile(4, 4), optionsFor("cpu")), cuda(brickPile(4, 4), optionsFor("cuda"));
  for (World* world : {&cpu, &cuda}) {
    run(*world, 10);
    // a corner of the top layer goes, and its slot is used for another body elsewhere
    world->removeBody(world->bodies().back());
    run(*world, 5);
    world->addBody(boxAt({20, 0, .5}));
    world->addBody(boxAt({20, 0, 1.5}));
    run(*world, 15);
  }
  EXPECT_EQ(cpu.bodies(), cuda.bodies());
  EXPECT_LT(distance(cpu, cuda), 1e-3);
}

TEST_F(CudaEdit, ForgetsTheContactsOfARemovedBody) {
  Scene scene = plane();
  scene.bodies.push_back(boxAt({0, 0, .5}));
  scene.bodies.push_back(boxAt({0, 0, 1.5}));
  World world(scene, optionsFor("cuda"));
  run(world, 5);
  EXPECT_FALSE(world.contacts().empty());
  world.removeBody(world.bodyAt(2));
  world.removeBody(world.bodyAt(1));
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_EQ(world.step().contacts, 0);
}

TEST_F(CudaEdit, ReadsBackWhatWasWritten) {
  World world(brickPile(3, 3), optionsFor("cuda"));
  run(world, 3);
  const BodyId id = world.bodies()[5];
  BodyState wanted = world.state(id);
  wanted.position = {30, 2, 7};
  wanted.velocity = {1, 2, 3};
  wanted.angularVelocity = {.5, 0, -1};
  world.setState(id, wanted);
  EXPECT_EQ(world.state(id).position, wanted.position);
  // reading all others fetches everything; the edit stays
  for (const BodyId other : world.bodies()) world.state(other);
  EXPECT_EQ(world.state(id).position, wanted.position);
  EXPECT_EQ(world.state(id).velocity, wanted.velocity);
  world.step();
  EXPECT_NEAR(world.state(id).position.x, 30 + 1.0 / 60, 1e-6);
  EXPECT_NEAR(world.state(id).position.y, 2 + 2.0 / 60, 1e-6);
}

TEST_F(CudaEdit, ForcesActForOneStep) {
  Scene scene;
  scene.gravity = {0, 0, 0};
  scene.bodies.push_back(boxAt({0, 0, 0}));
  scene.bodies.push_back(boxAt({10, 0, 0}));
  World world(scene, optionsFor("cuda"));
  const BodyId id = world.bodyAt(0);
  const double mass = world.massOf(id).mass, dt = world.params().dt;
  world.applyForce(id, {mass, 0, 0});
  world.applyForce(id, {mass, 0, 0});
  world.step();
  EXPECT_NEAR(world.state(id).velocity.x, 2 * dt, 1e-6);
  world.step();
  EXPECT_NEAR(world.state(id).velocity.x, 2 * dt, 1e-6);
  world.applyForce(id, {mass, 0, 0});
  world.applyImpulse(id, {0, mass, 0});
  world.step();
  EXPECT_NEAR(world.state(id).velocity.x, 3 * dt, 1e-6);
  EXPECT_NEAR(world.state(id).velocity.y, 1, 1e-6);
  EXPECT_LT(length(world.state(world.bodyAt(1)).velocity), 1e-9);
}

TEST_F(CudaEdit, MovesKinematicBodies) {
  Scene scene;
  scene.bodies.push_back(boxAt({0, 0, 0}));
  scene.bodies[0].motion = Motion::Kinematic;
  World world(scene, optionsFor("cuda"));
  for (int i = 1; i <= 20; ++i) {
    world.setTarget(world.bodyAt(0), {.1 * i, 0, 0}, Quat{});
    world.step();
  }
  EXPECT_NEAR(world.state(world.bodyAt(0)).position.x, 2, 1e-5);
}

TEST_F(CudaEdit, AddsAndRemovesJoints) {
  Scene scene;
  scene.bodies.push_back(boxAt({0, 0, 0}));
  World world(scene, optionsFor("cuda"));
  run(world, 3);
  const double before = world.state(world.bodyAt(0)).position.z;
  JointDef joint;
  joint.anchorB = world.state(world.bodyAt(0)).position;
  const JointId id = world.addJoint(joint, world.bodyAt(0), BodyId{});
  run(world, 60);
  EXPECT_LT(world.state(id).gap, .05);
  EXPECT_NEAR(world.state(world.bodyAt(0)).position.z, before, .05);
  world.removeJoint(id);
  run(world, 60);
  EXPECT_LT(world.state(world.bodyAt(0)).position.z, before - 4);
}

TEST_F(CudaEdit, SnapshotsGoOnBitForBit) {
  World world(mixedScene(), optionsFor("cuda"));
  run(world, 20);
  const Snapshot snapshot = world.snapshot();
  const std::uint64_t hash = world.hash();
  run(world, 20);
  const std::uint64_t later = world.hash();
  EXPECT_NE(hash, later);

  world.restore(snapshot);
  EXPECT_EQ(world.hash(), hash);
  run(world, 20);
  EXPECT_EQ(world.hash(), later);

  World other(brickPile(2, 2), optionsFor("cuda"));
  run(other, 3);
  other.restore(snapshot);
  EXPECT_EQ(other.hash(), hash);
  run(other, 20);
  EXPECT_EQ(other.hash(), later);
}

TEST_F(CudaEdit, SnapshotsKeepForcesThatWaitForTheStep) {
  World world(brickPile(2, 2), optionsFor("cuda"));
  run(world, 5);
  const BodyId top = world.bodies().back();
  world.applyForce(top, {1e4, 0, 0});
  const Snapshot snapshot = world.snapshot();
  run(world, 2);
  const std::uint64_t later = world.hash();
  world.restore(snapshot);
  run(world, 2);
  EXPECT_EQ(world.hash(), later);
}

}  // namespace
}  // namespace rubble::test
