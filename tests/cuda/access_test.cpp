// State as device arrays, writes from arrays, copies of poses, snapshots on the device.
#include <cuda_runtime_api.h>

#include <cstring>

#include "tests/cuda/cuda_scenes.h"

namespace rubble::test {
namespace {

class CudaAccess : public CudaTest {};

std::vector<double> rowAt(const ArrayView& view, int row) {
  const std::size_t size = view.typestr[2] == '8' ? 8 : 4;
  std::vector<double> out;
  cudaStreamSynchronize(reinterpret_cast<cudaStream_t>(view.stream));
  for (std::int64_t k = 0; k < view.shape[1]; ++k) {
    unsigned char bytes[8] = {};
    const char* const at = static_cast<const char*>(view.data) + row * view.strides[0] + k * view.strides[1];
    EXPECT_EQ(cudaMemcpy(bytes, at, size, cudaMemcpyDefault), cudaSuccess);
    double wide = 0;
    float narrow = 0;
    if (size == 8)
      std::memcpy(&wide, bytes, 8);
    else
      std::memcpy(&narrow, bytes, 4), wide = static_cast<double>(narrow);
    out.push_back(wide);
  }
  return out;
}

ArrayView placed(ArrayView view, bool device) {
  view.device = device, view.stream = device ? 1 : 0;
  return view;
}
ArrayView rowsView(const int* data, std::int64_t count, bool device) {
  return placed(packedArray(data, count), device);
}
ArrayView valuesView(const double* data, std::int64_t count, std::int64_t numbers, bool device) {
  return placed(packedArray(data, count, numbers), device);
}

TEST_F(CudaAccess, ArraysAreDeviceMemoryWithTheStateOfEveryBody) {
  World world(mixedScene(), optionsFor("cuda"));
  run(world, 10);
  const BodyId id = world.bodyAt(20);
  BodyState moved = world.state(id);
  moved.position.z += 3;
  world.setState(id, moved);
  const ArrayView position = world.array(StateArray::Position),
                  orientation = world.array(StateArray::Orientation);
  const ArrayView velocity = world.array(StateArray::Velocity);
  EXPECT_TRUE(position.device);
  EXPECT_NE(position.stream, 0u);
  EXPECT_EQ(position.shape[0], static_cast<std::int64_t>(world.bodies().size()));
  for (const BodyId body : world.bodies()) {
    const BodyState s = world.state(body);
    EXPECT_EQ(rowAt(position, body.index), (std::vector<double>{s.position.x, s.position.y, s.position.z}));
    EXPECT_EQ(rowAt(velocity, body.index), (std::vector<double>{s.velocity.x, s.velocity.y, s.velocity.z}));
    EXPECT_EQ(rowAt(orientation, body.index)[0], s.orientation.s);
  }
  run(world, 5);
  EXPECT_EQ(world.epoch(), position.epoch);
  EXPECT_EQ(world.array(StateArray::Position).data, position.data);
}

TEST_F(CudaAccess, BatchesDoWhatSingleEditsDo) {
  World one(mixedScene(), optionsFor("cuda")), many(mixedScene(), optionsFor("cuda"));
  run(one, 10), run(many, 10);
  std::vector<BodyId> ids;
  for (int i = 5; i < 60; ++i) ids.push_back(one.bodyAt(i));
  std::vector<Vec3> pushes;
  for (std::size_t k = 0; k < ids.size(); ++k) pushes.push_back({100. * static_cast<double>(k), 50, 200});
  // twice: the second must not overtake the first
  for (int i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < ids.size(); ++k)
      one.applyImpulse(ids[k], pushes[k]), one.applyForce(ids[k], pushes[k]);
    many.applyImpulses(ids, pushes), many.applyForces(ids, pushes);
  }
  const BodyState still{{0, 0, 30}, {}, {}, {}};
  one.setState(ids[3], still);
  many.setStates(std::vector<BodyId>{ids[3]}, std::vector<BodyState>{still});
  EXPECT_EQ(many.state(ids[3]).velocity, (Vec3{}));
  run(one, 5), run(many, 5);
  EXPECT_TRUE(sameStates(one, many));
  const std::vector<BodyDef> fresh = {boxAt({30, 0, 5}), boxAt({32, 0, 5})};
  const std::vector<BodyId> gone = {ids[0], ids[9], ids[17]};
  for (const BodyDef& body : fresh) one.addBody(body);
  for (const BodyId id : gone) one.removeBody(id);
  many.addBodies(fresh), many.removeBodies(gone);
  run(one, 20), run(many, 20);
  EXPECT_EQ(one.hash(), many.hash());
}

TEST_F(CudaAccess, ImpulsesOnTheDeviceAreThoseOfTheCpu) {
  Scene scene;
  scene.gravity = {0, 0, 0};
  for (int i = 0; i < 40; ++i) scene.bodies.push_back(boxAt({3. * i, 0, 0}));
  World cpu(scene, optionsFor("cpu")), cuda(scene, optionsFor("cuda"));
  for (World* world : {&cpu, &cuda}) {
    run(*world, 2);
    std::vector<Vec3> pushes;
    for (int i = 0; i < 40; ++i) pushes.push_back({10. * i, 333, -7});
    world->applyImpulses(world->bodies(), pushes);
    run(*world, 2);
  }
  for (const BodyId id : cpu.bodies())
    EXPECT_LT(length(cpu.state(id).velocity - cuda.state(id).velocity), 1e-7);
}

TEST_F(CudaAccess, ScattersFromHostAndDeviceAlike) {
  World host(mixedScene(), optionsFor("cuda")), device(mixedScene(), optionsFor("cuda"));
  run(host, 5), run(device, 5);
  const std::vector<int> rows = {7, 30, 9999, 12};
  const std::vector<double> vectors = {1, 2, 3, -4, 0, 2, 9, 9, 9, 0, 5, -1},
                            turns = {1, 0, 0, 0, 0, 3, 0, 0, 1, 1, 1, 1, .6, 0, 0, .8};
  int* deviceRows = nullptr;
  double *deviceVectors = nullptr, *deviceTurns = nullptr;
  const auto put = [](auto*& to, const auto& from) {
    const std::size_t bytes = from.size() * sizeof from[0];
    ASSERT_EQ(cudaMalloc(reinterpret_cast<void**>(&to), bytes), cudaSuccess);
    ASSERT_EQ(cudaMemcpy(to, from.data(), bytes, cudaMemcpyHostToDevice), cudaSuccess);
  };
  put(deviceRows, rows), put(deviceVectors, vectors), put(deviceTurns, turns);
  for (const StateArray which : {StateArray::Velocity, StateArray::Force, StateArray::Force,
                                 StateArray::Position, StateArray::AngularVelocity}) {
    host.scatter(which, rowsView(rows.data(), 4, false), valuesView(vectors.data(), 4, 3, false));
    device.scatter(which, rowsView(deviceRows, 4, true), valuesView(deviceVectors, 4, 3, true));
  }
  host.scatter(StateArray::Orientation, rowsView(rows.data(), 4, false),
               valuesView(turns.data(), 4, 4, false));
  device.scatter(StateArray::Orientation, rowsView(deviceRows, 4, true), valuesView(deviceTurns, 4, 4, true));
  EXPECT_EQ(host.state(host.bodyAt(30)).velocity, (Vec3{-4, 0, 2}));
  EXPECT_EQ(device.state(device.bodyAt(30)).orientation, (Quat{0, 1, 0, 0}));
  // a force of the host on top of those of the device
  host.applyForce(host.bodyAt(7), {0, 0, 5}), device.applyForce(device.bodyAt(7), {0, 0, 5});
  EXPECT_EQ(host.hash(), device.hash());
  run(host, 10), run(device, 10);
  EXPECT_EQ(host.hash(), device.hash());
  EXPECT_THROW(device.scatter(StateArray::Velocity, rowsView(rows.data(), 4, false),
                              valuesView(deviceVectors, 4, 3, true)),
               Error);
  cudaFree(deviceRows), cudaFree(deviceVectors), cudaFree(deviceTurns);
}

TEST_F(CudaAccess, PosesComeWhileTheWorldStepsOn) {
  World world(mixedScene(), optionsFor("cuda")), other(mixedScene(), optionsFor("cuda"));
  const BodyId id = world.bodyAt(40);
  std::vector<Vec3> places;
  for (int i = 0; i < 12; ++i) {
    world.step(), other.step();
    world.beginPoses();
    places.push_back(other.state(id).position);
    if (i == 0) continue;
    const PoseFrame frame = world.takePoses();
    EXPECT_EQ(frame.step, i);
    EXPECT_FALSE(frame.position.device);
    const auto* const p = static_cast<const double*>(frame.position.data) + 3 * id.index;
    EXPECT_EQ((Vec3{p[0], p[1], p[2]}), places[static_cast<std::size_t>(i - 1)]);
  }
  EXPECT_EQ(world.takePoses().step, 12);
  EXPECT_THROW(world.takePoses(), Error);
}

TEST_F(CudaAccess, SnapshotsStayOnTheDeviceAndOutliveEditsAndTheirWorld) {
  World world(mixedScene(), optionsFor("cuda"));
  run(world, 20);
  const Snapshot first = world.snapshot();
  const std::uint64_t hash = world.hash();
  run(world, 5);
  const std::uint64_t later = world.hash();
  world.removeBodies(std::vector<BodyId>{world.bodyAt(4), world.bodyAt(33)});
  world.addBody(boxAt({40, 0, 3}));
  run(world, 5);
  world.restore(first);
  EXPECT_EQ(world.hash(), hash);
  run(world, 5);
  EXPECT_EQ(world.hash(), later);

  Snapshot orphan;
  {
    World brief(mixedScene(), optionsFor("cuda"));
    run(brief, 20);
    orphan = brief.snapshot();
  }
  World cuda(brickPile(2, 2), optionsFor("cuda")), cpu(brickPile(2, 2), optionsFor("cpu"));
  cuda.restore(orphan), cpu.restore(orphan);
  EXPECT_EQ(cuda.hash(), hash);
  EXPECT_EQ(cpu.hash(), hash);
  run(cuda, 5);
  EXPECT_EQ(cuda.hash(), later);
}

}  // namespace
}  // namespace rubble::test
