/// Materials: combine rules, surface velocity, rolling and torsional friction.
#include <gtest/gtest.h>

#include <rubble/worlds.h>

#include "tests/support/expect.h"
#include "tests/support/shapes.h"

namespace rubble {
namespace {

using test::options;

/// Deceleration of a box that slides at 4 m/s, over gravity: the dynamic friction of the pair.
double frictionOf(const Material& a, const Material& b) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies[0].material = a;
  scene.bodies.push_back(test::body(Shape::box({.5, .5, .1}), {0, 0, .1}));
  scene.bodies[1].material = b;
  World world(scene, options(20));
  test::run(world, 30);
  BodyState s = world.state(world.bodyAt(1));
  s.velocity = {4, 0, 0};
  world.setState(world.bodyAt(1), s);
  test::run(world, 10);
  const double before = world.state(world.bodyAt(1)).velocity.x;
  test::run(world, 10);
  return (before - world.state(world.bodyAt(1)).velocity.x) / (10 * 10 / 60.);
}

Material rubbing(double friction, Combine rule) {
  Material m;
  m.staticFriction = m.dynamicFriction = friction;
  m.frictionCombine = rule;
  return m;
}

TEST(Material, CombinesByTheLaterRule) {
  const double a = .2, b = .8;
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Usual), rubbing(b, Combine::Usual)), .4, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Average), rubbing(b, Combine::Usual)), .5, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Average), rubbing(b, Combine::Minimum)), .2, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Multiply), rubbing(b, Combine::Minimum)), .16, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::Multiply), rubbing(b, Combine::Maximum)), .8, .01);
  EXPECT_NEAR(frictionOf(rubbing(a, Combine::GeometricMean), rubbing(b, Combine::Maximum)), .4, .01);
}

TEST(Material, OfAPartCountsWhereThePartTouches) {
  // one runner is ice, the other rubber: only what touches the ground matters
  Material ice = rubbing(0, Combine::Multiply), rubber = rubbing(1, Combine::Multiply);
  const auto slow = [&](const Material& lower, const Material& upper) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::ground(.5));
    scene.bodies.push_back(test::body(Shape::compound({{Shape::box({.5, .5, .1}), {0, 0, -.1}, {}, lower},
                                                       {Shape::box({.5, .5, .1}), {0, 0, .1}, {}, upper}}),
                                      {0, 0, .2}));
    scene.bodies[1].velocity = {4, 0, 0};
    World world(scene, options(10));
    test::run(world, 30);
    return 4 - world.state(world.bodyAt(1)).velocity.x;
  };
  EXPECT_LT(slow(ice, rubber), .05);
  EXPECT_NEAR(slow(rubber, ice), .5 * 10 * .5, .3);
}

TEST(SurfaceVelocity, CarriesABoxAtItsSpeed) {
  for (const std::string& kind : test::groundKinds()) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::groundOf(kind, .5));
    scene.bodies[0].material.surfaceVelocity = {1.5, 0, 0};
    scene.bodies.push_back(test::body(Shape::box({.3, .2, .1}), {-3, 0, .1}, .5));
    World world(scene, options(4));
    // mu g t = 1.5 m/s after 0.3 s
    test::run(world, 9);
    EXPECT_NEAR(world.state(world.bodyAt(1)).velocity.x, .75, .15) << kind;
    test::run(world, 111);
    EXPECT_NEAR(world.state(world.bodyAt(1)).velocity.x, 1.5, .003) << kind;
    EXPECT_NEAR(world.state(world.bodyAt(1)).position.x, -3 + 1.5 * 2 - 1.5 * 1.5 / (2 * 5), .05) << kind;
  }
}

/// How far a ball comes down a slope in 4 s from rest [m].
double rolledDown(double slope, double lever, const std::string& kind) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::groundOf(kind, .8));
  scene.bodies.push_back(test::body(Shape::sphere(.25), {0, 0, .25}, .8));
  scene.bodies[1].material.rollingFriction = lever;
  test::turn(scene, fromAxisAngle(Vec3{0, 1, 0}, slope));
  World world(scene, options(10));
  test::run(world, 240);
  return length(world.state(world.bodyAt(1)).position - scene.bodies[1].position);
}

TEST(RollingFriction, HoldsABallUpToASlopeOfLeverOverRadius) {
  const double lever = .02, limit = std::atan(lever / .25);
  for (const char* kind : {"plane", "box", "mesh"}) {
    EXPECT_LT(rolledDown(.97 * limit, lever, kind), .005) << kind;
    // beyond it: a = (g sin - g cos l / r) / (1 + 2/5)
    const double slope = 1.5 * limit, a = 10 * (std::sin(slope) - std::cos(slope) * lever / .25) / 1.4;
    EXPECT_NEAR(rolledDown(slope, lever, kind), a * 8, .05 * a * 8) << kind;
  }
}

TEST(RollingFriction, StopsABallAfterTheWayOfItsEnergy) {
  const double lever = .01, speed = 1.5;
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies[0].material.rollingFriction = lever;
  scene.bodies.push_back(test::body(Shape::sphere(.25), {0, 0, .25}));
  scene.bodies[1].velocity = {speed, 0, 0};
  scene.bodies[1].angularVelocity = {0, speed / .25, 0};
  World world(scene, options(10));
  test::run(world, 480);
  const BodyState s = world.state(world.bodyAt(1));
  EXPECT_LT(length(s.velocity), 1e-3);
  // 7/10 m v^2 = m g (l / r) way
  const double way = .7 * speed * speed / (10 * lever / .25);
  EXPECT_NEAR(s.position.x, way, .03 * way);
}

TEST(TorsionalFriction, StopsASpinningBallInTime) {
  const double lever = .01, spin = 6;
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::body(Shape::sphere(.25), {0, 0, .25}));
  scene.bodies[1].material.torsionalFriction = lever;
  scene.bodies[1].angularVelocity = {0, 0, spin};
  World world(scene, options(10));
  // 2/5 m r^2 w = m g l t
  const double time = .4 * .25 * .25 * spin / (10 * lever);
  test::run(world, static_cast<int>(.5 * time * 60));
  EXPECT_NEAR(world.state(world.bodyAt(1)).angularVelocity.z, spin / 2, .05 * spin);
  test::run(world, static_cast<int>(.6 * time * 60) + 10);
  EXPECT_LT(length(world.state(world.bodyAt(1)).angularVelocity), 1e-3);
}

Material named(const std::string& name, double friction = 0.6) {
  Material m = rubbing(friction, Combine::Usual);
  m.name = name;
  return m;
}

/// A ramp of steel with two boxes on it: gravity is inclined. Only ice has a rule with steel.
Scene rampOfPairs(double slope) {
  Scene scene = test::emptyScene();
  scene.gravity = {10 * std::sin(slope), 0, -10 * std::cos(slope)};
  scene.bodies.push_back(test::ground());
  scene.bodies[0].material = named("steel");
  for (const char* name : {"ice", "rubber"}) {
    scene.bodies.push_back(test::body(Shape::box({0.3, 0.3, 0.1}), {0, *name == 'i' ? -1. : 1., 0.1}));
    scene.bodies.back().material = named(name);
  }
  scene.materialPairs.push_back({"ice", "steel", 0.1, 0.1});
  return scene;
}

TEST(PairRule, LetsOnePairSlideAndTheOtherHold) {
  const double slope = 0.4, a = 10 * (std::sin(slope) - 0.1 * std::cos(slope));
  std::uint64_t hash = 0;
  for (const std::string backend : {"cpu", "reference", "lockstep", "distributed"}) {
    World world(rampOfPairs(slope), options(10, backend));
    test::run(world, 30);
    const BodyState begin = world.state(world.bodyAt(1));
    test::run(world, 30);
    const BodyState end = world.state(world.bodyAt(1));
    EXPECT_NEAR(end.velocity.x - begin.velocity.x, a / 2, 0.01 * a) << backend;
    EXPECT_LT(std::fabs(world.state(world.bodyAt(2)).position.x), 2e-3) << backend;
    EXPECT_EQ(world.firstDifference(), "") << backend;
    if (backend == "cpu") hash = world.hash();
    if (backend == "distributed") {
      EXPECT_EQ(world.hash(), hash);
    }
  }
}

TEST(PairRule, ChangesWhileTheWorldRunsAndStaysInSaveGames) {
  World world(rampOfPairs(0.4), options(10));
  const auto speed = [&](int body) { return world.state(world.bodyAt(body)).velocity.x; };
  test::run(world, 20);
  const Snapshot before = Snapshot::fromBytes(world.snapshot().bytes());
  world.removeMaterialPair("steel", "ice");
  world.setMaterialPair({"rubber", "steel", 0.05, 0.05});
  const double ice = speed(1);
  test::run(world, 20);
  EXPECT_LT(speed(1), ice);
  EXPECT_GT(speed(2), 0.3);
  test::run(world, 40);
  EXPECT_LT(speed(1), 1e-3);
  // the snapshot has the rules of its time
  world.restore(before);
  ASSERT_EQ(world.materialPairs().size(), 1u);
  World other(test::emptyScene(), options(10));
  other.restore(before);
  test::run(world, 20), test::run(other, 20);
  EXPECT_GT(speed(1), ice);
  EXPECT_EQ(world.hash(), other.hash());
}

TEST(PairRule, ReplacesEachCoefficientAlone) {
  const auto run = [](const MaterialPair& rule, BodyDef ball, int steps) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::ground());
    scene.bodies[0].material = named("a"), ball.material = named("b");
    scene.bodies.push_back(ball);
    scene.materialPairs.push_back(rule);
    World world(scene, options(10));
    double top = 0;
    for (int i = 0; i < steps; ++i) {
      world.step();
      const BodyState s = world.state(world.bodyAt(1));
      if (s.velocity.z > 0) top = std::max(top, s.position.z - 0.25);
    }
    return std::pair(world.state(world.bodyAt(1)), top);
  };
  MaterialPair rule{"a", "b"};
  BodyDef ball = test::body(Shape::sphere(0.25), {0, 0, 1.25});
  rule.restitution = 0.5;
  EXPECT_NEAR(run(rule, ball, 70).second, 0.25, 0.03);
  // a rolling ball loses 5/7 g l / r each second, a spinning one 5/2 g l / r^2
  ball.position.z = 0.25, ball.velocity = {3, 0, 0}, ball.angularVelocity = {0, 12, 0};
  rule = {"b", "a"}, rule.rollingFriction = 0.02;
  EXPECT_NEAR(run(rule, ball, 60).first.velocity.x, 3 - 10 * 0.02 / 0.25 * 5 / 7, 0.03);
  ball.velocity = {}, ball.angularVelocity = {0, 0, 6};
  rule = {"b", "a"}, rule.torsionalFriction = 0.01;
  EXPECT_NEAR(run(rule, ball, 30).first.angularVelocity.z, 6 - 2.5 * 10 * 0.01 / 0.0625 / 2, 0.3);
}

TEST(PairRule, ActsOnVerticesAndLeavesOtherWorldsAlone) {
  const auto sceneOf = [](double friction) {
    Scene scene = rampOfPairs(0.4);
    ParticlesDef grain;
    grain.radius = 0.05, grain.vertices = {{0, 3, 0.05}};
    grain.material = named("grain");
    scene.deformables.push_back(grain);
    scene.materialPairs.push_back({"grain", "steel", friction, friction});
    return scene;
  };
  WorldOptions own = options(10);
  own.threads = 1;
  Worlds worlds(own);
  for (const double friction : {0.2, 1.0, 0.1}) worlds.add(sceneOf(friction));
  worlds.step(40);
  int k = 0;
  for (const double friction : {0.2, 1.0, 0.1}) {
    World alone(sceneOf(friction), own);
    test::run(alone, 40);
    EXPECT_EQ(alone.positions(alone.deformables()[0]), worlds[k].positions(worlds[k].deformables()[0]));
    EXPECT_EQ(alone.state(alone.bodyAt(1)).position, worlds[k].state(worlds[k].bodyAt(1)).position);
    const double a = std::max(0.0, 10 * (std::sin(0.4) - friction * std::cos(0.4)));
    EXPECT_NEAR(alone.velocities(alone.deformables()[0])[0].x, a * 40 / 60., 0.05 * a + 0.01);
    ++k;
  }
}

TEST(PairRule, OfNoNameOrTwiceIsRefused) {
  Scene scene = rampOfPairs(0.1);
  scene.materialPairs.push_back({"steel", "ice", 0.3});
  EXPECT_THROW(World(scene, options()), Error);
  scene.materialPairs.back() = {"", "ice"};
  EXPECT_THROW(World(scene, options()), Error);
  scene.materialPairs.back() = {"a", "b", 0.1, 0.2};
  EXPECT_THROW(World(scene, options()), Error);
  World world(rampOfPairs(0.1), options());
  EXPECT_THROW(world.removeMaterialPair("steel", "rubber"), Error);
}

/// A plate at a height of 2 m that holds from above only, and a body.
Scene platform(const Shape& shape, const Vec3& at, const Vec3& velocity, double thickness = 0.05) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::body(Shape::box({3, 3, thickness}), {0, 0, 2 - thickness}));
  scene.bodies[0].motion = Motion::Static;
  scene.bodies[0].material.oneWay = {0, 0, 2};
  BodyDef body = test::body(shape, at);
  body.velocity = velocity;
  scene.bodies.push_back(body);
  return scene;
}

std::vector<Shape> passengers() {
  return {Shape::sphere(0.2), Shape::box({0.2, 0.15, 0.2}), Shape::hull(test::prismCorners(5, 0.2, 0.2)),
          Shape::compound({{Shape::box({0.2, 0.1, 0.1}), {0, 0, 0.1}, {}},
                           {Shape::box({0.1, 0.1, 0.1}), {0, 0, -0.1}, {}}})};
}

TEST(OneWay, LetsPassFromBelowWithoutATraceAndHoldsFromAbove) {
  for (const Shape& shape : passengers())
    for (const double speed : {7., 20., 90.}) {
      Scene scene = platform(shape, {0, 0, 0.7}, {0.1, 0, speed}, speed > 50 ? 0.01 : 0.05), free = scene;
      free.bodies[0].position = {100, 0, 0};
      WorldOptions own = options(10);
      own.events = true;
      World world(scene, own), without(free, own);
      const BodyId body = world.bodyAt(1);
      for (int i = 0; i < 40; ++i) {
        world.step(), without.step();
        if (world.state(body).velocity.z < 0) break;
        EXPECT_TRUE(world.events().contacts.empty());
        ASSERT_EQ(world.state(body).position, without.state(body).position) << speed << " step " << i;
      }
      // back from above, as fast
      BodyState s = world.state(body);
      s.position.z = std::max(2.5, s.position.z), s.velocity.z = -speed;
      s.position.z = std::min(4.0, s.position.z);
      world.setState(body, s);
      test::run(world, 150);
      EXPECT_NEAR(world.state(body).position.z, 2.2, 0.02) << speed;
    }
}

TEST(OneWay, DecidesOnceAndKeepsItUntilTheyPart) {
  // a body that turns within the plate falls back through it, one that comes clear of it stays up
  for (const Shape& shape : passengers())
    for (const double top : {1.9, 2.1, 2.6}) {
      Scene scene = platform(shape, {0, 0, 0.7}, {0, 0, std::sqrt(2 * 10 * (top - 0.7))});
      World world(scene, options(10));
      test::run(world, 120);
      const double z = world.state(world.bodyAt(1)).position.z;
      if (top > 2.4) {
        EXPECT_NEAR(z, 2.2, 0.02);
      } else {
        EXPECT_LT(z, -1);
      }
    }
}

/// Two shapes whose principal axes are not their own: a plate of half thickness 0.05 turned by `turn`, as a
/// hull and as a part of a compound.
std::vector<Shape> turnedPlates(const Quat& turn, const Material& material) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(rotate(turn, Vec3{i & 1 ? 3. : -3., i & 2 ? 2. : -2., i & 4 ? 0.05 : -0.05}));
  return {Shape::hull(corners),
          Shape::compound({{Shape::box({3, 2, 0.05}), {}, turn, material},
                           {Shape::box({0.05, 2, 0.5}), rotate(turn, Vec3{-3, 0, -0.5}), turn, material}})};
}

TEST(Material, HasItsVectorsInBodyAxesOfEveryShape) {
  const Quat turn = fromAxisAngle(normalize(Vec3{1, 2, -0.5}), 0.9);
  Material material = rubbing(0.5, Combine::Average);
  material.oneWay = rotate(turn, Vec3{0, 0, 1e-25});
  material.surfaceVelocity = rotate(turn, Vec3{1.5, 0, 0});
  for (const Shape& plate : turnedPlates(turn, material)) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::body(plate, {0, 0, 2}));
    scene.bodies[0].orientation = conjugate(turn);
    scene.bodies[0].motion = Motion::Static;
    scene.bodies[0].material = material;
    scene.bodies.push_back(test::body(Shape::sphere(0.2), {1, 0, 1.2}));
    scene.bodies[1].velocity = {0, 0, 7};
    scene.bodies.push_back(test::body(Shape::box({0.2, 0.2, 0.1}), {-1, 0, 2.16}, 0.5));
    World world(scene, options(6));
    test::run(world, 60);
    EXPECT_GT(world.state(world.bodyAt(1)).position.z, 2.2);
    const BodyState carried = world.state(world.bodyAt(2));
    EXPECT_NEAR(carried.position.z, 2.15, 0.01);
    EXPECT_NEAR(carried.velocity.x, 1.5, 0.01);
    EXPECT_NEAR(carried.velocity.y, 0, 0.01);
  }
}

/// A one-way shelf whose top is at a height of 2 m, with a solid part, in one static body.
Scene shelfWith(const ShapePartDef& solid) {
  Scene scene = test::emptyScene();
  Material holds;
  holds.oneWay = {0, 0, 1};
  scene.bodies.push_back(
      test::body(Shape::compound({{Shape::box({3, 3, 0.05}), {0, 0, 1.95}, {}, holds}, solid}), {}));
  scene.bodies[0].motion = Motion::Static;
  return scene;
}

TEST(OneWay, OfOnePartLeavesOtherPartsSolid) {
  // a thin roof above the shelf stops what has passed the shelf, in the same step or in a later one
  for (const Shape& shape : passengers())
    for (const double speed : {25., 60., 150.})
      for (const double from : {0.9, 1.3, 1.6, 1.75, 1.9}) {
        Scene scene = shelfWith({Shape::box({3, 3, 0.02}), {0, 0, 3}, {}});
        scene.bodies.push_back(test::body(shape, {0.1, 0.2, from}));
        scene.bodies[1].velocity = {0, 0, speed};
        World world(scene, options(8));
        double top = 0;
        for (int i = 0; i < 12; ++i) {
          world.step();
          top = std::max(top, world.state(world.bodyAt(1)).position.z);
        }
        EXPECT_GT(top, 2.2) << speed << " from " << from;
        EXPECT_LT(top, 3) << speed << " from " << from;
      }
}

TEST(OneWay, LetsPassWhatTouchesASolidPart) {
  for (const double speed : {6., 15., 30., 60.})
    for (int k = 0; k < 6; ++k) {
      Scene scene = shelfWith({Shape::box({0.1, 3, 4}), {0.3, 0, 0}, {}, rubbing(0, Combine::Minimum)});
      scene.gravity = {2, 0, 0};
      scene.bodies.push_back(test::body(Shape::box({0.2, 0.2, 0.2}), {0, 0, 0.6 + 0.11 * k}));
      scene.bodies[1].velocity = {0, 0, speed};
      World world(scene, options(8));
      test::run(world, 30);
      EXPECT_GT(world.state(world.bodyAt(1)).position.z, 2.3) << speed << " " << k;
      EXPECT_NEAR(world.state(world.bodyAt(1)).velocity.z, speed, 0.05 * speed) << speed << " " << k;
    }
}

TEST(OneWay, HasTheSameBitsOnAllBackends) {
  std::uint64_t hash = 0;
  for (const std::string backend : {"cpu", "lockstep", "distributed"}) {
    Scene scene = platform(Shape::sphere(0.2), {0, 0, 0.7}, {0, 0, 9});
    for (const Shape& shape : passengers()) {
      BodyDef more = test::body(shape, {1.2 - 0.4 * double(scene.bodies.size()), 1, 2.6});
      scene.bodies.push_back(more);
      more.position = {more.position.x, -1, 0.8}, more.velocity = {0, 0, 8};
      scene.bodies.push_back(more);
    }
    ClothDef sheet = clothSheet({-0.5, -2.5, 2.4}, {1, 0, 0}, {0, 0.6, 0}, 4, 3);
    scene.deformables.emplace_back(sheet);
    World world(scene, options(6, backend));
    test::run(world, 80);
    EXPECT_EQ(world.firstDifference(), "");
    if (backend == "cpu") hash = world.hash();
    if (backend == "distributed") {
      EXPECT_EQ(world.hash(), hash);
    }
    for (std::size_t i = 1; i < scene.bodies.size(); ++i)
      EXPECT_GT(world.state(world.bodyAt(static_cast<int>(i))).position.z, 2) << i;
    for (const Vec3& v : world.positions(world.deformables()[0])) EXPECT_GT(v.z, 1.99);
  }
}

TEST(OneWay, LetsVerticesPassFromBelow) {
  for (const double speed : {8., 40.}) {
    Scene scene = platform(Shape::sphere(0.2), {0, 0, 9}, {});
    ParticlesDef grains;
    grains.radius = 0.04;
    for (int i = 0; i < 5; ++i) grains.vertices.push_back({0.3 * i, 0, 0.5 + 0.1 * i});
    grains.velocity = {0, 0, speed};
    scene.deformables.push_back(grains);
    World world(scene, options(6));
    const DeformableId id = world.deformables()[0];
    const int up = static_cast<int>(2.5 / speed * 60) + 1;
    test::run(world, up);
    for (const Vec3& v : world.velocities(id)) EXPECT_NEAR(v.z, speed - 10. * up / 60, 1e-3);
    test::run(world, static_cast<int>(speed / 10 * 120) + 120);
    for (const Vec3& v : world.positions(id)) EXPECT_NEAR(v.z, 2.04, 0.02);
  }
}

}  // namespace
}  // namespace rubble
