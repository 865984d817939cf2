/// Loose cargo in a closed box that moves or turns: it stays in, and moves in the box as in one at rest. The
/// box is 4 m wide with walls of 20 cm.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/expect.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::kDt;

constexpr double kRoom = 2, kWall = .2;  // half the width of the room, and the thickness of its walls [m]

enum class BoxKind { Walls, Compound, Mesh, Free };
struct Ride {
  BoxKind kind;
  Vec3 velocity, spin;
};
std::ostream& operator<<(std::ostream& out, const Ride& r) {
  static constexpr const char* kNames[] = {"walls", "compound", "mesh", "free"};
  const auto of = [&](const Vec3& v) { out << " (" << v.x << ' ' << v.y << ' ' << v.z << ')'; };
  out << kNames[static_cast<int>(r.kind)];
  return of(r.velocity), of(r.spin), out;
}

/// Adds the box; its first body has the pose of the room.
void addBox(Scene& scene, const Ride& ride) {
  std::vector<ShapePartDef> walls;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1., 1.}) {
      Vec3 half{kRoom + kWall, kRoom + kWall, kRoom + kWall}, at{};
      half[axis] = kWall / 2, at[axis] = side * (kRoom + kWall / 2);
      walls.push_back({Shape::box(half), at, {}});
    }
  const auto add = [&](const Shape& shape, const Vec3& at) {
    BodyDef box = test::body(shape, at);
    box.motion = ride.kind == BoxKind::Free ? Motion::Dynamic : Motion::Kinematic;
    box.density = 3000, box.gravityScale = 0;
    box.velocity = ride.velocity + cross(ride.spin, at), box.angularVelocity = ride.spin;
    scene.bodies.push_back(box);
  };
  if (ride.kind == BoxKind::Walls) {
    add(Shape::sphere(.01), {0, 0, kRoom + 2 * kWall});
    for (const ShapePartDef& wall : walls) add(wall.shape, wall.position);
  } else if (ride.kind == BoxKind::Mesh) {
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k)
      corners.push_back({k & 4 ? kRoom : -kRoom, k & 2 ? kRoom : -kRoom, k & 1 ? kRoom : -kRoom});
    add(Shape::mesh(corners,
                    {{0, 1, 3},
                     {0, 3, 2},
                     {4, 6, 7},
                     {4, 7, 5},
                     {0, 4, 5},
                     {0, 5, 1},
                     {2, 3, 7},
                     {2, 7, 6},
                     {0, 2, 6},
                     {0, 6, 4},
                     {1, 5, 7},
                     {1, 7, 3}},
                    true),
        {});
  } else {
    add(Shape::compound(walls), {});
  }
}

/// 27 things of 5 to 25 cm that move at up to 5 m/s along each axis of the room. Returns their number.
std::size_t addCargo(Scene& scene, const Ride& ride, test::Random& random) {
  const std::size_t before = scene.bodies.size();
  for (int k = 0; k < 27; ++k) {
    const Vec3 at = 1.3 * Vec3{k % 3 - 1., k / 3 % 3 - 1., k / 9 - 1.};
    const double r = random.uniform(.05, .25);
    const Vec3 half = r * Vec3{random.uniform(.4, 1), random.uniform(.4, 1), random.uniform(.4, 1)};
    BodyDef thing = test::body(k % 3 == 0   ? Shape::sphere(r)
                               : k % 3 == 1 ? Shape::box(half)
                                            : Shape::capsule(r / 2, r / 2),
                               at);
    thing.velocity = ride.velocity + cross(ride.spin, at) + random.vector(5);
    thing.angularVelocity = random.vector(5);
    scene.bodies.push_back(thing);
  }
  return scene.bodies.size() - before;
}

class Cargo : public testing::TestWithParam<Ride> {};

TEST_P(Cargo, StaysInABoxThatMovesOrTurns) {
  const Ride& ride = GetParam();
  // what turns with the box, and falls in it meanwhile
  const double fastest = 12 + 2 * length(ride.spin) * kRoom;
  test::Random random(5);
  for (int sample = 0; sample < 2; ++sample) {
    Scene scene = test::emptyScene();
    addBox(scene, ride);
    const std::size_t things = addCargo(scene, ride, random);
    World world(scene, test::options(4));
    const std::vector<BodyId> ids = world.bodies();
    for (int i = 0; i < 180; ++i) {
      world.step();
      const BodyState box = world.state(ids.front());
      const Vec3 center = ride.kind == BoxKind::Walls ? box.position - Vec3{0, 0, kRoom + 2 * kWall}
                                                      : box.position;
      for (std::size_t k = ids.size() - things; k < ids.size(); ++k) {
        const BodyState thing = world.state(ids[k]);
        const Vec3 at = rotateInverse(box.orientation, thing.position - center),
                   v = thing.velocity - box.velocity;
        const double out = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) - kRoom;
        ASSERT_LT(out, ride.kind == BoxKind::Mesh ? .02 : kWall / 2)
            << k << " in step " << i << ", sample " << sample;
        ASSERT_LT(length(v), fastest) << k << " in step " << i << ", sample " << sample;
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(
    Rides, Cargo,
    testing::Values(Ride{BoxKind::Walls, {}, {}}, Ride{BoxKind::Walls, {30, 0, 0}, {}},
                    Ride{BoxKind::Walls, {60, 80, 0}, {}}, Ride{BoxKind::Walls, {0, 0, -100}, {}},
                    Ride{BoxKind::Walls, {300, 0, 0}, {}}, Ride{BoxKind::Compound, {100, 30, 0}, {}},
                    Ride{BoxKind::Compound, {50, 0, 0}, {0, 0, 2}}, Ride{BoxKind::Compound, {}, {0, 3, 0}},
                    Ride{BoxKind::Compound, {}, {0, 0, 6}}, Ride{BoxKind::Mesh, {100, 30, 0}, {}},
                    Ride{BoxKind::Mesh, {}, {0, 0, 3}}, Ride{BoxKind::Mesh, {}, {3, 0, 0}},
                    Ride{BoxKind::Free, {}, {}}, Ride{BoxKind::Free, {30, 0, 0}, {}},
                    Ride{BoxKind::Free, {100, 0, 0}, {}}, Ride{BoxKind::Free, {}, {0, 0, 1}},
                    Ride{BoxKind::Free, {}, {0, 0, 3}}, Ride{BoxKind::Free, {20, 0, 0}, {0, 6, 0}}),
    [](const auto& info) { return "Ride" + std::to_string(info.index); });

TEST(CargoThatMeets, GainsNoSpeedInAMovingFrame) {
  // heaps that fall into a bin on a platform of 300 m/s: no impact gives what falls more than its speed
  for (const double speed : {0., 50., 300.}) {
    test::Random random(4);
    Scene scene = test::emptyScene();
    const Vec3 v{speed, 0, 0};
    const auto fixed = [&](const Vec3& half, const Vec3& at) {
      BodyDef wall = test::body(Shape::box(half), at);
      wall.motion = Motion::Kinematic, wall.velocity = v;
      scene.bodies.push_back(wall);
    };
    fixed({10, 10, .5}, {0, 0, -.5});
    for (const double side : {-1.2, 1.2})
      fixed({.1, 1.2, 1}, {side, 0, 1}), fixed({1.2, .1, 1}, {0, side, 1});
    for (int k = 0; k < 100; ++k) {
      const double r = random.uniform(.05, .2);
      BodyDef thing = test::body(k % 2 == 0 ? Shape::sphere(r) : Shape::box({r, .8 * r, .6 * r}),
                                 {random.uniform(-.8, .8), random.uniform(-.8, .8), .3 + .08 * k});
      thing.velocity = v;
      scene.bodies.push_back(thing);
    }
    World world(scene, test::options(4));
    for (int i = 0; i < 150; ++i) {
      world.step();
      for (const BodyId id : world.bodies())
        ASSERT_LT(length(world.state(id).velocity - v), 16) << speed << " m/s, step " << i;
    }
  }
}

TEST(Drum, KeepsWhatItTumbles) {
  // twelve walls of 6 cm about y, 2 m across
  constexpr int kSides = 12;
  constexpr double kRadius = 1, kThick = .06, kLength = 1;
  std::vector<ShapePartDef> walls;
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSides,
                 wide = (kRadius + kThick) * std::tan(std::numbers::pi / kSides);
    const Quat turn = fromAxisAngle({0, 1, 0}, angle);
    walls.push_back(
        {Shape::box({kThick / 2, kLength / 2, wide}), rotate(turn, Vec3{kRadius + kThick / 2, 0, 0}), turn});
  }
  for (const double side : {-1., 1.})
    walls.push_back(
        {Shape::box({kRadius + .1, kThick / 2, kRadius + .1}), {0, side * (kLength + kThick) / 2, 0}, {}});
  for (const double spin : {1., 3., 6., 10., 20.}) {
    test::Random random(2);
    Scene scene = test::emptyScene();
    BodyDef drum = test::body(Shape::compound(walls), {});
    drum.motion = Motion::Kinematic, drum.angularVelocity = {0, spin, 0};
    scene.bodies.push_back(drum);
    for (int k = 0; k < 24; ++k) {
      const double r = random.uniform(.03, .1);
      scene.bodies.push_back(test::body(k % 3 == 0   ? Shape::sphere(r)
                                        : k % 3 == 1 ? Shape::box({r, .7 * r, .5 * r})
                                                     : Shape::capsule(r / 2, r / 2),
                                        random.vector(.4)));
    }
    World world(scene, test::options(4));
    for (int i = 0; i < 240; ++i) {
      world.step();
      for (int k = 1; k <= 24; ++k) {
        const Vec3 at = world.state(world.bodyAt(k)).position;
        ASSERT_LT(std::hypot(at.x, at.z), kRadius / std::cos(std::numbers::pi / kSides))
            << spin << " rad/s, " << k;
        ASSERT_LT(std::abs(at.y), kLength / 2) << spin << " rad/s, " << k;
      }
    }
  }
}

TEST(Turntable, CarriesABoxOnItsCircle) {
  for (const double spin : {.5, 1., 1.5}) {
    Scene scene = test::emptyScene();
    BodyDef table = test::body(Shape::cylinder(4, .25), {0, 0, -.25});
    table.motion = Motion::Kinematic, table.angularVelocity = {0, 0, spin};
    BodyDef box = test::body(Shape::box({.2, .2, .1}), {1.5, 0, .1});
    box.velocity = cross(table.angularVelocity, box.position), box.angularVelocity = table.angularVelocity;
    scene.bodies = {table, box};
    World world(scene, test::options(4));
    test::run(world, 600);
    const BodyState end = world.state(world.bodyAt(1)), under = world.state(world.bodyAt(0));
    const Vec3 at = rotateInverse(under.orientation, end.position - under.position);
    EXPECT_NEAR(at.x, 1.5, .02) << spin << " rad/s";
    EXPECT_NEAR(at.y, 0, .02) << spin << " rad/s";
  }
}

}  // namespace
}  // namespace rubble
