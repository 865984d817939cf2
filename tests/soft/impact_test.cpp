/// Impacts between deformable objects, particles and bodies, at few iterations: what strikes together has the momentum of both.
#include <gtest/gtest.h>

#include "tests/soft/soft_scenes.h"

namespace rubble {
namespace {

using test::body;
using test::emptyScene;
using test::momentumOf;
using test::options;

/// Momentum of everything along x.
double momentumAlongX(const World& world) {
  double sum = 0;
  for (const SoftId id : world.deformables()) sum += momentumOf(world, id).linear.x;
  for (const BodyId id : world.bodies()) sum += world.massOf(id).mass * world.state(id).velocity.x;
  return sum;
}

/// Momentum along x after a third of a second, over that before.
double keptMomentum(const Scene& scene, int iterations) {
  World world(scene, options(iterations));
  const double before = momentumAlongX(world);
  test::run(world, 20);
  return momentumAlongX(world) / before;
}

BodyDef heavyBox(const Vec3& centre, double speed) {
  BodyDef box = body(Shape::box({.2, .2, .2}), centre);
  box.mass = 30;
  box.velocity = {speed, 0, 0};
  return box;
}
SoftDef jelly(const Vec3& corner, double speed) {
  SoftDef box = test::jellyBox(corner, .4, 4);
  box.velocity = {speed, 0, 0};
  return box;
}
ParticlesDef grains(std::vector<Vec3> places, double speed) {
  ParticlesDef def;
  def.radius = .05;
  def.vertices = std::move(places);
  def.velocity = {speed, 0, 0};
  return def;
}

class SoftImpact : public testing::TestWithParam<double> {};

TEST_P(SoftImpact, OfABodyOnASolidKeepsMomentum) {
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {jelly({-.2, -.2, -.2}, 0)};
  scene.bodies = {heavyBox({-.8, .02, .05}, GetParam())};
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .08);
  EXPECT_NEAR(keptMomentum(scene, 20), 1, .005);
}

TEST_P(SoftImpact, OfASolidOnABodyKeepsMomentum) {
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {jelly({-1, -.18, -.15}, GetParam())};
  scene.bodies = {heavyBox({0, 0, 0}, 0)};
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .05);
  EXPECT_NEAR(keptMomentum(scene, 20), 1, .005);
}

TEST_P(SoftImpact, OfTwoSolidsKeepsMomentum) {
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {jelly({-.2, -.2, -.2}, 0), jelly({-1, -.18, -.15}, GetParam())};
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .005);
}

TEST_P(SoftImpact, OfTwoGrainsKeepsMomentum) {
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {grains({{0, 0, 0}}, 0), grains({{-.4, .013, .021}}, GetParam())};
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .1);
  EXPECT_NEAR(keptMomentum(scene, 10), 1, .005);
}

TEST_P(SoftImpact, OfABodyOnAGrainKeepsMomentum) {
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {grains({{0, .01, .02}}, 0)};
  scene.bodies = {heavyBox({-.8, 0, 0}, GetParam())};
  scene.bodies[0].mass = 1;
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .05);
}

INSTANTIATE_TEST_SUITE_P(Speeds, SoftImpact, testing::Values(2., 20., 60.));

TEST(SoftImpact, OfAGrainOnAWallOfGrainsKeepsMomentum) {
  std::vector<Vec3> wall;
  for (int y = -1; y <= 1; ++y)
    for (int z = -1; z <= 1; ++z) wall.push_back({0, .1 * y, .1 * z});
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {grains(wall, 0), grains({{-.4, .013, .021}}, 20)};
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .12);
  EXPECT_NEAR(keptMomentum(scene, 20), 1, .005);
}

/// The ground takes part in what a heap on it does: a group that reaches to it does not fly.
TEST(SoftImpact, OnAPinnedSheetIsBorneByItsPins) {
  ClothDef sheet = clothSheet({-.5, -.5, 0}, {1, 0, 0}, {0, 1, 0}, 8, 8);
  for (int i = 0; i <= 8; ++i)
    for (const int v : {i, 72 + i, 9 * i, 9 * i + 8}) sheet.fixed.push_back(v);
  std::sort(sheet.fixed.begin(), sheet.fixed.end());
  sheet.fixed.erase(std::unique(sheet.fixed.begin(), sheet.fixed.end()), sheet.fixed.end());
  Scene scene = emptyScene({0, 0, -10});
  scene.deformables = {sheet};
  BodyDef ball = body(Shape::sphere(.1), {.02, .03, .4});
  ball.velocity = {0, 0, -5};
  ball.mass = 1;
  scene.bodies = {ball};
  World world(scene, options(10));
  double lowest = 1;
  for (int k = 0; k < 120; ++k) {
    world.step();
    lowest = std::min(lowest, world.state(world.bodyAt(0)).position.z);
  }
  EXPECT_GT(lowest, -.3) << "it does not go through";
  EXPECT_GT(world.state(world.bodyAt(0)).position.z, -.3);
}

}  // namespace
}  // namespace rubble
