/// Contact of rigid bodies with triangles and edges of surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/soft/soft_scenes.h"

namespace rubble {
namespace {

using namespace test;

/// A square of two large triangles that can not move, at height 0.
ClothDef stiffSheet() {
  ClothDef sheet = clothSheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 1, 1);
  sheet.thickness = 2e-3;
  sheet.fixed = {0, 1, 2, 3};
  return sheet;
}

BodyDef bodyOf(const Shape& shape, const Vec3& position, double density = 1000) {
  BodyDef body;
  body.shape = shape;
  body.density = density;
  body.position = position;
  return body;
}

double massOf(const World& world) {
  const BodyDef& body = world.definition(world.bodies()[0]);
  return massProperties(body.shape, body.density).mass;
}

ShapePartDef part(const Shape& shape, const Vec3& position) {
  ShapePartDef out;
  out.shape = shape, out.position = position;
  return out;
}

TEST(BodyVsSurface, EveryShapeRestsOnATriangleThatIsLargerThanItself) {
  struct Case {
    Shape shape;
    double height;  ///< of the origin of the shape above the sheet at rest [m]
  };
  const double s = .05;
  const std::vector<Case> cases{
      {Shape::box({s, s, s}), s},
      {Shape::box({s, s, s}, .01), s},
      {Shape::sphere(s), s},
      {Shape::cylinder(s, s), s},
      {Shape::cone(s, s), s},
      {Shape::hull({{s, s, -s}, {-s, s, -s}, {0, -s, -s}, {0, 0, s}}), s},
      {Shape::compound({part(Shape::box({s, s, s}), {0, 0, s}), part(Shape::sphere(s), {3 * s, 0, s})}), 0}};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Scene scene = emptyScene({0, 0, -10});
    scene.deformables.push_back(stiffSheet());
    scene.bodies.push_back(bodyOf(cases[i].shape, {-.4, .3, cases[i].height + .03}));
    World world(scene, options(4));
    run(world, 120);
    const BodyState state = world.state(world.bodies()[0]);
    EXPECT_NEAR(state.position.z, cases[i].height + 1e-3, 5e-4) << "case " << i;
    EXPECT_LT(length(state.velocity), 1e-3) << "case " << i;
    double lift = 0;
    for (const VertexContact& c : world.vertexContacts()) lift -= c.force.z;
    EXPECT_NEAR(lift, 10 * massOf(world), .01 * lift) << "case " << i;
  }
}

/// A hexagonal prism along x. Its corners are listed alternately from both ends.
Shape hexagonalPrism(double radius, double half) {
  std::vector<Vec3> points;
  for (int k = 0; k < 6; ++k)
    for (const double end : {-half, half})
      points.push_back(
          {end, radius * std::cos(k * std::numbers::pi / 3), radius * std::sin(k * std::numbers::pi / 3)});
  return Shape::hull(points);
}

/// Corners that are far apart need a row each: where two of them shared one, a body fell by millimetres now
/// and then.
TEST(BodyVsSurface, LongBodiesLieStillWhicheverSideIsDown) {
  const double slope = std::atan(.5);
  for (int turn = 0; turn < 12; ++turn) {
    const Quat roll = fromAxisAngle({0, 0, 1}, turn * std::numbers::pi / 6);
    // on its side: the tip and one point of the rim
    BodyDef cone = bodyOf(Shape::cone(.05, .05), {-.4, .3, .06});
    cone.orientation = fromAxisAngle({0, 1, 0}, std::numbers::pi / 2 + slope) * roll;
    BodyDef prism = bodyOf(hexagonalPrism(.03, .15), {-.4, .6, .04});
    prism.orientation = fromAxisAngle({1, 0, 0}, turn * std::numbers::pi / 6 + .2);
    Scene scene = emptyScene({0, 0, -10});
    scene.deformables.push_back(stiffSheet());
    scene.bodies = {cone, prism};
    World world(scene, options(4));
    run(world, 240);
    double deepest = 0, fastest = 0;
    for (int i = 0; i < 120; ++i) {
      world.step();
      for (const VertexContact& c : world.vertexContacts()) deepest = std::max(deepest, c.depth);
      for (const BodyId id : world.bodies()) fastest = std::max(fastest, length(world.state(id).velocity));
    }
    EXPECT_LT(deepest, 5e-4) << "turned by " << turn;
    EXPECT_LT(fastest, .05) << "turned by " << turn;
  }
}

/// A sheet has no inside, so a corner that has passed it does not return. The motion of its first step (2.8
/// mm) and its rotation when another corner stops are not in its velocity.
TEST(BodyVsSurface, NoHeightLetsAFallingCornerPass) {
  const double s = .05;
  const Shape tetrahedron = Shape::hull({{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}});
  for (int i = 0; i < 120; ++i) {
    Scene scene = emptyScene({0, 0, -10});
    ClothDef sheet = clothSheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2);
    sheet.thickness = 2e-3;
    sheet.fixed = {0, 1, 2, 3, 5, 6, 7, 8};
    scene.deformables.push_back(sheet);
    for (int k = 0; k < 4; ++k) {
      BodyDef body = bodyOf(k % 2 == 0 ? tetrahedron : Shape::box({s, s, s}),
                            {k < 2 ? -.4 : .4, k % 2 == 0 ? -.5 : .5, .3 + 5e-4 * i});
      body.orientation = normalize(Quat{.9, .3 * k, .02 * i, .1 * k});
      scene.bodies.push_back(body);
    }
    World world(scene, options(10));
    for (int n = 0; n < 60; ++n) world.step();
    for (const BodyId id : world.bodies()) EXPECT_GT(world.state(id).position.z, -.4) << "height " << i;
  }
}

/// The same for vertices and what is thin on the other side.
TEST(BodyVsSurface, NoHeightLetsAParticlePassASheetOfTriangles) {
  Scene scene = emptyScene({0, 0, -10});
  BodyDef plate;
  plate.motion = Motion::Static;
  plate.shape = Shape::mesh({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {{0, 1, 2}, {0, 2, 3}}, true);
  scene.bodies.push_back(plate);
  ParticlesDef particles;
  particles.radius = .001;
  for (int i = 0; i < 400; ++i)
    particles.vertices.push_back({-8. + .8 * (i % 20), -8. + .8 * (i / 20), .2 + 2e-4 * i});
  scene.deformables.push_back(particles);
  World world(scene, options(4));
  run(world, 60);
  const std::vector<Vec3> x = world.positions(world.deformableAt(0));
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_GT(x[i].z, 0) << "particle " << i;
}

TEST(BodyVsSurface, WhatSlidesOverAnEdgeTakesItsLoadAlong) {
  ClothDef sheet = clothSheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 6, 6);
  sheet.thickness = 2e-3;
  for (int v = 0; v < 49; ++v) sheet.fixed.push_back(v);
  Scene scene = emptyScene({0, 0, -10});
  scene.deformables.push_back(sheet);
  BodyDef ball = bodyOf(Shape::sphere(.05), {-.8, -.5, .05 + 1e-3});
  ball.material.staticFriction = ball.material.dynamicFriction = 0;
  ball.velocity = {1, 0, 0};
  scene.bodies.push_back(ball);
  World world(scene, options(4));
  double lowest = 1, highest = -1;
  for (int i = 0; i < 90; ++i) {
    world.step();
    const double height = world.state(world.bodies()[0]).position.z;
    if (i >= 5) lowest = std::min(lowest, height), highest = std::max(highest, height);
  }
  // it passes eight edges; if its load were lost there, it would fall by 1e-5 m at each
  EXPECT_LT(highest - lowest, 4e-6);
}

TEST(BodyVsSurface, ABodyUnderASheetIsHeldUnderIt) {
  Scene scene = emptyScene({0, 0, 10});
  scene.deformables.push_back(stiffSheet());
  scene.bodies.push_back(bodyOf(Shape::box({.05, .05, .05}), {-.4, .3, -.1}));
  World world(scene, options(4));
  run(world, 120);
  EXPECT_NEAR(world.state(world.bodies()[0]).position.z, -.051, 5e-4);
}

TEST(BodyVsSurface, FastBodiesDoNotPassALargeTriangle) {
  for (const double speed : {1., 10., 60.}) {
    Scene scene = emptyScene({0, 0, 0});
    scene.deformables.push_back(stiffSheet());
    BodyDef box = bodyOf(Shape::box({.05, .05, .05}), {-.4, .3, 1});
    box.velocity = {0, 0, -speed};
    box.orientation = normalize(Quat{.9, .3, .2, .1});
    scene.bodies.push_back(box);
    World world(scene, options(4));
    for (int i = 0; i < 120; ++i) {
      world.step();
      ASSERT_GT(world.state(world.bodies()[0]).position.z, .03) << speed << " m/s, step " << i;
    }
  }
}

TEST(BodyVsSurface, FrictionHoldsABoxOnATiltedTriangleUpToItsAngle) {
  // tan 30 degrees = 0.577
  for (const double mu : {.5, .65}) {
    Scene scene = emptyScene(10 * Vec3{.5, 0, -std::sqrt(.75)});
    ClothDef sheet = stiffSheet();
    sheet.material.staticFriction = sheet.material.dynamicFriction = mu;
    scene.deformables.push_back(sheet);
    BodyDef box = bodyOf(Shape::box({.05, .05, .02}), {-.7, .3, .022});
    box.material.staticFriction = box.material.dynamicFriction = mu;
    scene.bodies.push_back(box);
    World world(scene, options(4));
    run(world, 30);
    const double before = world.state(world.bodies()[0]).position.x;
    run(world, 30);
    const double slid = world.state(world.bodies()[0]).position.x - before;
    if (mu > .577)
      EXPECT_LT(slid, 1e-4);
    else
      EXPECT_GT(slid, .05);
  }
}

TEST(BodyVsSurface, ASharpCornerStandsOnASolid) {
  Scene scene = emptyScene({0, 0, -10});
  TetSolidDef base = tetBox({-.5, -.5, -.5}, {1, 1, .5}, {2, 2, 2});
  base.youngsModulus = 1e6;
  for (int v = 0; v < static_cast<int>(base.vertices.size()); ++v)
    if (base.vertices[static_cast<std::size_t>(v)].z < -.4) base.fixed.push_back(v);
  scene.deformables.push_back(base);
  BodyDef cone = bodyOf(Shape::cone(.05, .05), {.2, -.3, .1});
  cone.orientation = {0, 1, 0, 0};
  cone.lockRotation = {true, true, true};
  scene.bodies.push_back(cone);
  World world(scene, options(10));
  run(world, 180);
  EXPECT_NEAR(world.state(world.bodies()[0]).position.z, .05, 3e-3) << "on its tip, not in the solid";
}

TEST(BodyVsSurface, ForcesOnBodyAndSheetAreOppositeSoThatMomentumIsKept) {
  Scene scene = emptyScene({0, 0, 0});
  ClothDef sheet = stiffSheet();
  sheet.fixed.clear();
  sheet.density = 2000;
  scene.deformables.push_back(sheet);
  BodyDef ball = bodyOf(Shape::sphere(.1), {-.4, .3, .3});
  ball.velocity = {0, 0, -3};
  scene.bodies.push_back(ball);
  World world(scene, options(20));
  const double mass = massOf(world), before = -3 * mass;
  run(world, 30);
  const Momentum sheetNow = momentumOf(world, world.deformableAt(0));
  EXPECT_NEAR(mass * world.state(world.bodies()[0]).velocity.z + sheetNow.linear.z, before,
              .03 * std::fabs(before));
  EXPECT_LT(sheetNow.linear.z, .1 * before) << "the sheet was hit";
}

TEST(BodyVsSurface, AttachedBodiesFiltersAndOpenSurfacesHaveNoContact) {
  const auto fallsThrough = [](auto&& change) {
    Scene scene = emptyScene({0, 0, -10});
    scene.deformables.push_back(stiffSheet());
    scene.bodies.push_back(bodyOf(Shape::box({.05, .05, .05}), {-.4, .3, .1}));
    change(scene);
    World world(scene, options(4));
    run(world, 60);
    return world.state(world.bodies()[0]).position.z < -.5;
  };
  EXPECT_FALSE(fallsThrough([](Scene&) {}));
  EXPECT_TRUE(fallsThrough([](Scene& s) { common(s.deformables[0]).collide = false; }));
  EXPECT_TRUE(fallsThrough([](Scene& s) {
    common(s.deformables[0]).collideSurface = common(s.deformables[0]).collideSelf = false;
  }));
  EXPECT_TRUE(fallsThrough([](Scene& s) { s.bodies[0].sensor = true; }));
  EXPECT_TRUE(fallsThrough([](Scene& s) { s.bodies[0].filter.mask = 2; }));
}

TEST(BodyVsSurface, BodiesMayComeAndGoBesideASurface) {
  Scene scene = emptyScene({0, 0, -10});
  scene.deformables.push_back(stiffSheet());
  scene.bodies.push_back(bodyOf(Shape::box({.05, .05, .05}), {-.4, .3, .06}));
  World world(scene, options(4));
  run(world, 60);
  const BodyId first = world.bodies()[0];
  std::vector<BodyId> more;
  for (int i = 0; i < 20; ++i) {
    more.push_back(world.addBody(bodyOf(Shape::sphere(.03), {.8 - .08 * i, -.5, .05})));
    world.step();
  }
  run(world, 60);
  EXPECT_NEAR(world.state(first).position.z, .051, 5e-4);
  for (const BodyId id : more) EXPECT_NEAR(world.state(id).position.z, .031, 2e-3);
  world.removeBody(first);
  const BodyId again = world.addBody(bodyOf(Shape::box({.05, .05, .05}), {-.4, .3, .06}));
  run(world, 60);
  EXPECT_NEAR(world.state(again).position.z, .051, 5e-4);
  // and a snapshot has them all
  const auto kept = world.snapshot();
  run(world, 30);
  const std::uint64_t hash = world.hash();
  world.restore(kept);
  run(world, 30);
  EXPECT_EQ(world.hash(), hash);
}

}  // namespace
}  // namespace rubble
