/// Whole steps in single precision with few iterations against the converged step in double precision.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kConverged = 400;

struct SmallScene {
  const char* name;
  Scene scene;
  int steps;
  double at4, at10;  ///< tolerances at 4 and at 10 iterations [m]
};

SmallScene settlingBox() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::unitCube({0, 0, .51}));
  return {"settling box", scene, 120, .0005, .0001};
}

SmallScene slidingBox() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground(.5));
  scene.bodies.push_back(test::unitCube({0, 0, .5}, .5));
  scene.bodies[1].velocity = {3, 1, 0};
  return {"sliding box", scene, 60, .02, .0005};
}

SmallScene swingingChain() {
  Scene scene = test::emptyScene();
  for (int i = 0; i < 5; ++i) {
    scene.bodies.push_back(test::body(Shape::box({.25, .05, .05}), {.25 + .5 * i, 0, 0}));
    scene.joints.push_back(i == 0 ? test::ball(0, {-.25, 0, 0}, kWorld, {0, 0, 0})
                                  : test::ball(i, {-.25, 0, 0}, i - 1, {.25, 0, 0}));
  }
  return {"swinging chain", scene, 60, .1, .03};
}

SmallScene stack() { return {"stack", test::tower(4), 120, .003, .0003}; }

class AgainstReference : public ::testing::TestWithParam<SmallScene> {};

TEST_P(AgainstReference, FewIterationsStayCloseToTheConvergedStep) {
  const SmallScene& s = GetParam();
  EXPECT_LT(test::worstDistance(s.scene, test::options(4), test::options(kConverged, "reference"), s.steps),
            s.at4);
  EXPECT_LT(test::worstDistance(s.scene, test::options(10), test::options(kConverged, "reference"), s.steps),
            s.at10);
}

TEST_P(AgainstReference, MoreIterationsComeCloser) {
  const SmallScene& s = GetParam();
  const double at50 = test::worstDistance(s.scene, test::options(50, "reference"),
                                          test::options(kConverged, "reference"), s.steps);
  EXPECT_LT(at50, .25 * s.at10);
}

INSTANTIATE_TEST_SUITE_P(SmallScenes, AgainstReference,
                         ::testing::Values(settlingBox(), slidingBox(), swingingChain(), stack()),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
                           return name;
                         });

TEST(Converged, AChainKeepsItsAnchorsTogether) {
  World world(swingingChain().scene, test::options(kConverged, "reference"));
  test::run(world, 60);
  EXPECT_LT(world.quality().jointGapMax, 1e-5);
}

TEST(Converged, AHeldChainLosesNoMomentumToItsJoints) {
  // without gravity and without the world: momentum and moment of momentum of free links
  Scene scene = test::emptyScene({0, 0, 0});
  for (int i = 0; i < 5; ++i) {
    scene.bodies.push_back(test::body(Shape::box({.25, .05, .05}), {.5 * i, 0, 0}));
    if (i > 0) scene.joints.push_back(test::ball(i, {-.25, 0, 0}, i - 1, {.25, 0, 0}));
  }
  scene.bodies[4].velocity = {0, 1, 2};
  World world(scene, test::options(kConverged, "reference"));
  const auto sums = [&] {
    Vec3 momentum, spin;
    for (const BodyId id : world.bodies()) {
      const BodyState s = world.state(id);
      const MassProperties m = world.massOf(id);
      momentum += m.mass * s.velocity;
      spin += m.mass * cross(s.position, s.velocity) +
              rotate(s.orientation, mul(m.inertia, rotateInverse(s.orientation, s.angularVelocity)));
    }
    return std::pair(momentum, spin);
  };
  const auto before = sums();
  test::run(world, 60);
  const auto after = sums();
  EXPECT_TRUE(test::near(after.first, before.first, 1e-5 * length(before.first)));
  EXPECT_TRUE(test::near(after.second, before.second, .02 * length(before.second)));
}

}  // namespace
}  // namespace rubble
