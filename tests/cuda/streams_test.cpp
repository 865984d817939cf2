// Order of the engine and the streams of callers. Streams are held up on the host, so that work that does not
// wait for them comes first.
#include <cuda_runtime_api.h>

#include <chrono>
#include <cstring>
#include <memory>
#include <thread>

#include "tests/cuda/cuda_scenes.h"

namespace rubble::test {
namespace {

class CudaStreams : public CudaTest {};

/// Later work of the stream waits this long.
void holdUp(cudaStream_t stream) {
  const auto sleep = [](void*) { std::this_thread::sleep_for(std::chrono::milliseconds(50)); };
  ASSERT_EQ(cudaLaunchHostFunc(stream, sleep, nullptr), cudaSuccess);
}

/// A stream that does not wait for the default stream.
struct OwnStream {
  cudaStream_t stream = nullptr;
  OwnStream() { EXPECT_EQ(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), cudaSuccess); }
  ~OwnStream() { cudaStreamDestroy(stream); }
  OwnStream(const OwnStream&) = delete;
  OwnStream& operator=(const OwnStream&) = delete;
};

/// Memory of the device, and page-locked memory beside it.
template <class T> struct Both {
  T *device = nullptr, *host = nullptr;
  std::size_t bytes;
  explicit Both(std::initializer_list<T> values) : bytes(sizeof(T) * values.size()) {
    void *there = nullptr, *here = nullptr;
    EXPECT_EQ(cudaMalloc(&there, bytes), cudaSuccess);
    EXPECT_EQ(cudaMallocHost(&here, bytes), cudaSuccess);
    device = static_cast<T*>(there), host = static_cast<T*>(here);
    std::memcpy(host, values.begin(), bytes);
    EXPECT_EQ(cudaMemset(device, 0, bytes), cudaSuccess);
    EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  }
  ~Both() { cudaFree(device), cudaFreeHost(host); }
  Both(const Both&) = delete;
  Both& operator=(const Both&) = delete;

  void toDevice(cudaStream_t stream) const {
    EXPECT_EQ(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream), cudaSuccess);
  }
  /// From any memory of the device.
  void toHost(const void* from, cudaStream_t stream) const {
    EXPECT_EQ(cudaMemcpyAsync(host, from, bytes, cudaMemcpyDeviceToHost, stream), cudaSuccess);
  }
};

template <class T> ArrayView viewOf(const T* data, std::int64_t numbers, cudaStream_t stream) {
  ArrayView view = packedArray(data, 1, numbers);
  view.device = true, view.stream = reinterpret_cast<std::uintptr_t>(stream);
  return view;
}

Scene fallingBox() {
  Scene scene = plane();
  scene.bodies.push_back(boxAt({0, 0, 20}));
  return scene;
}
constexpr int kBox = 1;

const char* rowOf(const ArrayView& view) {
  return static_cast<const char*>(view.data) + kBox * view.strides[0];
}

TEST_F(CudaStreams, TheDeviceIsThatOfTheEngine) {
  const World cuda(fallingBox(), optionsFor("cuda")), cpu(fallingBox(), optionsFor("cpu"));
  int device = -1;
  ASSERT_EQ(cudaGetDevice(&device), cudaSuccess);
  EXPECT_EQ(cuda.deviceStream().device, device);
  EXPECT_EQ(cuda.deviceStream().stream, cuda.array(StateArray::Position).stream);
  EXPECT_EQ(cpu.deviceStream().device, -1);
  EXPECT_EQ(cpu.addReader(1), nullptr);
  EXPECT_EQ(cuda.addReader(0), nullptr);
}

TEST_F(CudaStreams, ValuesMayBeFreshAndOverwrittenAfterwards) {
  const OwnStream own;
  for (cudaStream_t const stream : {cudaStreamLegacy, own.stream}) {
    World world(fallingBox(), optionsFor("cuda"));
    world.step();
    const Both<int> rows({kBox});
    const Both<float> values({1, 2, 3});
    holdUp(stream);
    rows.toDevice(stream), values.toDevice(stream);
    world.scatter(StateArray::Velocity, viewOf(rows.device, 1, stream), viewOf(values.device, 3, stream));
    EXPECT_EQ(cudaMemsetAsync(values.device, 0, values.bytes, stream), cudaSuccess);
    EXPECT_EQ(world.state(world.bodyAt(kBox)).velocity, (Vec3{1, 2, 3}));
  }
}

TEST_F(CudaStreams, AStepWaitsForReadsUnderWay) {
  const OwnStream own;
  for (const bool ended : {false, true})
    for (cudaStream_t const stream : {cudaStreamLegacy, own.stream}) {
      World world(fallingBox(), optionsFor("cuda"));
      world.step();
      const Vec3 before = world.state(world.bodyAt(kBox)).position;
      const Both<double> seen({0, 0, 0});
      const ArrayView position = world.array(StateArray::Position);
      std::shared_ptr<void> reader;
      if (stream != cudaStreamLegacy) reader = world.addReader(reinterpret_cast<std::uintptr_t>(stream));
      holdUp(stream);
      seen.toHost(rowOf(position), stream);
      if (ended) reader.reset();
      run(world, 3);
      EXPECT_LT(world.state(world.bodyAt(kBox)).position.z, before.z);
      EXPECT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
      EXPECT_EQ((Vec3{seen.host[0], seen.host[1], seen.host[2]}), before);
    }
}

TEST_F(CudaStreams, AReaderSeesWhatTheEngineIsAboutToWrite) {
  const OwnStream own;
  for (cudaStream_t const stream : {cudaStreamLegacy, own.stream}) {
    World world(fallingBox(), optionsFor("cuda"));
    world.step();
    const auto engine = reinterpret_cast<cudaStream_t>(world.deviceStream().stream);
    const std::shared_ptr<void> reader = world.addReader(reinterpret_cast<std::uintptr_t>(stream));
    const Both<float> seen({0, 0, 0});
    // an edit, a scatter, and an array that is filled when it is asked for
    holdUp(engine);
    world.applyImpulse(world.bodyAt(kBox), {0, 0, 5});
    const ArrayView velocity = world.array(StateArray::Velocity);
    seen.toHost(rowOf(velocity), stream);
    EXPECT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
    EXPECT_EQ(seen.host[2], static_cast<float>(world.state(world.bodyAt(kBox)).velocity.z));

    const int row = kBox;
    const float value[3] = {4, 5, 6};
    ArrayView rows = viewOf(&row, 1, nullptr), values = viewOf(value, 3, nullptr);
    rows.device = values.device = false;
    holdUp(engine);
    world.scatter(StateArray::Velocity, rows, values);
    seen.toHost(rowOf(velocity), stream);
    EXPECT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
    EXPECT_EQ(std::memcmp(seen.host, value, sizeof value), 0);

    world.scatter(StateArray::AngularVelocity, rows, values);
    holdUp(engine);
    seen.toHost(rowOf(world.array(SensorArray::AngularRate)), stream);
    EXPECT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
    EXPECT_EQ(std::memcmp(seen.host, value, sizeof value), 0);
  }
}

TEST_F(CudaStreams, ViewsOfSortedBodiesFollowEachStep) {
  const OwnStream own;
  Scene scene = fallingBox();
  for (int k = 0; k < 200; ++k) scene.bodies.push_back(boxAt({3. * (k * 37 % 200), 0, 20}));
  World world(scene, optionsFor("cuda"));
  world.sortBodies();
  world.step();
  const ArrayView position = world.array(StateArray::Position);
  const std::shared_ptr<void> reader = world.addReader(reinterpret_cast<std::uintptr_t>(own.stream));
  const Both<double> seen({0, 0, 0});
  for (int k = 0; k < 5; ++k) {
    world.step();
    seen.toHost(rowOf(position), own.stream);
    EXPECT_EQ(cudaStreamSynchronize(own.stream), cudaSuccess);
    EXPECT_EQ(seen.host[2], world.state(world.bodyAt(kBox)).position.z);
  }
}

}  // namespace
}  // namespace rubble::test
