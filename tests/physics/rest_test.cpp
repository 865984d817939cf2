/// Bodies at rest stay at rest: friction stops every spin, and round-off decides nothing.
#include <gtest/gtest.h>
#include <scenes/registry.h>

#include <algorithm>

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

/// Friction stops a spin of 5 rad/s within 0.24 s, and it stays stopped.
TEST(Friction, BringsASpinningCubeToRest) {
  for (const int iterations : {4, 10, 50})
    EXPECT_LT(std::fabs(spinAfterASecond(iterations)), .01) << iterations;
}

/// Largest distance of a body between single and double precision after ten steps [m].
double precisionGap(const std::string& name) {
  const scenes::Spec& spec = scenes::find(name);
  const auto runner = [&](const std::string& backend) {
    scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
    const WorldOptions options = test::options(job.iterations, backend);
    return scenes::Runner(std::move(job), options);
  };
  scenes::Runner cpu = runner("cpu"), reference = runner("reference");
  for (int i = 0; i < 10; ++i) cpu.step(), reference.step();
  double worst = 0;
  for (const BodyId id : cpu.world().bodies())
    worst = std::max(worst, length(cpu.world().state(id).position - reference.world().state(id).position));
  return worst;
}

/// Round-off moves no structure at rest. The sign of a gap of zero decides whether a row is active.
TEST(Rest, DoesNotDependOnRoundOff) {
  for (const char* name : {"tower-20", "pyramid", "card-tower"}) EXPECT_LT(precisionGap(name), 1e-3) << name;
}

}  // namespace
}  // namespace rubble
