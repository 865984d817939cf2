/// Shapes of every kind at rest, on ramps and rolling, against closed forms.
#include <gtest/gtest.h>

#include "tests/support/expect.h"
#include "tests/support/shapes.h"

namespace rubble {
namespace {

using test::options;

TEST(Shapes, StandStillOnEveryGround) {
  for (const std::string& kind : test::groundKinds()) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::groundOf(kind));
    double x = -4;
    for (const test::Standing& s : test::standingShapes()) {
      x += 1;
      BodyDef def = test::body(s.shape, {x, .17 * x, s.height + .05});
      def.orientation = fromAxisAngle(Vec3{0, 0, 1}, .3 * x);
      scene.bodies.push_back(def);
    }
    World world(scene, options(4));
    test::run(world, 180);
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
      const std::string& name = test::standingShapes()[i - 1].name;
      const BodyState s = world.state(world.bodyAt(static_cast<int>(i)));
      EXPECT_NEAR(s.position.z, test::standingShapes()[i - 1].height, 1e-3) << name << " on " << kind;
      EXPECT_LT(length(s.velocity) + length(s.angularVelocity), 2e-3) << name << " on " << kind;
      EXPECT_TRUE(test::sameRotation(s.orientation, scene.bodies[i].orientation, 2e-3))
          << name << " on " << kind;
    }
  }
}

TEST(Shapes, StandOnOneAnother) {
  const std::vector<test::Standing> shapes = test::standingShapes();
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  std::vector<double> expected;
  std::vector<std::string> names;
  double x = 0;
  for (const test::Standing& lower : shapes)
    for (const test::Standing& upper : shapes) {
      if (lower.top == 0) continue;
      x += 1.2;
      scene.bodies.push_back(test::body(lower.shape, {x, 0, lower.height}));
      expected.push_back(lower.height);
      scene.bodies.push_back(
          test::body(upper.shape, {x + .02, -.01, lower.height + lower.top + upper.height}));
      scene.bodies.back().orientation = fromAxisAngle(Vec3{0, 0, 1}, .2);
      expected.push_back(lower.height + lower.top + upper.height);
      names.push_back(lower.name), names.push_back(upper.name + " on " + lower.name);
    }
  World world(scene, options(4));
  test::run(world, 240);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const BodyState s = world.state(world.bodyAt(static_cast<int>(i) + 1));
    EXPECT_NEAR(s.position.z, expected[i], 1.5e-3) << names[i];
    EXPECT_LT(length(s.velocity), 5e-3) << names[i];
  }
}

TEST(Shapes, HoldOnARampUpToItsThresholdAndSlideBeyond) {
  constexpr double kFriction = .3;
  for (const std::string& kind : test::groundKinds())
    for (const double factor : {.99, 1.01}) {
      Scene scene = test::emptyScene();
      scene.bodies.push_back(test::groundOf(kind, kFriction));
      double y = -5;
      for (const test::Standing& s : test::standingShapes())
        scene.bodies.push_back(test::body(s.shape, {-1.03, y += 1.05, s.height}, kFriction));
      const double slope = std::atan(factor * kFriction);
      test::turn(scene, fromAxisAngle(Vec3{0, 1, 0}, slope));
      World world(scene, options(4));
      test::run(world, 240);
      const double way = 10 * std::cos(slope) * .01 * kFriction * 16 / 2;
      for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
        const std::string where = test::standingShapes()[i - 1].name + " on " + kind;
        const double moved = length(world.state(world.bodyAt(static_cast<int>(i))).position -
                                    scene.bodies[i].position);
        EXPECT_LT(moved, factor < 1 ? .005 : 1.6 * way) << where;
        EXPECT_GT(moved, factor < 1 ? -1 : .4 * way) << where;
      }
    }
}

/// Largest speed against the ground's normal, and change of the speed along it, of a body that rolls 6 m
/// [m/s].
struct Bumps {
  double up = 0, along = 0, turned = 0;
};
Bumps rollOver(const std::string& kind, const Shape& shape, double radius, const Quat& orientation,
               const Vec3& direction) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::groundOf(kind));
  BodyDef def = test::body(shape, direction * -3. + Vec3{0, 0, radius});
  def.orientation = orientation;
  def.velocity = 2. * direction;
  def.angularVelocity = cross(Vec3{0, 0, 1}, direction) * (2 / radius);
  scene.bodies.push_back(def);
  World world(scene, options(4));
  test::run(world, 20);
  const double speed = dot(world.state(world.bodyAt(1)).velocity, direction);
  Bumps bumps;
  for (int i = 0; i < 140; ++i) {
    world.step();
    const BodyState s = world.state(world.bodyAt(1));
    bumps.up = std::max(bumps.up, std::fabs(s.velocity.z));
    bumps.along = std::max(bumps.along, std::fabs(dot(s.velocity, direction) - speed));
    bumps.turned = std::max(bumps.turned, std::fabs(dot(s.velocity, cross(Vec3{0, 0, 1}, direction))));
  }
  return bumps;
}

TEST(Mesh, DoesNotTripARollingBall) {
  for (const char* kind : {"mesh", "heights"})
    for (const double angle : {0., .3, .785398}) {
      const Bumps plane = rollOver("plane", Shape::sphere(.25), .25, Quat{},
                                   {std::cos(angle), std::sin(angle), 0});
      const Bumps b = rollOver(kind, Shape::sphere(.25), .25, Quat{}, {std::cos(angle), std::sin(angle), 0});
      EXPECT_LT(b.up, 1e-3) << kind << " " << angle;
      EXPECT_LT(std::fabs(b.along - plane.along), 1e-4) << kind << " " << angle;
      EXPECT_LT(b.turned, 1e-3) << kind << " " << angle;
    }
}

/// A ball that crosses a roof of 6 degrees a side keeps its speed: what lies before an edge does not stop it.
TEST(Mesh, DoesNotTripABallAtARidge) {
  const double slope = std::tan(.1), speed = 2.5;
  for (const bool twoSided : {false, true}) {
    Scene scene = test::emptyScene();
    BodyDef roof = test::ground();
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> triangles;
    for (int i = 0; i <= 16; ++i)
      for (const double y : {-1., 1.}) points.push_back({.5 * i - 4, y, -slope * std::fabs(.5 * i - 4)});
    for (int i = 0; i < 16; ++i) {
      triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
      triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
    }
    roof.shape = Shape::mesh(points, triangles, twoSided);
    scene.bodies.push_back(roof);
    scene.bodies.push_back(
        test::body(Shape::sphere(.25), Vec3{-2, .1, -2 * slope} + .25 * normalize(Vec3{-slope, 0, 1}), 0));
    scene.bodies[1].velocity = speed * normalize(Vec3{1, 0, slope});
    scene.bodies[0].material.staticFriction = scene.bodies[0].material.dynamicFriction = 0;
    World world(scene, options(4));
    double lowest = speed;
    for (int i = 0; i < 90; ++i) {
      world.step();
      lowest = std::min(lowest, world.state(world.bodyAt(1)).velocity.x);
    }
    // up by 2 m at 0.1: v^2 = v0^2 - 2 g h
    const double top = std::sqrt(speed * speed - 20 * 2 * slope);
    EXPECT_NEAR(lowest, top, .03 * top) << twoSided;
    EXPECT_GT(world.state(world.bodyAt(1)).position.x, .2);
  }
}

TEST(Cylinder, RollsSmoothlyOnEveryGround) {
  const Quat lying = fromAxisAngle(Vec3{1, 0, 0}, std::acos(0.));
  for (const std::string& kind : test::groundKinds()) {
    const Bumps b = rollOver(kind, Shape::cylinder(.25, .3), .25, lying, {1, 0, 0});
    EXPECT_LT(b.up, 2e-3) << kind;
    EXPECT_LT(b.along, 5e-3) << kind;
    EXPECT_LT(b.turned, 5e-3) << kind;
  }
}

TEST(Mesh, LetsABoxSlideAsAPlaneDoes) {
  const auto way = [](const std::string& kind) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::groundOf(kind, .3));
    scene.bodies.push_back(test::body(Shape::box({.4, .3, .2}), {-4, .1, .2}, .3));
    scene.bodies[1].velocity = {5, .5, 0};
    scene.bodies[1].orientation = fromAxisAngle(Vec3{0, 0, 1}, .4);
    World world(scene, options(10));
    test::run(world, 180);
    return world.state(world.bodyAt(1)).position;
  };
  const Vec3 plane = way("plane");
  EXPECT_NEAR(plane.x, -4 + 25 / 6., .15);
  for (const char* kind : {"mesh", "heights"}) EXPECT_TRUE(test::near(way(kind), plane, .02)) << kind;
}

TEST(Mesh, OfOneSideHoldsFromOutsideAndOfTwoFromBoth) {
  for (const bool twoSided : {false, true}) {
    Scene scene = test::emptyScene();
    BodyDef sheet = test::ground();
    sheet.shape = Shape::mesh({{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}, {{0, 2, 1}, {0, 3, 2}},
                              twoSided);
    scene.bodies.push_back(sheet);
    scene.bodies.push_back(test::body(Shape::sphere(.3), {.2, .3, .4}));
    World world(scene, options(4));
    test::run(world, 60);
    const double z = world.state(world.bodyAt(1)).position.z;
    EXPECT_LT(z, twoSided ? .301 : -1);
    EXPECT_GT(z, twoSided ? .299 : -1e9);
  }
}

TEST(Shapes, KeepTheFrameOfTheirAuthor) {
  // a cone, whose center of mass is not in the middle, and a hull far from its origin: poses and anchors come
  // out as they go in
  const Quat q = normalize(Quat{.8, {.1, -.5, .3}});
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::body(Shape::cone(.3, .5), {1, 2, 3}));
  std::vector<Vec3> points;
  for (const Vec3& p : test::prismCorners(5, .4, .7)) points.push_back(p + Vec3{3, -1, 2});
  scene.bodies.push_back(test::body(Shape::hull(points), {-4, 1, 0}));
  for (BodyDef& body : scene.bodies) body.orientation = q;
  World world(scene, options(4));
  for (int i = 0; i < 2; ++i) {
    const BodyDef& def = scene.bodies[static_cast<std::size_t>(i)];
    EXPECT_TRUE(test::near(world.state(world.bodyAt(i)).position, def.position, 1e-6));
    EXPECT_TRUE(test::sameRotation(world.state(world.bodyAt(i)).orientation, q, 1e-6));
    // pushed through its center of mass it does not turn
    world.applyImpulse(world.bodyAt(i), {5, 0, 0});
  }
  test::run(world, 60);
  for (int i = 0; i < 2; ++i) EXPECT_LT(length(world.state(world.bodyAt(i)).angularVelocity), 1e-5);

  Scene hung = test::emptyScene();
  hung.bodies.push_back(test::body(Shape::cone(.3, .5), {0, 0, -.5}));
  hung.joints.push_back(test::ball(0, {0, 0, .5}, kWorld, {0, 0, 0}));
  World still(hung, options(10));
  test::run(still, 120);
  EXPECT_TRUE(test::near(still.state(still.bodyAt(0)).position, Vec3{0, 0, -.5}, 1e-3));
  EXPECT_LT(still.state(still.joints()[0]).gap, 1e-3);
}

TEST(DistanceField, OfABoxRestsWhereTheBoxWould) {
  const int n = 21;
  const double spacing = .05;
  std::vector<double> distances;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 d = abs(Vec3{i * spacing - .5, j * spacing - .5, k * spacing - .5}) - Vec3{.3, .3, .3};
        distances.push_back(length(Vec3{std::max(d.x, 0.), std::max(d.y, 0.), std::max(d.z, 0.)}) +
                            std::min(0., std::max({d.x, d.y, d.z})));
      }
  const Shape solid = Shape::distanceField({n, n, n}, {-.5, -.5, -.5}, spacing, distances);
  for (const std::string& kind : test::groundKinds()) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::groundOf(kind, .6, 2));
    scene.bodies.push_back(test::body(solid, {0, 0, .35}));
    scene.bodies.push_back(test::body(Shape::box({.2, .2, .2}), {.03, 0, .9}));
    scene.bodies.push_back(test::body(Shape::sphere(.2), {0, .02, 1.4}));
    World world(scene, options(10));
    test::run(world, 60);
    EXPECT_NEAR(world.state(world.bodyAt(1)).position.z, .3, .02) << kind;
    EXPECT_NEAR(world.state(world.bodyAt(2)).position.z, .8, .03) << kind;
  }
}

}  // namespace
}  // namespace rubble
