/// Queries of a world on the device against the same ones on the CPU, over the same poses.
#include <cuda_runtime_api.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <rubble/info.h>
#include <rubble/worlds.h>

#include "tests/query/random_scene.h"

namespace rubble::test {
namespace {

constexpr int kQueries = 1000;
/// Answers that may fall to another body, of a near tie.
constexpr int kTies = 3;
constexpr double kNear = 1e-4;

class CudaQuery : public testing::Test {
 protected:
  void SetUp() override {
    const std::vector<std::string> names = backends();
    if (std::find(names.begin(), names.end(), "cuda") == names.end())
      GTEST_SKIP() << "CUDA is " << cudaStatus();
  }
  static WorldOptions on(const std::string& backend) {
    WorldOptions options;
    options.backend = backend;
    return options;
  }
  /// A world on each, after some steps of the one on the device.
  static void meet(World& device, World& host) {
    for (int i = 0; i < 5; ++i) device.step();
    for (const BodyId id : device.bodies())
      if (device.definition(id).motion == Motion::Dynamic) host.setState(id, device.state(id));
  }
};

template <class Hit> void expectSame(const std::vector<Hit>& a, const std::vector<Hit>& b, int least) {
  ASSERT_EQ(a.size(), b.size());
  int other = 0, hits = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    hits += a[i].hit;
    const bool both = a[i].hit && b[i].hit && a[i].body == b[i].body;
    other += a[i].hit != b[i].hit || (a[i].hit && !both);
    if (both) {
      EXPECT_LT(length(a[i].position - b[i].position), kNear) << i;
    }
  }
  EXPECT_LE(other, kTies);
  EXPECT_GT(hits, least);
}

TEST_F(CudaQuery, RaysThroughPrimitiveShapesHitWhatTheyHitOnTheCpu) {
  Random random(41);
  Scene scene;
  for (int i = 0; i < 600; ++i) {
    BodyDef body;
    const double size = random.uniform(.1, .6);
    body.shape = i % 3 == 0   ? Shape::sphere(size)
                 : i % 3 == 1 ? Shape::box({size, .5 * size, .7 * size})
                              : Shape::capsule(.4 * size, size);
    body.position = random.vector(8), body.orientation = random.rotation();
    scene.bodies.push_back(body);
  }
  World device(scene, on("cuda")), host(scene, on("cpu"));
  meet(device, host);
  std::vector<RayQuery> rays;
  for (int i = 0; i < kQueries; ++i) {
    RayQuery ray;
    ray.origin = random.vector(12), ray.direction = random.vector(8) - ray.origin;
    rays.push_back(ray);
  }
  const std::vector<RayHit> all = host.castRays(rays);
  expectSame(device.castRays(rays), all, kQueries / 4);
  // few rays have a warp each
  expectSame(device.castRays({rays.data(), 5}), {all.begin(), all.begin() + 5}, -1);
}

TEST_F(CudaQuery, AnswersAsTheCpuDoes) {
  const Scene scene = randomScene(31);
  World device(scene, on("cuda")), host(scene, on("cpu"));
  meet(device, host);
  const RandomQueries asked(32, kQueries);
  expectSame(device.castRays(asked.rays), host.castRays(asked.rays), kQueries / 4);
  expectSame(device.castShapes(asked.casts), host.castShapes(asked.casts), kQueries / 4);
  expectSame(device.closestPoints(asked.points), host.closestPoints(asked.points), kQueries / 4);
  // few queries are answered body by body
  constexpr std::size_t kFew = 5;
  const auto few = [](const auto& all) { return std::span(all).first(kFew); };
  expectSame(device.castShapes(few(asked.casts)), host.castShapes(few(asked.casts)), -1);
  expectSame(device.closestPoints(few(asked.points)), host.closestPoints(few(asked.points)), -1);
  const auto a = device.overlaps(asked.shapes), b = host.overlaps(asked.shapes);
  ASSERT_EQ(a.size(), b.size());
  int other = 0;
  std::size_t found = 0;
  for (std::size_t i = 0; i < a.size(); ++i) other += a[i] != b[i], found += a[i].size();
  EXPECT_LE(other, kTies);
  EXPECT_GT(found, static_cast<std::size_t>(kQueries / 4));
}

/// Rows of numbers in memory of the device. Its work may be ordered by the legacy default stream.
template <class T> class DeviceRows {
 public:
  DeviceRows(const std::vector<T>& host, std::int64_t numbers) {
    void* memory = nullptr;
    EXPECT_EQ(cudaMalloc(&memory, sizeof(T) * host.size()), cudaSuccess);
    EXPECT_EQ(cudaMemcpy(memory, host.data(), sizeof(T) * host.size(), cudaMemcpyHostToDevice), cudaSuccess);
    view = packedArray(static_cast<const T*>(memory), std::ssize(host) / numbers, numbers);
    view.device = true, view.stream = 1;
  }
  ~DeviceRows() { cudaFree(const_cast<void*>(view.data)); }
  DeviceRows(const DeviceRows&) = delete;
  DeviceRows& operator=(const DeviceRows&) = delete;

  ArrayView view;
};

template <class T> std::vector<T> numbersIn(const ArrayView& view) {
  EXPECT_TRUE(view.device);
  std::vector<T> host(static_cast<std::size_t>(view.shape[0] * view.shape[1]));
  EXPECT_EQ(cudaStreamSynchronize(reinterpret_cast<cudaStream_t>(view.stream)), cudaSuccess);
  EXPECT_EQ(cudaMemcpy(host.data(), view.data, sizeof(T) * host.size(), cudaMemcpyDeviceToHost), cudaSuccess);
  return host;
}

Vec3 inFloat(const Vec3& a) {
  const auto round = [](double d) { return static_cast<double>(static_cast<float>(d)); };
  return {round(a.x), round(a.y), round(a.z)};
}

TEST_F(CudaQuery, RaysThatAreArraysHitWhatTheSameRaysHit) {
  constexpr int kWorlds = 3;
  Worlds worlds(on("cuda"));
  worlds.addCopies(randomScene(31), kWorlds);
  for (int w = 0; w < kWorlds; ++w) worlds[w].setGravity({0, 3. * w, -9.81});
  worlds.step(5);
  Random random(34);
  std::vector<double> origins;
  std::vector<float> directions;
  std::vector<int> numbers;
  std::vector<Worlds::WorldRay> even, mixed;
  RayQuery ray;
  ray.maxDistance = 40;
  for (int i = 0; i < kWorlds * kQueries; ++i) {
    ray.origin = random.vector(15), ray.direction = inFloat(randomWay(random, .1, 3));
    origins.insert(origins.end(), {ray.origin.x, ray.origin.y, ray.origin.z});
    for (const double d : {ray.direction.x, ray.direction.y, ray.direction.z})
      directions.push_back(static_cast<float>(d));
    numbers.push_back(i % kWorlds);
    even.push_back({i / kQueries, ray}), mixed.push_back({numbers.back(), ray});
  }
  const DeviceRows<double> from(origins, 3);
  const DeviceRows<float> to(directions, 3);
  const DeviceRows<int> of(numbers, 1);
  const RayArrays arrays{from.view, to.view, ray.maxDistance, {}};
  for (const bool isEven : {true, false}) {
    const std::vector<RayHit> wanted = worlds.castRays(isEven ? even : mixed);
    const RayHitArrays found = worlds.castRayArrays(arrays, isEven ? ArrayView{} : of.view);
    const std::vector<float> distances = numbersIn<float>(found.distances);
    const std::vector<float> normals = numbersIn<float>(found.normals);
    const std::vector<int> bodies = numbersIn<int>(found.bodies);
    ASSERT_EQ(distances.size(), wanted.size());
    int hits = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      hits += wanted[i].hit;
      EXPECT_EQ(bodies[i], wanted[i].hit ? wanted[i].body.index : -1) << i;
      EXPECT_EQ(distances[i], static_cast<float>(wanted[i].hit ? wanted[i].distance : ray.maxDistance)) << i;
      EXPECT_EQ(normals[3 * i + 2], static_cast<float>(wanted[i].hit ? wanted[i].normal.z : 0)) << i;
    }
    EXPECT_GT(hits, kQueries / 4);
  }
}

TEST_F(CudaQuery, RaysThatAreArraysSeeEditsAndLeaveTheStepAlone) {
  const Scene scene = randomScene(33);
  World asked(scene, on("cuda")), alone(scene, on("cuda"));
  const DeviceRows<float> from({0, 0, 50, 0, 0, 50}, 3), to({0, 0, -2, 0, 0, 0}, 3);
  const RayArrays rays{from.view, to.view, 30, {}};
  EXPECT_EQ(numbersIn<int>(asked.castRayArrays(rays).bodies), (std::vector<int>{-1, -1}));
  BodyDef ball = body(Shape::sphere(1), {0, 0, 40});
  ball.motion = Motion::Static;
  const BodyId id = asked.addBody(ball);
  alone.addBody(ball);
  const RayHitArrays found = asked.castRayArrays(rays);
  EXPECT_EQ(numbersIn<int>(found.bodies), (std::vector<int>{id.index, -1}));
  const std::vector<float> distances = numbersIn<float>(found.distances);
  EXPECT_NEAR(distances[0], 9, 1e-4);
  EXPECT_TRUE(std::isnan(distances[1]));
  for (int i = 0; i < 8; ++i) {
    asked.step(), alone.step();
    asked.castRayArrays(rays);
  }
  EXPECT_EQ(asked.hash(), alone.hash());
}

TEST_F(CudaQuery, SeesEditsAndLeavesTheStepAlone) {
  const Scene scene = randomScene(33);
  World asked(scene, on("cuda")), alone(scene, on("cuda"));
  const RayQuery ray{{0, 0, 50}, {0, 0, -1}, 30, {}};
  // before the first step, after an edit, and between steps that a graph takes
  EXPECT_FALSE(asked.castRays({&ray, 1})[0].hit);
  BodyDef ball = body(Shape::sphere(1), {0, 0, 40});
  ball.motion = Motion::Static;
  const BodyId id = asked.addBody(ball);
  alone.addBody(ball);
  const RayHit hit = asked.castRays({&ray, 1})[0];
  EXPECT_TRUE(hit.hit);
  EXPECT_EQ(hit.body, id);
  EXPECT_NEAR(hit.distance, 9, 1e-4);
  for (int i = 0; i < 8; ++i) {
    asked.step(), alone.step();
    asked.castRays({&ray, 1});
  }
  EXPECT_EQ(asked.hash(), alone.hash());
}

}  // namespace
}  // namespace rubble::test
