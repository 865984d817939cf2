/// Impacts between deformable objects, particles and bodies at few iterations. Bodies that strike together
/// act with the momentum of both.
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
  for (const DeformableId id : world.deformables()) sum += momentumOf(world, id).linear.x;
  for (const BodyId id : world.bodies()) sum += world.massOf(id).mass * world.state(id).velocity.x;
  return sum;
}

/// Momentum along x after a third of a second, over that before. Things meet in that time, without rebound,
/// so that energy is lost. Steps in which vertices are held where they are, so that surfaces do not cross,
/// are left out: what is held takes no part in the exchange.
double keptMomentum(const Scene& scene, int iterations) {
  World world(scene, options(iterations));
  const double before = momentumAlongX(world), energy = world.quality().kineticEnergy;
  double change = 0;
  int leftOut = 0;
  for (int step = 0; step < 20; ++step) {
    const double last = momentumAlongX(world);
    if (world.step().heldVertices == 0)
      change += momentumAlongX(world) - last;
    else
      ++leftOut;
  }
  EXPECT_LE(leftOut, 9);
  EXPECT_LT(world.quality().kineticEnergy, .95 * energy) << "they have met";
  return 1 + change / before;
}

BodyDef heavyBox(const Vec3& center, double speed) {
  BodyDef box = body(Shape::box({.2, .2, .2}), center);
  box.mass = 30;
  box.velocity = {speed, 0, 0};
  return box;
}
TetSolidDef jelly(const Vec3& corner, double speed) {
  TetSolidDef box = test::jellyBox(corner, .4, 4);
  box.velocity = {speed, 0, 0};
  return box;
}
ParticlesDef particles(std::vector<Vec3> places, double speed) {
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
  EXPECT_NEAR(keptMomentum(scene, 4), 1, 5e-4);
  EXPECT_NEAR(keptMomentum(scene, 20), 1, 1e-4);
}

TEST_P(SoftImpact, OfASolidOnABodyKeepsMomentum) {
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {jelly({-1, -.18, -.15}, GetParam())};
  scene.bodies = {heavyBox({0, 0, 0}, 0)};
  EXPECT_NEAR(keptMomentum(scene, 4), 1, 5e-4);
  EXPECT_NEAR(keptMomentum(scene, 20), 1, 1e-4);
}

TEST_P(SoftImpact, OfTwoSolidsKeepsMomentum) {
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {jelly({-.2, -.2, -.2}, 0), jelly({-1, -.18, -.15}, GetParam())};
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .002);
}

TEST_P(SoftImpact, OfTwoParticlesKeepsMomentum) {
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {particles({{0, 0, 0}}, 0), particles({{-.4, .013, .021}}, GetParam())};
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .005);
  EXPECT_NEAR(keptMomentum(scene, 10), 1, 1e-4);
}

TEST_P(SoftImpact, OfABodyOnAParticleKeepsMomentum) {
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {particles({{0, .01, .02}}, 0)};
  scene.bodies = {heavyBox({-.8, 0, 0}, GetParam())};
  scene.bodies[0].mass = 1;
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .001);
}

INSTANTIATE_TEST_SUITE_P(Speeds, SoftImpact, testing::Values(2., 20., 60.));

TEST(SoftImpact, OfAParticleOnAWallOfParticlesKeepsMomentum) {
  std::vector<Vec3> wall;
  for (int y = -1; y <= 1; ++y)
    for (int z = -1; z <= 1; ++z) wall.push_back({0, .1 * y, .1 * z});
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {particles(wall, 0), particles({{-.4, .013, .021}}, 20)};
  EXPECT_NEAR(keptMomentum(scene, 4), 1, .01);
  EXPECT_NEAR(keptMomentum(scene, 20), 1, 5e-4);
}

/// A solid that is alone, pressed and sheared, springs back to its shape and stays where it is.
TEST(SoftMomentum, OfASolidThatIsAloneIsKept) {
  TetSolidDef box = test::jellyBox({0, 0, 0}, .4, 4, 1e4);
  for (const Vec3& x : box.vertices)
    box.start.push_back({1.3 * x.x + .3 * x.y * x.y, .8 * x.y + .2 * x.z, x.z + .4 * x.x * x.x});
  Scene scene = emptyScene({0, 0, 0});
  scene.deformables = {box};
  World world(scene, options(4));
  const DeformableId id = world.deformableAt(0);
  double fastest = 0, drift = 0;
  for (int step = 0; step < 60; ++step) {
    world.step();
    for (const Vec3& v : world.velocities(id)) fastest = std::max(fastest, length(v));
    const test::Momentum p = momentumOf(world, id);
    drift = std::max(drift, length(p.linear) / p.mass);
  }
  EXPECT_GT(fastest, 1) << "it springs back";
  EXPECT_LT(drift, 1e-4 * fastest);
}

/// A pinned sheet is in no aggregate. Its pins bear a body that falls on it, and no aggregate moves that
/// body along.
TEST(SoftImpact, OnAPinnedSheetEndsInItsWeight) {
  ClothDef sheet = clothSheet({-.5, -.5, 0}, {1, 0, 0}, {0, 1, 0}, 8, 8);
  for (int v = 0; v < static_cast<int>(sheet.vertices.size()); ++v)
    if (const int column = v % 9, row = v / 9; column % 8 == 0 || row % 8 == 0) sheet.fixed.push_back(v);
  Scene scene = emptyScene();
  scene.deformables = {sheet};
  BodyDef ball = body(Shape::sphere(.1), {.02, .03, .4});
  ball.velocity = {0, 0, -5};
  ball.mass = 1;
  scene.bodies = {ball};
  World world(scene, options(10));
  double lowest = 1, force = 0;
  constexpr int kSteps = 300, kLast = 60;
  for (int k = 0; k < kSteps; ++k) {
    world.step();
    lowest = std::min(lowest, world.state(world.bodyAt(0)).position.z);
    if (k < kSteps - kLast) continue;
    for (const VertexContact& c : world.vertexContacts()) force -= c.force.z / kLast;
  }
  EXPECT_GT(lowest, -.3) << "it does not go through";
  EXPECT_NEAR(force, 10, .5) << "mean of the last second";
}

}  // namespace
}  // namespace rubble
