/// Bodies whose motion per step exceeds their own thickness or that of what they hit. Plates are 1 m wide
/// and 1 cm thick, bullets are 1 cm of lead.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/expect.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::kDt;

struct Shot {
  bool box, freePlate;
  double speed, degrees, distance;
};

BodyDef plate(bool free) {
  BodyDef def = test::body(Shape::box({.5, .5, .005}), {});
  def.name = "plate";
  def.density = 7800;
  def.motion = free ? Motion::Dynamic : Motion::Static;
  return def;
}

BodyDef bullet(bool box, const Vec3& position, const Vec3& velocity) {
  BodyDef def = test::body(box ? Shape::box({.005, .005, .005}) : Shape::sphere(.005), position);
  def.name = "bullet";
  def.density = 11340;
  def.velocity = velocity;
  def.orientation = fromAxisAngle(normalize(Vec3{1, 2, 3}), .7);
  return def;
}

Vec3 directionOf(const Shot& shot) {
  const double angle = shot.degrees * std::numbers::pi / 180;
  return {std::sin(angle), 0, -std::cos(angle)};
}

Scene shooting(const Shot& shot) {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(plate(shot.freePlate));
  const Vec3 d = directionOf(shot);
  scene.bodies.push_back(bullet(shot.box, -shot.distance * d, shot.speed * d));
  return scene;
}

class FastBody : public testing::TestWithParam<Shot> {};

TEST_P(FastBody, DoesNotPassAPlate) {
  const Shot shot = GetParam();
  World world(shooting(shot), test::options(4));
  const BodyId p = world.findBody("plate"), b = world.findBody("bullet");
  int stops = 0;
  const int steps = static_cast<int>(shot.distance / shot.speed / kDt) + 12;
  for (int i = 0; i < steps; ++i) {
    stops += world.step().stoppedBodies;
    const BodyState ps = world.state(p), bs = world.state(b);
    const Vec3 x = rotateInverse(ps.orientation, bs.position - ps.position);
    // on the side that it came from, as long as it is over the plate
    if (std::fabs(x.x) < .5 && std::fabs(x.y) < .5) {
      EXPECT_GT(x.z, .003) << i;
    }
  }
  EXPECT_GE(stops, 1);
  // and does not pass through it
  EXPECT_GT(world.state(b).velocity.z - world.state(p).velocity.z, -.005 * shot.speed);
}

TEST_P(FastBody, HandsItsMomentumToAFreePlate) {
  const Shot shot = GetParam();
  if (!shot.freePlate) return;
  World world(shooting(shot), test::options(4));
  const BodyId p = world.findBody("plate"), b = world.findBody("bullet");
  const double m = world.massOf(b).mass;
  test::run(world, static_cast<int>(shot.distance / shot.speed / kDt) + 12);
  const Vec3 momentum = m * world.state(b).velocity + world.massOf(p).mass * world.state(p).velocity;
  EXPECT_TRUE(test::near(momentum, m * shot.speed * directionOf(shot), .04 * m * shot.speed));
}

std::vector<Shot> shots() {
  std::vector<Shot> all;
  for (const bool box : {false, true})
    for (const bool freePlate : {false, true})
      for (const double speed : {50., 300., 1000.})
        for (const double degrees : {0., 30., 60., 80.})
          all.push_back({box, freePlate, speed, degrees, 11.7});
  return all;
}
INSTANTIATE_TEST_SUITE_P(Shots, FastBody, testing::ValuesIn(shots()));

TEST(FastBodyNearMiss, IsNotTouched) {
  // a millimetre beside the edge, at a place where the way begins before the plate and ends behind it
  for (const bool box : {false, true})
    for (const double start : {.02, 3.3, 16.}) {
      Scene scene = test::emptyScene({0, 0, 0});
      scene.bodies.push_back(plate(true));
      scene.bodies.push_back(bullet(box, {.51, 0, start}, {0, 0, -1000}));
      World world(scene, test::options(4));
      test::run(world, 3);
      EXPECT_EQ(world.state(world.findBody("plate")).velocity, (Vec3{}));
      EXPECT_TRUE(test::near(world.state(world.findBody("bullet")).velocity, Vec3{0, 0, -1000}, .1));
      EXPECT_TRUE(test::near(world.state(world.findBody("bullet")).position, Vec3{.51, 0, start - 50}, 1e-2));
    }
}

TEST(FastBody, DoesNotPassAPlateThatComesTowardsIt) {
  Scene scene = test::emptyScene({0, 0, 0});
  BodyDef wall = plate(false);
  wall.motion = Motion::Kinematic;
  wall.velocity = {0, 0, 20};
  scene.bodies.push_back(wall);
  scene.bodies.push_back(bullet(false, {0, 0, 5}, {0, 0, -500}));
  World world(scene, test::options(4));
  for (int i = 0; i < 20; ++i) {
    world.step();
    EXPECT_GT(world.state(world.findBody("bullet")).position.z,
              world.state(world.findBody("plate")).position.z)
        << i;
  }
  EXPECT_NEAR(world.state(world.findBody("bullet")).velocity.z, 20, .2);
}

TEST(FastBody, TwoOfThemMeetHeadOn) {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(bullet(false, {0, 0, 6}, {0, 0, -700}));
  scene.bodies.push_back(bullet(false, {0, 0, -6}, {0, 0, 700}));
  scene.bodies[1].name = "other";
  World world(scene, test::options(4));
  for (int i = 0; i < 10; ++i) {
    world.step();
    EXPECT_GT(world.state(world.findBody("bullet")).position.z,
              world.state(world.findBody("other")).position.z)
        << i;
  }
  EXPECT_LT(length(world.state(world.findBody("bullet")).velocity), 7);
}

TEST(FastBody, ThatOnlyTurnsDoesNotPassWhatIsInItsWay) {
  // a blade around its middle, which turns by up to a radian in a step and may move along with what it meets
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k) corners.push_back({k & 1 ? .5 : -.5, k & 2 ? .005 : -.005, k & 4 ? .05 : -.05});
  const Shape blades[] = {Shape::box({.5, .005, .05}), Shape::hull(corners)};
  const Shape things[] = {Shape::sphere(.01), Shape::box({.01, .01, .01}), Shape::capsule(.008, .005)};
  test::Random random(3);
  for (int sample = 0; sample < 48; ++sample) {
    const double speed = random.uniform(5, 60), distance = random.uniform(.1, .47),
                 angle = random.uniform(.5, 1.2);
    Scene scene = test::emptyScene({0, 0, 0});
    BodyDef blade = test::body(blades[sample % 2], {});
    blade.motion = Motion::Kinematic, blade.angularVelocity = {0, 0, speed};
    BodyDef thing = test::body(things[sample % 3],
                               {distance * std::cos(angle), distance * std::sin(angle), 0});
    if (sample % 4 >= 2) blade.velocity = thing.velocity = {random.uniform(-3, 3), 0, 0};
    scene.bodies = {blade, thing};
    World world(scene, test::options(4));
    const auto place = [&] {
      const BodyState of = world.state(world.bodyAt(0));
      return rotateInverse(of.orientation, world.state(world.bodyAt(1)).position - of.position);
    };
    Vec3 before = place();
    for (double turned = 0; turned < angle + 1; turned += speed * kDt) {
      world.step();
      const Vec3 now = place();
      EXPECT_FALSE(before.y > 0 && now.y < 0 && now.x > 0 && now.x < .5)
          << speed << " rad/s, at " << distance << " m, sample " << sample;
      before = now;
    }
    EXPECT_GT(length(world.state(world.bodyAt(1)).velocity - thing.velocity), 1) << sample;
  }
}

TEST(FastBody, ThatOnlyTurnsIsSweptWhateverElseIsFast) {
  test::Random random(7);
  for (int sample = 0; sample < 24; ++sample) {
    Scene scene = test::emptyScene();
    scene.bodies.push_back(test::ground());
    const Vec3 half = Vec3{.4, .4, .4} + random.vector(.2);
    BodyDef top = test::body(Shape::box(half), {0, 0, random.uniform(.2, .6)});
    top.lockTranslation = {true, true, true}, top.angularVelocity = random.vector(60);
    scene.bodies.push_back(top);
    scene.bodies.push_back(test::body(Shape::sphere(.05), {1000, 0, 1}));
    const auto turned = [&](double speedOfDistantBody) {
      scene.bodies.back().velocity = {speedOfDistantBody, 0, 0};
      World world(scene, test::options(4));
      test::run(world, 3);
      return world.state(world.bodyAt(1));
    };
    const BodyState alone = turned(0), beside = turned(300);
    EXPECT_EQ(alone.orientation, beside.orientation) << sample;
    EXPECT_EQ(alone.angularVelocity, beside.angularVelocity) << sample;
  }
}

TEST(StruckBody, IsNotDrivenIntoTheGround) {
  // a brick that leans on a stone with its upper edge in the air, hit from above by another at 20 m/s
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  BodyDef brick = test::body(Shape::box({.5, .25, .25}), {0, 0, .45});
  brick.orientation = fromAxisAngle(Vec3{0, 1, 0}, .4);
  scene.bodies.push_back(brick);
  BodyDef stone = test::body(Shape::box({.1, .25, .1}), {-.42, 0, .1});
  stone.motion = Motion::Static;
  scene.bodies.push_back(stone);
  BodyDef hammer = test::body(Shape::box({.5, .25, .25}), {-.2, 0, 8});
  hammer.velocity = {0, 0, -20};
  scene.bodies.push_back(hammer);
  World world(scene, test::options(4));
  for (int i = 0; i < 60; ++i) {
    world.step();
    for (const int body : {1, 3}) {
      const BodyState s = world.state(world.bodyAt(body));
      const Vec3 up = abs(rotateInverse(s.orientation, Vec3{0, 0, 1}));
      EXPECT_GT(s.position.z - dot(up, Vec3{.5, .25, .25}), -.06) << "body " << body << ", step " << i;
    }
  }
}

TEST(CcdIsland, StopsAsOneAndKeepsItsJointsClosed) {
  // a leaning row of small cubes on ball joints; a cube moves 0.67 m per step, and the lowest meets the
  // ground first
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::ground());
  constexpr double kHalf = .05, kStep = .08;
  for (int i = 0; i < 6; ++i) {
    BodyDef cube = test::body(Shape::box({kHalf, kHalf, kHalf}), {kStep * i, 0, .8 + kStep * i});
    cube.velocity = {0, 0, -40};
    scene.bodies.push_back(cube);
    if (i > 0)
      scene.joints.push_back(test::ball(i + 1, {-kStep / 2, 0, -kStep / 2}, i, {kStep / 2, 0, kStep / 2}));
  }
  World world(scene, test::options(4));
  int stops = 0;
  double gap = 0;
  for (int i = 0; i < 20; ++i) {
    stops += world.step().stoppedBodies;
    for (const JointId joint : world.joints()) gap = std::max(gap, world.state(joint).gap);
    for (int body = 1; body <= 6; ++body)
      EXPECT_GT(world.state(world.bodyAt(body)).position.z, 0) << "body " << body << ", step " << i;
  }
  EXPECT_GE(stops, 1);
  EXPECT_LT(gap, .08);
}

}  // namespace
}  // namespace rubble
