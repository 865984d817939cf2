/// Bars that the engine does not reach yet. A test that passes moves to the file of its subject.
#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

/// Spin of a cube on the ground after a second, from 5 rad/s about its vertical axis [rad/s].
double spinAfterASecond(int iterations) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground(.5));
  BodyDef cube = test::unitCube({0, 0, .5}, .5);
  cube.angularVelocity = {0, 0, 5};
  scene.bodies.push_back(cube);
  World world(scene, test::options(iterations));
  test::run(world, 60);
  return world.state(world.bodyAt(1)).angularVelocity.z;
}

/// Friction stops a spin of 5 rad/s within .24 s, and it stays stopped.
TEST(Friction, BringsASpinningCubeToRest) {
  for (const int iterations : {4, 10, 50}) EXPECT_LT(std::fabs(spinAfterASecond(iterations)), .01) << iterations;
}

}  // namespace
}  // namespace rubble
