/// Stacks of threads need not grow with scenes (docs/embedding.md).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include <pthread.h>

#include "io/scene_json.h"
#include "tests/support/meshes.h"
#include "tests/support/sanitizer.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

#if defined(RUBBLE_HAS_SANITIZER)
constexpr std::size_t kStack = 4 << 20;  // [bytes]; each variable has a guard around it
#else
constexpr std::size_t kStack = 256 << 10;  // [bytes]
#endif

/// Runs f() on a thread whose stack has kStack bytes.
void runOnSmallStack(std::function<void()> f) {
  pthread_attr_t attributes;
  ASSERT_EQ(pthread_attr_init(&attributes), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&attributes, kStack), 0);
  pthread_t thread;
  const auto call = [](void* task) -> void* {
    (*static_cast<std::function<void()>*>(task))();
    return nullptr;
  };
  ASSERT_EQ(pthread_create(&thread, &attributes, call, &f), 0);
  EXPECT_EQ(pthread_join(thread, nullptr), 0);
  pthread_attr_destroy(&attributes);
}

/// Makes, steps, edits, saves and restores a world.
void useWorldOf(const Scene& scene) {
  World world(scene, test::options(2));
  test::run(world, 2);
  world.castRays(std::vector<RayQuery>(1, {{0.01, 0.02, 50}, {0, 0, -1}, 100, {}}));
  const Snapshot snapshot = Snapshot::fromBytes(world.snapshot().bytes());
  world.removeBody(world.bodyAt(static_cast<int>(scene.bodies.size()) / 2));
  test::run(world, 1);
  world.restore(snapshot);
  io::SceneFile file;
  file.scene = scene;
  std::vector<io::Fault> faults;
  EXPECT_EQ(io::parseScene(io::toJson(file), faults).scene.bodies.size(), scene.bodies.size());
  EXPECT_TRUE(faults.empty());
}

TEST(Stack, DoesNotGrowWithTheLengthOfAChain) {
  constexpr int kLinks = 4000;
  Scene scene = test::emptyScene();
  for (int k = 0; k < kLinks; ++k) scene.bodies.push_back(test::unitCube({1. * k, 0, 5}));
  for (int k = 0; k + 1 < kLinks; ++k) scene.joints.push_back(test::ball(k, {.5, 0, 0}, k + 1, {-.5, 0, 0}));
  scene.deformables.emplace_back(straightCable({0, 9, 9}, {400, 9, 9}, kLinks));
  runOnSmallStack([&] { useWorldOf(scene); });
}

TEST(Stack, DoesNotGrowWithTheSizeOfShapes) {
  Scene scene = test::emptyScene();
  const TriangleMesh ring = test::torusMesh(20, 5, 120, 60);
  BodyDef terrain = test::body(Shape::mesh(ring.vertices, ring.triangles), {});
  terrain.motion = Motion::Static;
  scene.bodies.push_back(terrain);
  constexpr int kCorners = 250;
  std::vector<Vec3> points;
  for (int k = 0; k < kCorners; ++k) {
    const double z = 1 - (2. * k + 1) / kCorners, angle = 2.4 * k, r = std::sqrt(1 - z * z);
    points.push_back({r * std::cos(angle), r * std::sin(angle), z});
  }
  scene.bodies.push_back(test::body(Shape::hull(points), {20, 0, 6.5}));
  std::vector<ShapePartDef> parts(500);
  for (std::size_t k = 0; k < parts.size(); ++k)
    parts[k].shape = Shape::sphere(.1), parts[k].position = {.1 * static_cast<double>(k), 0, 0};
  scene.bodies.push_back(test::body(Shape::compound(parts), {0, 0, 9}));
  runOnSmallStack([&] { useWorldOf(scene); });
}

TEST(Stack, DoesNotGrowWithTheDepthOfAFile) {
  for (const std::string& text : {std::string(1 << 20, '['), "{\"bodies\": " + std::string(1 << 20, '[')})
    runOnSmallStack([&] {
      std::vector<io::Fault> faults;
      io::parseScene(text, faults);
      EXPECT_FALSE(faults.empty());
    });
}

}  // namespace
}  // namespace rubble
