/// Poses from the CUDA device to OpenGL.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/render/look.h"

namespace rubble::render {
namespace {

WorldOptions quietOn(const char* backend) {
  WorldOptions options;
  options.backend = backend, options.threads = 1, options.timings = false;
  return options;
}

Scene tower() {
  Scene scene;
  BodyDef ground;
  ground.motion = Motion::Static;
  ground.shape = Shape::plane();
  scene.bodies = {ground};
  for (int i = 0; i < 200; ++i) {
    BodyDef body;
    body.position = {1.1 * (i % 10), 1.1 * (i / 10 % 5), .5 + 1.1 * (i / 50)};
    // Hulls have their center of mass elsewhere than their frame.
    if (i % 3 == 0)
      body.shape = Shape::hull({{-.4, -.4, -.4}, {.5, -.4, -.4}, {-.4, .5, -.4}, {-.4, -.4, .5}});
    scene.bodies.push_back(body);
  }
  return scene;
}

TEST(CudaPoseFeed, DrawsWhatIsDrawnBodyByBody) {
  const std::vector<std::string> all = backends();
  if (std::find(all.begin(), all.end(), "cuda") == all.end()) GTEST_SKIP() << "no CUDA device";
  HeadlessContext context;
  World world(tower(), quietOn("cuda"));
  const Camera camera{{18, -20, 12}, {5, 2, 2}, {0, 0, 1}, .5};
  Stage fed(io::pictureBodies(world), world.gravity(), camera, 320, 200),
      plain(io::pictureBodies(world), world.gravity(), camera, 320, 200);
  fed.follow(world);
  for (int i = 0; i < 30; ++i) world.step();
  fed.follow(world);
  if (fed.posesFrom() != "on the device") GTEST_SKIP() << fed.posesFrom();
  plain.setBodies(io::pictureBodies(world));
  const Likeness found = likeness(fed.picture(camera, {}), plain.picture(camera, {}));
  EXPECT_GT(found.structure, .999);
  EXPECT_LT(found.largest, 3);
}

}  // namespace
}  // namespace rubble::render
