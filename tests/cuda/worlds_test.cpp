// Worlds of a batch on the device have the bits that they have in a batch of their own.
#include <cuda_runtime_api.h>

#include "tests/cuda/cuda_test.h"
#include "tests/support/array_claims.h"
#include "tests/support/sensor_claims.h"

namespace rubble::test {
namespace {

class CudaWorlds : public CudaTest {};

std::vector<double> copyOfDevice(const ArrayView& view) {
  EXPECT_TRUE(view.device);
  ArrayView here = view;
  std::vector<char> bytes(static_cast<std::size_t>(view.shape[0] * view.strides[0]));
  cudaStreamSynchronize(reinterpret_cast<cudaStream_t>(view.stream));
  if (!bytes.empty()) {
    EXPECT_EQ(cudaMemcpy(bytes.data(), view.data, bytes.size(), cudaMemcpyDefault), cudaSuccess);
  }
  here.data = bytes.data();
  return copyOfHost(here);
}

RandomWorlds rigid(std::uint64_t seed, int most = 10) { return {seed, most, false}; }

TEST_F(CudaWorlds, HaveTheBitsThatTheyHaveAlone) {
  for (const int count : {1, 2, 7}) expectBitsAlone(rigid(0), count, worldsOptions("cuda"), 60);
}
TEST_F(CudaWorlds, AThousandHaveTheBitsThatTheyHaveAlone) {
  expectBitsAlone(rigid(0, 3), 1000, worldsOptions("cuda"), 30, 41);
}
TEST_F(CudaWorlds, HaveTheBitsThatTheyHaveAloneWithDeformables) {
  for (const int count : {2, 7}) expectBitsAlone({0}, count, worldsOptions("cuda"), 40);
  expectBitsAlone({0, 3}, 300, worldsOptions("cuda"), 15, 29);
}

TEST_F(CudaWorlds, StepOnlyThoseOfTheMask) { expectMasks(rigid(100), worldsOptions("cuda"), 9, 40); }
TEST_F(CudaWorlds, StepOnlyThoseOfTheMaskWithDeformables) {
  expectMasks({100}, worldsOptions("cuda"), 5, 12);
}

TEST_F(CudaWorlds, AThousandResetsTouchNoOtherWorld) {
  expectResets(rigid(200, 5), worldsOptions("cuda"), 40, 100, 10);
}
TEST_F(CudaWorlds, ResetsTouchNoOtherWorldWithDeformables) {
  expectResets({200, 5}, worldsOptions("cuda"), 8, 10, 2);
}

TEST_F(CudaWorlds, EditsOfOneWorldAreThoseOfAWorldAlone) {
  expectEditsAlone(rigid(300), worldsOptions("cuda"));
  expectEditsAlone({300}, worldsOptions("cuda"));
}

TEST_F(CudaWorlds, ArraysOfJointsAndSensorsTellWhatJointsAndBodiesTell) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    World world(randomWorld(600 + seed, 8, false), worldsOptions("cuda"));
    run(world, 15);
    expectArraysOfWorld(world, copyOfDevice);
  }
  expectArraysOfWorlds(rigid(620, 4), worldsOptions("cuda"), 12, copyOfDevice);
  expectAccelerations(worldsOptions("cuda"), copyOfDevice);
}
TEST_F(CudaWorlds, VerticesOfManyWorldsAreThoseOfEachAlone) {
  expectVertexArrays(worldsOptions("cuda"), 6, copyOfDevice);
}
TEST_F(CudaWorlds, ForcesAlongAxesActOnBothBodies) { expectForcesAlongAxes(worldsOptions("cuda")); }
TEST_F(CudaWorlds, SensorsOfASceneReadInEachWorldWhatTheyReadAlone) {
  expectSensorsAlone(worldsOptions("cuda"), 35);
}
TEST_F(CudaWorlds, RaysInManyWorldsHitWhatThoseOfEachHit) {
  expectRays(rigid(640, 5), worldsOptions("cuda"), 20);
}

/// Targets that were written on the device are part of a snapshot.
TEST_F(CudaWorlds, SnapshotsHaveTheTargetsOfDrives) {
  Scene scene = emptyScene({0, 0, 0});
  scene.bodies.push_back(body(Shape::box({0.1, 0.1, 0.1}), {}));
  scene.joints.push_back(jointAt(scene, JointType::Slider, 0, kWorld, {}));
  scene.joints[0].axes[0].driveStiffness = 1000, scene.joints[0].axes[0].driveDamping = 100;
  Worlds worlds(worldsOptions("cuda"));
  worlds.addCopies(scene, 3);
  const HostRows given{{1}, {0.5}};
  worlds.scatter(JointArray::TargetPosition, given.rowView(), given.valueView());
  const Snapshot snapshot = worlds[1].snapshot();
  worlds.reset(std::vector<int>{2}, {&snapshot, 1});
  worlds.step(200);
  const std::vector<double> x = copyOfDevice(worlds.array(JointArray::Position));
  EXPECT_NEAR(x[0], 0, 1e-3);
  EXPECT_NEAR(x[1], 0.5, 1e-2);
  EXPECT_EQ(x[1], x[2]);
}

TEST_F(CudaWorlds, DefinitionsOfBodiesChangeWithoutTheirState) {
  Scene scene = emptyScene({0, 0, -10});
  scene.bodies.push_back(ground());
  scene.bodies.push_back(body(Shape::box({0.5, 0.4, 0.3}), {0, 0, 1}));
  World world(scene, worldsOptions("cuda"));
  run(world, 3);
  BodyDef def = scene.bodies[1];
  def.mass = 7;
  const BodyState before = world.state(world.bodyAt(1));
  world.setDefinition(world.bodyAt(1), def);
  EXPECT_EQ(world.state(world.bodyAt(1)).velocity, before.velocity);
  run(world, 120);
  EXPECT_NEAR(copyOfDevice(world.array(SensorArray::Touch))[1], 70, 0.5);
}

/// Copies of one world that nothing moves apart keep equal bits.
TEST_F(CudaWorlds, CopiesStayEqual) {
  Worlds worlds(worldsOptions("cuda"));
  worlds.addCopies(heap(1), 300);
  worlds.step(60);
  const std::uint64_t first = worlds[0].hash();
  for (int w = 1; w < worlds.count(); w += 23) ASSERT_EQ(worlds[w].hash(), first) << "world " << w;
}

/// A batch looks for neighbors in another way than a world alone: worlds of few and of many bodies, of which
/// bodies are removed.
TEST_F(CudaWorlds, SmallAndLargeWorldsHaveTheBitsThatTheyHaveAlone) {
  const Scene scenes[] = {heap(1), heap(10), heap(3)};
  constexpr int kKinds = 3, kCopies = 40;
  const auto begin = [&](Worlds& worlds, int w) {
    World& world = worlds[worlds.add(scenes[w % kKinds])];
    world.removeBody(world.bodyAt(w % 7 + 1));
  };
  Worlds worlds(worldsOptions("cuda"));
  for (int w = 0; w < kKinds * kCopies; ++w) begin(worlds, w);
  worlds.step(40);
  for (const int w : {0, 1, 2, 3, 4, 31, 62, 93, 117, 118, 119}) {
    Worlds alone(worldsOptions("cuda"));
    begin(alone, w);
    alone.step(40);
    EXPECT_EQ(worlds[w].hash(), alone[0].hash()) << "world " << w;
  }
}

/// Few joint trees take a block each and many a tile each, with the same bits: chains with limits, of more
/// bodies than a tile has lanes, with locked axes.
TEST_F(CudaWorlds, ThousandsOfJointTreesHaveTheBitsOfOneAlone) {
  Random random(7);
  Scene scene;
  addChain(scene, random, 21);
  scene.bodies[5].lockRotation[1] = scene.bodies[12].lockTranslation[0] = true;
  Worlds many(worldsOptions("cuda")), one(worldsOptions("cuda")), cpu(worldsOptions("cpu"));
  many.addCopies(scene, 2500), one.add(scene), cpu.add(scene);
  for (Worlds* worlds : {&many, &one, &cpu}) worlds->step(3);
  for (const BodyId id : cpu[0].bodies())
    EXPECT_LT(length(cpu[0].state(id).position - one[0].state(id).position), 1e-4) << id.index;
  many.step(60), one.step(60);
  for (int w = 0; w < many.count(); w += 357) ASSERT_EQ(stateOf(many[w]), stateOf(one[0])) << "world " << w;
}

TEST_F(CudaWorlds, AgreeWithTheCpuInTheFirstSteps) {
  Worlds cuda(worldsOptions("cuda")), cpu(worldsOptions("cpu"));
  for (Worlds* worlds : {&cuda, &cpu})
    for (int w = 0; w < 40; ++w) worlds->add(rigid(500).scene(w));
  cuda.step(3), cpu.step(3);
  for (int w = 0; w < 40; ++w)
    for (const BodyId id : cpu[w].bodies())
      EXPECT_LT(length(cpu[w].state(id).position - cuda[w].state(id).position), 1e-4)
          << "world " << w << ", body " << id.index;
}

/// A build with RUBBLE_STRICT promises the bits of the CPU.
TEST_F(CudaWorlds, HaveTheBitsOfTheCpuInAStrictBuild) {
  const std::vector<std::string> features = buildInfo().features;
  if (std::none_of(features.begin(), features.end(),
                   [](const std::string& f) { return f.find("strict") != std::string::npos; }))
    GTEST_SKIP() << "not a strict build";
  Worlds cuda(worldsOptions("cuda")), cpu(worldsOptions("cpu"));
  for (Worlds* worlds : {&cuda, &cpu})
    for (int w = 0; w < 20; ++w) worlds->add(rigid(500).scene(w));
  for (int k = 0; k < 40; ++k) {
    const std::vector<char> active(20, 1);
    cuda.step(1, active), cpu.step(1, active);
  }
  for (int w = 0; w < 20; ++w) EXPECT_EQ(stateOf(cpu[w]), stateOf(cuda[w])) << "world " << w;
}

TEST_F(CudaWorlds, ArraysAreOnTheDeviceWithOneRowPerBodyOfEachWorld) {
  Worlds worlds(worldsOptions("cuda"));
  worlds.addCopies(heap(1), 5);
  worlds.step(3);
  const ArrayView view = worlds.array(StateArray::Position);
  ASSERT_TRUE(view.device);
  ASSERT_EQ(view.shape[0], 5 * 17);
  cudaStreamSynchronize(reinterpret_cast<cudaStream_t>(view.stream));
  for (int w = 0; w < 5; ++w)
    for (const BodyId id : worlds[w].bodies()) {
      double x[3];
      const auto* const from = static_cast<const char*>(view.data) +
                               (worlds.firstRow(w) + id.index) * view.strides[0];
      ASSERT_EQ(cudaMemcpy(x, from, sizeof x, cudaMemcpyDefault), cudaSuccess);
      EXPECT_EQ(worlds[w].state(id).position, (Vec3{x[0], x[1], x[2]}));
    }
}

/// Forces of rows act on the bodies of these rows alone, and wait while their world is left out.
TEST_F(CudaWorlds, ForcesOfRowsWaitForTheirWorld) {
  Scene scene;
  scene.gravity = {};
  scene.bodies.push_back(body(Shape::box({0.5, 0.5, 0.5}), {}));
  Worlds worlds(worldsOptions("cuda"));
  worlds.addCopies(scene, 4);
  const double mass = worlds[0].massOf(worlds[0].bodyAt(0)).mass, dt = worlds.params().dt;
  const int row = 2;
  const double force[3] = {6 * mass, 0, 0};
  worlds.scatter(StateArray::Force, packedArray(&row, 1), packedArray(force, 1, 3));
  worlds.step(1, std::vector<char>{1, 1, 0, 1});
  for (int w = 0; w < 4; ++w) EXPECT_EQ(worlds[w].state(worlds[w].bodyAt(0)).velocity.x, 0) << w;
  worlds.step(2);
  for (int w = 0; w < 4; ++w)
    EXPECT_NEAR(worlds[w].state(worlds[w].bodyAt(0)).velocity.x, w == 2 ? 6 * dt : 0, 1e-5) << w;
}

}  // namespace
}  // namespace rubble::test
