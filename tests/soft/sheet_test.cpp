/// Cloth, nets, rods, attachments and granular particles.
#include <gtest/gtest.h>
#include <rubble/error.h>

#include "tests/soft/soft_scenes.h"

namespace rubble {
namespace {

using namespace test;

double longestEdge(const World& world) {
  const World::Surface s = world.surface(world.deformableAt(0));
  const std::vector<Vec3>& rest = common(world.definition(s.id)).vertices;
  double worst = 0;
  for (const auto& t : s.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(t[k]), b = static_cast<std::size_t>(t[(k + 1) % 3]);
      worst = std::max(worst, length(s.vertices[a] - s.vertices[b]) / length(rest[a] - rest[b]));
    }
  return worst;
}

TEST(Cloth, HangsFromTwoCornersWithoutStretchingMuch) {
  ClothDef cloth = clothSheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 16, 16);
  cloth.fixed = {0, 16};
  World world(sceneWith(cloth), options(10));
  run(world, 300);
  EXPECT_LT(longestEdge(world), 1.08);
  double lowest = 0;
  for (const Vec3& x : world.positions(world.deformableAt(0))) lowest = std::min(lowest, x.z);
  EXPECT_LT(lowest, -.85);
}

TEST(Cloth, StripStretchesUnderItsLoadAsItsModulusSays) {
  // 1 m long, 0.1 m wide, E h w = 1000 N; the load comes on slowly, since a blow would fold the strip
  ClothDef strip = clothSheet({0, 0, 0}, {0, 0, -1}, {.1, 0, 0}, 10, 1);
  strip.youngsModulus = 1e7, strip.thickness = 1e-3, strip.poissonRatio = 0, strip.density = 100;
  strip.collide = false;
  strip.fixed = {0, 11};
  World world(sceneWith(strip), options(20));
  const DeformableId id = world.deformableAt(0);
  for (int i = 0; i < 500; ++i) {
    const double load = 50 * std::min(1., i / 300.);
    world.applyVertexForce(id, 10, {0, 0, -load});
    world.applyVertexForce(id, 21, {0, 0, -load});
    world.step();
  }
  // stretch s with E h w s (s^2 - 1)/2 = F; its own weight adds less than 1e-4
  double s = 1;
  for (int i = 0; i < 50; ++i) s -= (1000 * s * (s * s - 1) / 2 - 100.) / (1000 * (3 * s * s - 1) / 2);
  EXPECT_NEAR(-world.positions(id)[10].z, s, 1e-3);
}

TEST(Cloth, TearsWhereItIsStretchedTooFar) {
  ClothDef cloth = clothSheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 8, 8);
  cloth.tearStretch = 1.3, cloth.density = 1000, cloth.thickness = 1e-3, cloth.youngsModulus = 1e5;
  for (int i = 0; i <= 8; ++i) cloth.fixed.push_back(9 * i);
  World world(sceneWith(cloth, {0, 0, 0}), options(10));
  const DeformableId id = world.deformableAt(0);
  int broken = 0;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j <= 8; ++j) world.applyVertexForce(id, 9 * j + 8, {20, 0, 0});
    broken += world.step().brokenJoints;
  }
  EXPECT_GT(broken, 0);
  EXPECT_EQ(world.surface(id).triangles.size() + static_cast<std::size_t>(broken), cloth.triangles.size());
}

TEST(Cloth, CarriesABoxAndTheBoxFeelsIt) {
  ClothDef sheet = clothSheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 12, 12);
  sheet.thickness = 4e-3, sheet.youngsModulus = 2e6;
  for (std::size_t i = 0; i < sheet.vertices.size(); ++i)
    if (std::fabs(sheet.vertices[i].x) > .999 || std::fabs(sheet.vertices[i].y) > .999)
      sheet.fixed.push_back(static_cast<int>(i));
  Scene scene = sceneWith(sheet);
  BodyDef box = body(Shape::box({.25, .25, .25}), {0, 0, .4});
  box.mass = 20;
  scene.bodies.push_back(box);
  World world(scene, options(10));
  run(world, 360);
  double lift = 0;
  for (const VertexContact& c : world.vertexContacts()) lift -= c.force.z;
  EXPECT_NEAR(lift, 200, 4);
  EXPECT_NEAR(world.state(world.bodyAt(0)).velocity.z, 0, .01);
  EXPECT_GT(world.state(world.bodyAt(0)).position.z, -.4);
}

NetDef chainOfSprings(double ratio) {
  NetDef net;
  net.masses = {1};
  net.collide = false;
  for (int i = 0; i <= 11; ++i) net.vertices.push_back({static_cast<double>(i), 0, 0});
  net.fixed = {0, 11};
  for (int i = 0; i < 11; ++i) net.edges.push_back({i, i + 1, i % 2 ? 100. : 100. * ratio});
  return net;
}

TEST(Net, SpringsOfVeryDifferentStiffnessFollowTheConvergedMotion) {
  const auto worst = [](int iterations) {
    World world(sceneWith(chainOfSprings(1e4)), options(iterations)),
        converged(sceneWith(chainOfSprings(1e4)), options(1000, "reference"));
    double largest = 0;
    for (int i = 0; i < 200; ++i) {
      world.step(), converged.step();
      const std::vector<Vec3> a = world.positions(world.deformableAt(0)),
                              b = converged.positions(converged.deformableAt(0));
      for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, length(a[k] - b[k]));
    }
    return largest;
  };
  EXPECT_LT(worst(10), .05);
  EXPECT_LT(worst(5), .3);
}

TEST(Net, SpringSettlesAtHookesLaw) {
  NetDef net;
  net.vertices = {{0, 0, 0}, {0, 0, -1}};
  net.masses = {2};
  net.fixed = {0};
  net.edges = {{0, 1, 500, 30}};
  World world(sceneWith(net), options(10));
  run(world, 600);
  EXPECT_NEAR(world.positions(world.deformableAt(0))[1].z, -1 - 2 * 10 / 500., 1e-4);
}

TEST(Net, SpringBreaksAboveItsThreshold) {
  for (const double load : {15., 25.}) {
    NetDef net;
    net.vertices = {{0, 0, 0}, {0, 0, -1}};
    net.masses = {load / 10};
    net.fixed = {0};
    net.edges = {{0, 1, 1e4, 200}};
    net.breakForce = 20;
    World world(sceneWith(net), options(20));
    // the load comes on slowly
    world.setGravity({0, 0, 0});
    int broken = 0;
    for (int i = 0; i < 200; ++i) {
      world.setGravity({0, 0, -std::min(10., .1 * i)});
      broken += world.step().brokenJoints;
    }
    EXPECT_EQ(broken, load > 20 ? 1 : 0) << load;
  }
}

TEST(Rod, HoldsAHeavyLoadAtItsEnd) {
  Scene scene = emptyScene();
  BodyDef load = body(Shape::box({.1, .1, .1}), {1, 0, -.1});
  load.mass = 5;
  scene.bodies.push_back(load);
  CableDef rope = straightCable({0, 0, 0}, {1, 0, 0}, 20);
  rope.youngsModulus = 1e8;
  rope.fixed = {0};
  scene.deformables.push_back(rope);
  AttachmentDef hook;
  hook.vertices = {20};
  hook.body = 0;
  scene.attachments.push_back(hook);
  World world(scene, options(10));
  double longest = 0, gap = 0;
  for (int i = 0; i < 300; ++i) {
    world.step();
    const std::vector<Vec3> x = world.positions(world.deformableAt(0));
    double sum = 0;
    for (std::size_t k = 0; k + 1 < x.size(); ++k) sum += length(x[k + 1] - x[k]);
    longest = std::max(longest, sum);
    gap = std::max(gap, world.quality().jointGapMax);
  }
  // the load is 300 times as heavy as the rope between two vertices
  EXPECT_LT(longest, 1.05);
  EXPECT_LT(gap, .005);
}

TEST(Rod, CantileverBendsAsBeamTheorySays) {
  CableDef rod = straightCable({0, 0, 0}, {1, 0, 0}, 20);
  rod.radius = .02, rod.youngsModulus = 1e8, rod.density = 500;
  rod.fixed = {0, 1};
  World world(sceneWith(rod), options(20));
  run(world, 600);
  const double area = 3.141592653589793 * rod.radius * rod.radius,
               inertia = area * rod.radius * rod.radius / 4;
  // the bend at the second vertex stands for the half segments beside it
  const double exact = rod.density * area * 10 * std::pow(.975, 4) / (8 * rod.youngsModulus * inertia);
  EXPECT_NEAR(-world.positions(world.deformableAt(0))[20].z, exact, .06 * exact);
}

TEST(Attachment, RefusesWeightsThatAreNoMean) {
  Scene scene = sceneWith(clothSheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1, 1));
  AttachmentDef hook;
  hook.vertices = {0, 1};
  scene.attachments.push_back(hook);
  const auto refused = [&](const std::vector<double>& weights) {
    scene.attachments[0].weights = weights;
    try {
      World world(scene, options(1));
    } catch (const Error& e) {
      return e.path();
    }
    return std::string("no error");
  };
  EXPECT_EQ(refused({.5, .5}), "no error");
  EXPECT_EQ(refused({.5, .4}), "attachments[0].vertices");
  EXPECT_EQ(refused({1.5, -.5}), "attachments[0].vertices");
  EXPECT_EQ(refused({1}), "attachments[0].vertices");
}

TEST(Attachment, HoldsAVertexOnABodyOnTheWorldAndOnAnotherObject) {
  Scene scene = emptyScene();
  for (int i = 0; i < 2; ++i) {
    ClothDef strip = clothSheet({.5 * i, 0, 0}, {.5, 0, 0}, {0, .2, 0}, 5, 2);
    strip.collide = false;
    scene.deformables.push_back(strip);
  }
  BodyDef box = body(Shape::box({.1, .1, .1}), {1.1, .1, 0});
  box.mass = .5;
  scene.bodies.push_back(box);
  for (int j = 0; j < 3; ++j) {
    AttachmentDef wall, seam, hook;
    wall.vertices = {6 * j};
    seam.vertices = {6 * j + 5}, seam.otherObject = 1, seam.otherVertices = {6 * j};
    hook.object = 1, hook.vertices = {6 * j + 5}, hook.body = 0;
    for (const AttachmentDef& a : {wall, seam, hook}) scene.attachments.push_back(a);
  }
  World world(scene, options(10));
  const auto momentum = [&] {
    return momentumOf(world, world.deformableAt(0)).linear.z +
           momentumOf(world, world.deformableAt(1)).linear.z + .5 * world.state(world.bodyAt(0)).velocity.z;
  };
  const double mass = .5 + momentumOf(world, world.deformableAt(0)).mass +
                      momentumOf(world, world.deformableAt(1)).mass;
  // the box swings: the wall bears its weight and changes its momentum
  constexpr int kSteps = 300;
  constexpr double kDt = 1. / 60;
  double impulse = 0;
  for (int k = 0; k < kSteps; ++k) {
    world.step();
    for (std::size_t j = 0; j < 9; j += 3) impulse += kDt * world.state(world.attachments()[j]).force.z;
  }
  for (const AttachmentId id : world.attachments()) EXPECT_LT(world.state(id).gap, 2e-3);
  EXPECT_NEAR(impulse - momentum(), 10 * mass * kSteps * kDt, .02 * 10 * mass * kSteps * kDt);
}

TEST(Attachment, BreaksAboveItsThreshold) {
  Scene scene = sceneWith(jellyBox({-.1, -.1, -.2}, .2, 2));
  AttachmentDef hook;
  hook.vertices = {22};
  hook.breakForce = 40;
  scene.attachments.push_back(hook);
  World world(scene, options(10));
  run(world, 120);
  // it weighs 80 N
  EXPECT_TRUE(world.state(world.attachments()[0]).broken);
  EXPECT_LT(momentumOf(world, world.deformableAt(0)).center.z, -2);
}

TEST(Particles, SlideAndStopAsCoulombSays) {
  Scene scene = emptyScene();
  scene.bodies.push_back(ground(.5));
  ParticlesDef particle;
  particle.vertices = {{0, 0, .05}};
  particle.radius = .05;
  particle.material = {.5, .5, 0};
  particle.velocity = {3, 0, 0};
  scene.deformables.push_back(particle);
  World world(scene, options(4));
  run(world, 120);
  const double exact = 9. / (2 * .5 * 10) - 3. / 120;
  EXPECT_NEAR(world.positions(world.deformableAt(0))[0].x, exact, .02 * exact);
}

TEST(Particles, AHeapRestsWithoutOverlap) {
  Scene scene = emptyScene();
  scene.bodies.push_back(ground());
  ParticlesDef sand;
  sand.radius = .02;
  for (int z = 0; z < 8; ++z)
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 6; ++x)
        sand.vertices.push_back({.041 * x + .003 * (z % 3), .041 * y + .002 * (z % 2), .02 + .041 * z});
  scene.deformables.push_back(sand);
  World world(scene, options(4));
  run(world, 240);
  const Quality q = world.quality();
  EXPECT_LT(q.penetration.p99, .1 * sand.radius);
  EXPECT_LT(q.kineticEnergy, .02);
}

/// One whose box is far larger than a cell lies on another level of their grid than the one that it meets.
TEST(Particles, OfAnySpeedMeetWhatLiesInTheirWay) {
  for (const double speed : {2., 20., 90.}) {
    ParticlesDef still, shot;
    still.radius = shot.radius = .05;
    still.vertices = {{0, 0, 0}};
    shot.vertices = {{-.4, .013, .021}};
    shot.velocity = {speed, 0, 0};
    Scene scene = emptyScene({0, 0, 0});
    scene.deformables = {still, shot};
    World world(scene, options(10));
    const double before = momentumOf(world, world.deformableAt(1)).linear.x;
    run(world, 20);
    const Momentum hit = momentumOf(world, world.deformableAt(0)),
                   own = momentumOf(world, world.deformableAt(1));
    EXPECT_NEAR(hit.linear.x, .5 * before, .01 * before) << speed;
    EXPECT_NEAR(own.linear.x, .5 * before, .01 * before) << speed;
  }
}

}  // namespace
}  // namespace rubble
