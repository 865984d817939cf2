#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rubble/joints.h>

#include "io/picture.h"
#include "rubble/error.h"

namespace rubble::io {
namespace {

TEST(Picture, DeformableObjectsKeepKeysOfTheirOwn) {
  Scene scene;
  CableDef rod = straightCable({-5, 0, -2}, {-5, 0, 2}, 8);
  rod.radius = .3;
  ParticlesDef particles;
  particles.vertices = {{4, 0, 0}};
  particles.radius = .5;
  scene.deformables = {clothSheet({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, 4, 4), rod, particles,
                       tetBox({6, 0, 0}, {1, 1, 1}, {1, 1, 1})};
  scene.bodies.emplace_back();
  std::set<std::uint32_t> keys;
  const std::vector<PictureBody> bodies = pictureBodies(World(scene));
  for (const PictureBody& body : bodies) keys.insert(body.key);
  EXPECT_EQ(keys.size(), 5u);
  // what deforms stands last
  EXPECT_FALSE(bodies[1].deforms);
  for (std::size_t i = 2; i < bodies.size(); ++i) EXPECT_TRUE(bodies[i].deforms);
}

/// Two wheels on hinges, and a gear between them. The axes are along y.
Scene gearPair(double radiusA, double radiusB, double angle) {
  Scene scene;
  const Vec3 centers[] = {{0, 0, 5},
                          Vec3{0, 0, 5} + Vec3{std::cos(angle), 0, std::sin(angle)} * (radiusA + radiusB)};
  for (const int wheel : {0, 1}) {
    BodyDef& body = scene.bodies.emplace_back();
    body.shape = Shape::cylinder(wheel == 0 ? radiusA : radiusB, .05);
    body.position = centers[wheel];
    body.orientation = fromAxisAngle(Vec3{1, 0, 0}, std::numbers::pi / 2);
  }
  for (const int wheel : {0, 1})
    scene.joints.push_back(
        jointAt(scene, JointType::Hinge, wheel, kWorld, centers[wheel], frameAlong({0, 1, 0})));
  scene.joints.push_back(gearBetween(scene, 0, 1, radiusB / radiusA));
  return scene;
}

/// The rim of a drawn wheel in the x-z plane of the world, in order around it.
std::vector<Vec3> rimOf(const PictureBody& wheel) {
  std::vector<Vec3> rim;
  const std::vector<Vec3>& points = wheel.shape.geometry->points;
  for (std::size_t i = 2; i < points.size(); i += 2)
    rim.push_back(wheel.position + rotate(wheel.orientation, points[i]));
  return rim;
}

/// Is a point inside of a polygon in the x-z plane? By the crossings of a ray.
bool isInside(const std::vector<Vec3>& polygon, const Vec3& p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec3 &a = polygon[i], &b = polygon[j];
    if ((a.z > p.z) != (b.z > p.z) && p.x < (b.x - a.x) * (p.z - a.z) / (b.z - a.z) + a.x) inside = !inside;
  }
  return inside;
}

TEST(PictureOfMachines, TeethOfGearsMeshAndKeepOutOfOneAnother) {
  std::mt19937 random(7);
  for (int round = 0; round < 40; ++round) {
    const int teethA = std::uniform_int_distribution(10, 30)(random),
              teethB = std::uniform_int_distribution(teethA, 40)(random);
    const double angle = std::uniform_real_distribution(0., 6.28)(random);
    const std::vector<PictureBody> bodies = pictureBodies(World(gearPair(teethA * .01, teethB * .01, angle)));
    ASSERT_EQ(bodies[0].shape.type, ShapeType::Mesh);
    const std::vector<Vec3> rims[] = {rimOf(bodies[0]), rimOf(bodies[1])};
    EXPECT_EQ(rims[0].size() * std::size_t(teethB), rims[1].size() * std::size_t(teethA));
    double reach = 0;
    for (const int wheel : {0, 1}) {
      for (const Vec3& p : rims[wheel])
        EXPECT_FALSE(isInside(rims[1 - wheel], p)) << teethA << " and " << teethB << " teeth";
      reach += length(rims[wheel][1] - bodies[std::size_t(wheel)].position);
    }
    EXPECT_GT(reach, length(bodies[1].position - bodies[0].position))
        << "teeth reach between those of the other";
  }
}

TEST(PictureOfMachines, WheelsWithMoreTeethThanCanBeSeenStayPlain) {
  for (const double ratio : {20., 1e3, 1e18}) {
    Scene scene = gearPair(.1, .3, 0);
    scene.joints.back().ratio = ratio;
    const std::vector<PictureBody> bodies = pictureBodies(World(scene));
    EXPECT_EQ(bodies[0].shape.type, ShapeType::Mesh);
    EXPECT_EQ(bodies[1].shape.type, ratio > 100 ? ShapeType::Cylinder : ShapeType::Mesh);
  }
}

TEST(PictureOfMachines, StandsAreNoBodies) {
  Scene scene = gearPair(.2, .3, 0);
  scene.bodies.emplace_back().shape = Shape::plane();
  scene.bodies.back().motion = Motion::Static;
  scene.bodies.back().position = {0, 0, 4};
  const World world(scene);
  const std::vector<PictureBody> bodies = pictureBodies(world);
  // two posts and an axle for each
  ASSERT_EQ(bodies.size(), 3u + 6u);
  std::set<std::uint32_t> keys;
  for (const PictureBody& body : bodies) keys.insert(body.key);
  EXPECT_EQ(keys.size(), bodies.size());
  for (std::size_t i = 3; i < bodies.size(); ++i) EXPECT_EQ(bodies[i].motion, Motion::Static);
  EXPECT_TRUE(hasMachines(world));
  EXPECT_FALSE(hasMachines(World(Scene{})));
}

/// A world of these bodies and one joint between the first one and the world.
World heldBy(JointType type, const Shape& shape, const Vec3& axis, std::vector<BodyDef> others = {}) {
  Scene scene;
  BodyDef body;
  body.shape = shape;
  scene.bodies = {body};
  scene.bodies.insert(scene.bodies.end(), others.begin(), others.end());
  scene.joints = {jointAt(scene, type, 0, kWorld, {-.4, 0, 0}, frameAlong(axis))};
  return World(scene);
}
std::vector<PictureBody> standsIn(const World& world) {
  std::vector<PictureBody> bodies = pictureBodies(world);
  std::erase_if(bodies, [](const PictureBody& body) { return body.key < kStandKeys || body.deforms; });
  return bodies;
}

TEST(PictureOfMachines, ADoorHasItsPostAndASliderItsRail) {
  World door = heldBy(JointType::Hinge, Shape::box({.4, .05, 1}), {0, 0, 1});
  const std::vector<PictureBody> post = standsIn(door);
  ASSERT_EQ(post.size(), 1u);
  // from below the door to above it, at its hinge
  EXPECT_NEAR(post[0].position.x, -.4, 1e-12);
  EXPECT_NEAR(post[0].position.z + extentAlong(post[0], {0, 0, 1}), 1.1, 1e-12);
  EXPECT_LE(post[0].position.z - extentAlong(post[0], {0, 0, 1}), -1 + 1e-12);

  World slider = heldBy(JointType::Slider, Shape::box({.4, .1, .1}), {1, 0, 0});
  const std::vector<PictureBody> rail = standsIn(slider);
  ASSERT_FALSE(rail.empty());
  EXPECT_NEAR(rail[0].position.z + extentAlong(rail[0], {0, 0, 1}), -.1, 1e-12)
      << "it touches the body from below";
  EXPECT_GT(extentAlong(rail[0], {1, 0, 0}), .8);
  // stands stay as they are while the body moves
  door.setVelocity(door.bodyAt(0), {0, 3, 0}, {0, 0, 3});
  for (int step = 0; step < 20; ++step) door.step(), slider.step();
  EXPECT_EQ(standsIn(door)[0].position, post[0].position);
  EXPECT_EQ(standsIn(slider)[0].position, rail[0].position);
}

TEST(PictureOfMachines, TheRailOfACrankReachesAsFarAsItsPistonGoes) {
  constexpr double kHalf = .1;
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    std::uniform_real_distribution<double> angle(-3, 3), share(.2, .9);
    const double radius = share(random), rod = radius / share(random), turned = angle(random),
                 side = i % 2 == 0 ? 1 : -1;
    const Vec3 pin = Vec3{side * std::cos(turned), 0, std::sin(turned)} * radius;
    const Vec3 piston{pin.x + side * std::sqrt(rod * rod - pin.z * pin.z), 0, 0};
    Scene scene;
    for (const Vec3& at : {pin * .5, (pin + piston) * .5, piston}) {
      BodyDef body;
      body.shape = Shape::box({kHalf, kHalf, kHalf});
      body.position = at;
      scene.bodies.push_back(body);
    }
    const Quat across = frameAlong({0, 1, 0});
    scene.joints = {jointAt(scene, JointType::Hinge, 0, kWorld, {}, across),
                    jointAt(scene, JointType::Hinge, 0, 1, pin, across),
                    jointAt(scene, JointType::Hinge, 1, 2, piston, across),
                    jointAt(scene, JointType::Slider, 2, kWorld, piston, frameAlong({1, 0, 0}))};
    // of the stands of the crank and the piston only the rail is as wide as this
    double low = 0, high = 0;
    for (const PictureBody& part : standsIn(World(scene))) {
      const double reach = extentAlong(part, {1, 0, 0});
      if (reach > high - low) low = part.position.x - reach, high = part.position.x + reach;
    }
    const double nearest = rod - radius - kHalf, farthest = rod + radius + kHalf;
    EXPECT_NEAR(side > 0 ? low : -high, nearest, 1e-9) << i;
    EXPECT_NEAR(side > 0 ? high : -low, farthest, 1e-9) << i;
  }
}

TEST(Picture, ACylinderReachesItsRadiusAcrossItsAxisInAllDirections) {
  PictureBody disc;
  disc.shape = Shape::cylinder(.5, .1);
  for (const double angle : {0., .7, std::numbers::pi / 2, 2.})
    EXPECT_NEAR(extentAlong(disc, {std::cos(angle), std::sin(angle), 0}), .5, 1e-12) << angle;
  EXPECT_NEAR(extentAlong(disc, {0, 0, 1}), .1, 1e-12);
}

TEST(PictureOfMachines, APulleyHasAWheelBetweenItsPointsOrOneAtEach) {
  for (const double half : {.3, 5.}) {
    Scene scene;
    for (const double side : {-1., 1.}) {
      BodyDef body;
      body.shape = Shape::sphere(.2);
      body.position = {side * half, 0, -3};
      scene.bodies.push_back(body);
    }
    const PulleyJoint rope{.bodyA = 0, .bodyB = 1, .pulleyA = {-half, 0, 0}, .pulleyB = {half, 0, 0}};
    scene.joints = {rope};
    const std::vector<PictureBody> stands = standsIn(World(scene));
    std::vector<PictureBody> wheels;
    for (const PictureBody& body : stands)
      if (body.shape.type == ShapeType::Cylinder) wheels.push_back(body);
    ASSERT_EQ(wheels.size(), half < 1 ? 1u : 2u);
    // the rope leaves at the rims
    EXPECT_NEAR(wheels[0].position.x - wheels[0].shape.radius, -half, 1e-12);
    EXPECT_NEAR(wheels.back().position.x + wheels.back().shape.radius, half, 1e-12);
    EXPECT_NEAR(std::fabs(rotate(wheels[0].orientation, Vec3{0, 0, 1}).y), 1, 1e-12) << "the axle is level";
  }
}

TEST(Picture, PngFilesThatCannotBeWrittenAreErrors) {
  EXPECT_THROW(writePng({1, 1, {0, 0, 0}}, "/nowhere/at/all.png"), Error);
}

#if defined(RUBBLE_HAS_PNG)
TEST(Picture, PngFilesHaveTheirSignatureAndSize) {
  const std::string file = (std::filesystem::temp_directory_path() /
                            ("rubble_picture_" + std::to_string(std::random_device{}()) + ".png"))
                               .string();
  writePng({3, 2, std::vector<std::uint8_t>(18, 77)}, file);
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes.substr(16, 8), std::string("\0\0\0\3\0\0\0\2", 8));
  std::filesystem::remove(file);
}
#endif

}  // namespace
}  // namespace rubble::io
