/// Contact of surfaces of deformable objects, and that they do not cross.
#include <gtest/gtest.h>
#include <scenes/soft_probes.h>
#include <scenes/surface_exact.h>

#include "tests/soft/soft_scenes.h"

namespace rubble {
namespace {

using namespace test;

World::Surface triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  World::Surface s;
  s.vertices = {a, b, c};
  s.triangles = {{0, 1, 2}};
  return s;
}

TEST(Crossings, AreCountedByTheExactTest) {
  const World::Surface flat = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(scenes::countCrossings(std::vector{flat, triangle({.2, .2, -1}, {.2, .2, 1}, {5, 5, 0})}), 2);
  EXPECT_EQ(scenes::countCrossings(std::vector{flat, triangle({.2, .2, 1e-9}, {.3, .2, 1}, {5, 5, 1})}), 0);
  EXPECT_GT(scenes::countCrossings(std::vector{flat, triangle({.2, .2, 0}, {.3, .2, 1}, {5, 5, 1})}), 0)
      << "a corner that touches";
  EXPECT_EQ(scenes::countCrossings(std::vector{flat, triangle({2, 0, 0}, {3, 0, 0}, {2, 1, 0})}), 0)
      << "side by side in a plane";
  EXPECT_GT(scenes::countCrossings(std::vector{flat, triangle({.1, .1, 0}, {3, 0, 0}, {2, 1, 0})}), 0)
      << "overlapping in a plane";
}

TEST(Crossings, LinkingNumberOfTwoRings) {
  std::vector<Vec3> a, b, far;
  for (int i = 0; i < 12; ++i) {
    const double t = 2 * std::numbers::pi * i / 12;
    a.push_back({std::cos(t), std::sin(t), 0});
    b.push_back({1 + std::cos(t), 0, std::sin(t)});
    far.push_back({5 + std::cos(t), 0, std::sin(t)});
  }
  EXPECT_NEAR(std::fabs(scenes::linkingNumber(a, b)), 1, 1e-9);
  EXPECT_NEAR(scenes::linkingNumber(a, far), 0, 1e-9);
}

ClothDef sheetAt(double z, int cells = 4, double size = .4) {
  ClothDef sheet = clothSheet({-size / 2, -size / 2, z}, {size, 0, 0}, {0, size, 0}, cells, cells);
  sheet.thickness = 2e-3;
  return sheet;
}

TEST(Surfaces, AFastFlightInCloseFormationIsNotTouched) {
  // 3 mm apart at 40 m/s: sheets go 200 times that in a step
  const auto flown = [](bool collide) {
    Scene scene = emptyScene({0, 0, -10});
    for (int i = 0; i < 4; ++i) {
      ClothDef sheet = sheetAt(5e-3 * i);
      sheet.velocity = {40, 0, -5};
      sheet.collideSurface = sheet.collideSelf = collide;
      scene.deformables.push_back(sheet);
    }
    World world(scene, options(4));
    int touched = 0;
    for (int i = 0; i < 30; ++i) {
      const StepReport report = world.step();
      touched += report.deflectedVertices + report.heldVertices;
    }
    EXPECT_EQ(touched, 0);
    std::vector<Vec3> out;
    for (int i = 0; i < 4; ++i)
      for (const Vec3& x : world.positions(world.deformableAt(i))) out.push_back(x);
    return out;
  };
  const std::vector<Vec3> with = flown(true), without = flown(false);
  double worst = 0;
  for (std::size_t i = 0; i < with.size(); ++i) worst = std::max(worst, length(with[i] - without[i]));
  EXPECT_LT(worst, 1e-6);
}

TEST(Surfaces, ASheetRestsOnAnotherByItsThicknessAndItsWeight) {
  Scene scene = emptyScene({0, 0, -10});
  ClothDef table = sheetAt(0, 4, .6), sheet = sheetAt(3e-3);
  for (int v = 0; v < static_cast<int>(table.vertices.size()); ++v) table.fixed.push_back(v);
  table.collideSelf = false;
  scene.deformables = {table, sheet};
  World world(scene, options(10));
  run(world, 180);
  const DeformableId top = world.deformableAt(1);
  double weight = 0, lift = 0;
  for (const double m : world.masses(top)) weight += 10 * m;
  for (const VertexContact& c : world.vertexContacts()) lift += std::fabs(c.force.z);
  EXPECT_NEAR(lift / weight, 1, .02);
  for (const Vec3& x : world.positions(top)) EXPECT_NEAR(x.z, 2e-3, 1e-4);
}

/// Two balls thrown at one another.
Scene thrown(double speed) {
  Scene scene = emptyScene({0, 0, 0});
  for (const double side : {-1., 1.}) {
    TetSolidDef ball = tetBall({.22 * side, .05 * side, 0}, .2, 4);
    ball.youngsModulus = 2e4;
    ball.density = 300;
    ball.velocity = {-speed * side, 0, 0};
    // parts that are stopped must not be run through by the rest of their ball
    ball.collideSelf = true;
    scene.deformables.push_back(ball);
  }
  return scene;
}

TEST(Surfaces, OfATangleAreDealtWithInABoundedNumberOfRounds) {
  for (const double size : {.05, .3, 1.}) {
    ClothDef sheet = clothSheet({-.5, -.5, 0}, {1, 0, 0}, {0, 1, 0}, 12, 12);
    sheet.thickness = 4e-3;
    Random random(3);
    for (std::size_t i = 0; i < sheet.vertices.size(); ++i) sheet.start.push_back(random.vector(size));
    World world(sceneWith(sheet), options(4));
    const auto parts = static_cast<double>(sheet.vertices.size() + 3 * 12 * 12 + 2 * 12);
    for (int i = 0; i < 5; ++i) {
      const StepReport report = world.step();
      // 20 rounds that change ways, 8 that cut them, 4 in which objects stay, and one for the rest
      EXPECT_LE(report.surfaceRounds, 33);
      // those that change ways look at 640 pairs for each vertex and edge, the 13 others and the first at
      // each pair once
      EXPECT_LE(static_cast<double>(report.surfaceTests), 640 * parts + 15 * parts * parts / 2)
          << "step " << i;
    }
    for (const Vec3& x : world.positions(world.deformableAt(0))) ASSERT_TRUE(std::isfinite(x.x + x.y + x.z));
  }
}

TEST(Surfaces, BallsThatCollideKeepTheirMomentumAndDoNotCross) {
  for (const double speed : {2., 4., 10.}) {
    World world(thrown(speed), options(10));
    int held = 0;
    const auto momentum = [&] {
      return momentumOf(world, world.deformableAt(0)).linear +
             momentumOf(world, world.deformableAt(1)).linear;
    };
    const double before = length(momentumOf(world, world.deformableAt(0)).linear),
                 energy = world.quality().kineticEnergy;
    for (int i = 0; i < 45; ++i) {
      held += world.step().heldVertices;
      ASSERT_EQ(scenes::countCrossings(world), 0) << "step " << i << " at " << speed << " m/s";
    }
    // what is held where it is, so that nothing crosses, takes no part in the exchange
    EXPECT_LT(length(momentum()) / before, held > 0 ? .05 : .01) << speed;
    EXPECT_TRUE(held == 0 || speed == 2) << "held at " << speed << " m/s";
    EXPECT_LT(world.quality().kineticEnergy, energy) << speed;
    if (speed == 2) {
      EXPECT_GT(momentumOf(world, world.deformableAt(1)).linear.x, 0) << "they bounce off";
    }
  }
}

TEST(Surfaces, AFastSheetDoesNotPassThroughAnother) {
  for (const double speed : {5., 20., 80.}) {
    Scene scene = emptyScene({0, 0, 0});
    ClothDef net = sheetAt(0, 6, .6), shot = sheetAt(.3, 3, .2);
    for (int i = 0; i <= 6; ++i)
      for (const int v : {i, 42 + i, 7 * i, 7 * i + 6}) net.fixed.push_back(v);
    std::sort(net.fixed.begin(), net.fixed.end());
    net.fixed.erase(std::unique(net.fixed.begin(), net.fixed.end()), net.fixed.end());
    shot.velocity = {0, 0, -speed};
    scene.deformables = {net, shot};
    World world(scene, options(6));
    for (int i = 0; i < 60; ++i) {
      world.step();
      ASSERT_EQ(scenes::countCrossings(world), 0) << "step " << i << " at " << speed << " m/s";
    }
    EXPECT_EQ(world.quality().kineticEnergy - world.quality().kineticEnergy, 0) << "finite";
  }
}

/// A sheet that folds over an edge of itself, from where it has to start.
Scene folding() {
  ClothDef strip = clothSheet({-.05, 0, .03}, {.1, 0, 0}, {0, .04, .5}, 3, 15);
  strip.thickness = 2e-3;
  Scene scene = sceneWith(strip);
  scene.bodies.push_back(ground());
  return scene;
}

TEST(Surfaces, AStripThatFoldsDoesNotCrossItself) {
  World world(folding(), options(8));
  for (int i = 0; i < 240; ++i) {
    world.step();
    ASSERT_EQ(scenes::countCrossings(world), 0) << "step " << i;
  }
  Scene free = folding();
  std::get<ClothDef>(free.deformables[0]).collideSelf = false;
  World crossing(free, options(8));
  int crossings = 0;
  for (int i = 0; i < 240; ++i) {
    crossing.step();
    crossings = std::max(crossings, scenes::countCrossings(crossing));
  }
  EXPECT_GT(crossings, 0) << "without contact it does: the scene tests something";
}

TEST(Surfaces, HaveTheSameBitsAtAnyNumberOfThreads) {
  World world(folding(), options(8, "lockstep"));
  run(world, 120);
  EXPECT_EQ(world.firstDifference(), "");
}

TEST(Surfaces, ASnapshotContinuesAsItWas) {
  World world(folding(), options(8));
  run(world, 90);
  const Snapshot middle = world.snapshot();
  run(world, 30);
  const std::uint64_t end = world.hash();
  world.restore(middle);
  run(world, 30);
  EXPECT_EQ(world.hash(), end);
}

TEST(Surfaces, KeepTheirContactsWhenAnotherObjectComesAndGoes) {
  Scene scene = emptyScene({0, 0, -10});
  ClothDef table = sheetAt(0, 4, .6), sheet = sheetAt(3e-3), other = sheetAt(5);
  other.gravityScale = 0;
  for (int v = 0; v < static_cast<int>(table.vertices.size()); ++v) table.fixed.push_back(v);
  scene.deformables = {other, table, sheet};
  World world(scene, options(10));
  run(world, 120);
  const auto lift = [&] {
    double sum = 0;
    for (const VertexContact& c : world.vertexContacts()) sum += std::fabs(c.force.z);
    return sum;
  };
  const double before = lift();
  world.removeDeformable(world.deformableAt(0));
  EXPECT_NEAR(lift(), before, 1e-9 * before);
  world.addDeformable(Deformable{other});
  world.step();
  EXPECT_NEAR(lift(), before, .02 * before);
}

TEST(Surfaces, ThatWereAloneMeetThoseThatComeLater) {
  ClothDef table = sheetAt(0, 4, .6);
  for (int v = 0; v < static_cast<int>(table.vertices.size()); ++v) table.fixed.push_back(v);
  Scene scene = emptyScene({0, 0, -10});
  scene.deformables = {table};
  World world(scene, options(10));
  run(world, 10);
  const DeformableId sheet = world.addDeformable(Deformable{sheetAt(3e-3)});
  run(world, 120);
  const auto lowest = [&] {
    double z = 1;
    for (const Vec3& x : world.positions(sheet)) z = std::min(z, x.z);
    return z;
  };
  EXPECT_FALSE(world.vertexContacts().empty());
  EXPECT_GT(lowest(), 0);
  world.removeDeformable(world.deformableAt(0));
  run(world, 30);
  EXPECT_TRUE(world.vertexContacts().empty());
  EXPECT_LT(lowest(), -.3);
}

TEST(Surfaces, KeepTheirLoadWhenTheirTrianglesAreListedInAnotherOrder) {
  // a sheet that rests on a fixed one: the load on the features of both, one step later
  const auto loadAfter = [](bool changes) {
    ClothDef floor = sheetAt(0), sheet = sheetAt(4e-3, 6, 0.5);
    for (std::size_t i = 0; i < floor.vertices.size(); ++i) floor.fixed.push_back(static_cast<int>(i));
    floor.collideSurface = sheet.collideSurface = true;
    Scene scene = emptyScene({0, 0, -10});
    scene.deformables = {floor, sheet};
    World world(scene, options(4));
    for (int i = 0; i < 60; ++i) world.step();
    for (int i = 0; changes && i < 2; ++i) {
      ClothDef other = std::get<ClothDef>(world.definition(world.deformableAt(i)));
      std::ranges::reverse(other.triangles);
      world.setDefinition(world.deformableAt(i), other);
    }
    Params params = world.params();
    params.iterations = 1;
    world.setParams(params);
    world.step();
    double load = 0;
    for (const VertexContact& c : world.vertexContacts()) load += std::fabs(c.force.z);
    return load;
  };
  const double load = loadAfter(false);
  EXPECT_GT(load, 0);
  EXPECT_NEAR(loadAfter(true), load, 0.02 * load);
}

TEST(Surfaces, ATornSheetLetsThrough) {
  // the hole is where the triangles in the middle are gone
  ClothDef sheet = sheetAt(0, 8, .8);
  sheet.tearStretch = 1.2, sheet.youngsModulus = 1e4;
  for (int i = 0; i <= 8; ++i)
    for (const int v : {9 * i, 9 * i + 8}) sheet.fixed.push_back(v);
  Scene scene = sceneWith(sheet, {0, 0, 0});
  World world(scene, options(10));
  const DeformableId id = world.deformableAt(0);
  int broken = 0;
  for (int i = 0; i < 60; ++i) {
    world.applyVertexForce(id, 40, {0, 0, -30});
    broken += world.step().brokenJoints;
  }
  EXPECT_GT(broken, 0);
  EXPECT_EQ(scenes::countCrossings(world), 0);
}

}  // namespace
}  // namespace rubble
