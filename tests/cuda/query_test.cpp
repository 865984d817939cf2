/// Queries of a world on the device against the same ones on the CPU, over the same poses.
#include <gtest/gtest.h>

#include <algorithm>

#include <rubble/info.h>

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
