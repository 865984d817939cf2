#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "io/picture.h"
#include "io/picture_raster.h"
#include "rubble/error.h"

namespace rubble::io {
namespace {

struct Color {
  int red, green, blue;
};
Color at(const Image& image, int x, int y) {
  const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                             static_cast<std::size_t>(x));
  return {image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]};
}

/// Looks along +y from ten metres, up z: one metre at the target is `kPixelsPerMetre` pixels.
PictureSettings frontView() {
  PictureSettings settings;
  settings.width = 200;
  settings.height = 100;
  settings.eye = {0, -10, 0};
  settings.target = {0, 0, 0};
  settings.fieldOfView = 2 * std::atan(.5);
  return settings;
}
constexpr double kPixelsPerMetre = 10;

PictureBody bodyOf(const Shape& shape, const Vec3& position = {}) {
  PictureBody body;
  body.shape = shape;
  body.position = position;
  return body;
}

/// Is a pixel unlike the picture without bodies?
bool isCovered(const Image& image, const Image& empty, int x, int y) {
  const Color a = at(image, x, y), b = at(empty, x, y);
  return std::abs(a.red - b.red) + std::abs(a.green - b.green) + std::abs(a.blue - b.blue) > 24;
}

/// A sheet that stands up in the middle of the view, a rod to its left, a grain and a solid to its right.
Scene softScene() {
  Scene scene;
  scene.gravity = {};
  ClothDef sheet = clothSheet({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, 4, 4);
  RodDef rod = straightRod({-5, 0, -2}, {-5, 0, 2}, 8);
  rod.radius = .3;
  ParticlesDef grains;
  grains.vertices = {{4, 0, 0}};
  grains.radius = .5;
  scene.deformables = {sheet, rod, grains, softBox({6, -.5, -.5}, {1, 1, 1}, {1, 1, 1})};
  return scene;
}

TEST(Picture, DeformableObjectsAreSeenWhereTheyAre) {
  World world(softScene());
  const PictureSettings settings = frontView();
  const Image empty = drawPicture({}, settings);
  const auto covered = [&](const Image& image, double x, double z) {
    return isCovered(image, empty, static_cast<int>(100 + kPixelsPerMetre * x),
                     static_cast<int>(50 - kPixelsPerMetre * z));
  };
  // seen from the front and, the sheet, from behind
  for (const double side : {1., -1.}) {
    PictureSettings from = settings;
    from.eye = settings.eye * side;
    for (const Image& image :
         {drawPicture(pictureBodies(world), from), drawPicture(pictureBodies(softScene()), from)}) {
      for (const double x : {0., .8, -5., 4., 6.5}) EXPECT_TRUE(covered(image, side * x, .3)) << x;
      for (const double x : {-2., 2., -4., 5.2, 8.}) EXPECT_FALSE(covered(image, side * x, .3)) << x;
    }
  }
  // and elsewhere in the next frame
  const SoftId sheet = world.deformableAt(0);
  std::vector<Vec3> moved = world.positions(sheet);
  for (Vec3& x : moved) x.z += 3;
  world.setVertices(sheet, moved, world.velocities(sheet));
  const Image later = drawPicture(pictureBodies(world), settings);
  EXPECT_FALSE(covered(later, 0, .3));
  EXPECT_TRUE(covered(later, 0, 3.3));
}

TEST(Picture, DeformableObjectsKeepKeysOfTheirOwn) {
  Scene scene = softScene();
  scene.bodies.emplace_back();
  std::set<std::uint32_t> keys;
  const std::vector<PictureBody> bodies = pictureBodies(World(scene));
  for (const PictureBody& body : bodies) keys.insert(body.key);
  EXPECT_EQ(keys.size(), 5u);
  // what deforms stands last
  EXPECT_FALSE(bodies[1].deforms);
  for (std::size_t i = 2; i < bodies.size(); ++i) EXPECT_TRUE(bodies[i].deforms);
}

TEST(Picture, ACubeCoversItsPixels) {
  const PictureSettings settings = frontView();
  // The near face of a cube of 4 m about the origin is 8 m away and 2 m to each side: 25 pixels.
  const std::vector<PictureBody> bodies{bodyOf(Shape::box({2, 2, 2}))};
  const Image image = drawPicture(bodies, settings), empty = drawPicture({}, settings);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double across = std::max(std::fabs(x + .5 - 100), std::fabs(y + .5 - 50));
      // Pixels at the outline may be covered in part.
      if (std::fabs(across - 25) < 1) continue;
      EXPECT_EQ(isCovered(image, empty, x, y), across < 25) << x << ", " << y;
    }
  }
}

TEST(Picture, ASphereAndACapsuleCoverTheirPixels) {
  const PictureSettings settings = frontView();
  const Image empty = drawPicture({}, settings);
  const std::vector<PictureBody> sphere{bodyOf(Shape::sphere(1))};
  const Image ball = drawPicture(sphere, settings);
  // Seen at the angle asin(1/10) from its centre.
  const double radius = 100 * std::tan(std::asin(.1));
  std::vector<PictureBody> rod{bodyOf(Shape::capsule(.5, 3))};
  rod[0].orientation = fromAxisAngle(Vec3{0, 1, 0}, std::acos(0.));
  const Image capsule = drawPicture(rod, settings);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double dx = x + .5 - 100, dy = y + .5 - 50;
      const double fromBall = std::hypot(dx, dy) - radius;
      if (std::fabs(fromBall) > 1) {
        EXPECT_EQ(isCovered(ball, empty, x, y), fromBall < 0) << x << ", " << y;
      }
      const double fromRod = std::hypot(std::max(0., std::fabs(dx) - 3 * kPixelsPerMetre), dy) -
                             .5 * kPixelsPerMetre;
      if (std::fabs(fromRod) > 1) {
        EXPECT_EQ(isCovered(capsule, empty, x, y), fromRod < 0) << x << ", " << y;
      }
    }
  }
}

TEST(Picture, TheNearerBodyIsInFront) {
  const PictureSettings settings = frontView();
  const PictureBody box = bodyOf(Shape::box({1, 1, 1}), {0, 3, 0}),
                    sphere = bodyOf(Shape::sphere(1), {0, -3, 0});
  const std::vector<PictureBody> one{box, sphere}, other{sphere, box}, alone{sphere};
  const Color a = at(drawPicture(one, settings), 100, 50), b = at(drawPicture(other, settings), 100, 50);
  const Color c = at(drawPicture(alone, settings), 100, 50);
  EXPECT_GT(a.blue, a.red);
  EXPECT_GT(b.blue, b.red);
  EXPECT_NEAR(a.red, c.red, 40);
}

TEST(Picture, ABodyThrowsAShadowOnTheGround) {
  PictureSettings settings = frontView();
  settings.eye = {0, -10, 6};
  std::vector<PictureBody> bodies{bodyOf(Shape::plane(), {0, 0, -1})};
  bodies[0].motion = Motion::Static;
  const Image bare = drawPicture(bodies, settings);
  bodies.push_back(bodyOf(Shape::sphere(1), {0, 0, .5}));
  const Image shaded = drawPicture(bodies, settings);
  int darker = 0;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 200; ++x) {
      const Color a = at(bare, x, y), b = at(shaded, x, y);
      // Shade is grey; the ball itself is blue.
      darker += a.red - b.red > 40 && std::abs(b.red - b.blue) < 45;
    }
  EXPECT_GT(darker, 60);
}

TEST(Picture, SpeedHasItsOwnColours) {
  PictureSettings settings = frontView();
  settings.colorBy = ColorBy::Speed;
  settings.fullValue = 10;
  std::vector<PictureBody> bodies{bodyOf(Shape::box({1, 1, 1}))};
  const Color slow = at(drawPicture(bodies, settings), 100, 50);
  bodies[0].speed = 10;
  const Color fast = at(drawPicture(bodies, settings), 100, 50);
  EXPECT_GT(slow.blue, slow.red);
  EXPECT_GT(fast.red, 2 * fast.blue);
}

TEST(Picture, AnyCameraInAnyCrowdGivesAPicture) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> place(-3, 3);
  const auto point = [&] { return Vec3{place(random), place(random), place(random)}; };
  std::vector<PictureBody> bodies{bodyOf(Shape::plane())};
  for (int i = 0; i < 60; ++i) {
    bodies.push_back(bodyOf(i % 3 == 0   ? Shape::box({.5, 1, .2})
                            : i % 3 == 1 ? Shape::sphere(.7)
                                         : Shape::capsule(.3, 1),
                            point()));
    bodies.back().orientation = normalize(Quat{place(random), place(random), place(random), 1});
    bodies.back().key = static_cast<std::uint32_t>(i);
  }
  bodies.push_back(bodyOf(Shape::sphere(1), {std::nan(""), 0, 0}));
  bodies.push_back(bodyOf(Shape::box({1e6, 1e6, 1e6}), {1e7, 0, 0}));
  for (int i = 0; i < 20; ++i) {
    PictureSettings settings;
    settings.width = 61;
    settings.height = 37;
    settings.eye = point();
    settings.target = point();
    settings.up = i % 5 == 0 ? settings.target - settings.eye : point();
    const Image image = drawPicture(bodies, settings);
    EXPECT_EQ(image.rgb.size(), 3u * 61 * 37);
  }
}

TEST(Picture, FramingShowsEverything) {
  std::vector<PictureBody> bodies;
  for (int i = 0; i < 20; ++i)
    bodies.push_back(bodyOf(Shape::box({.5, .25, .25}), {i * 1.05, .25 * i, 2. * (i % 3)}));
  for (const Vec3& gravity : {Vec3{0, -9.81, 0}, Vec3{0, 0, -9.81}, Vec3{}, Vec3{3, 1, -2}}) {
    PictureSettings settings;
    frameBodies(bodies, gravity, settings);
    const Vec3 forward = normalize(settings.target - settings.eye),
               right = normalize(cross(forward, settings.up)), up = cross(right, forward);
    const double tall = std::tan(settings.fieldOfView / 2), wide = tall * settings.width / settings.height;
    for (const PictureBody& body : bodies) {
      const Vec3 p = body.position - settings.eye;
      EXPECT_LT(std::fabs(dot(p, right)), wide * dot(p, forward));
      EXPECT_LT(std::fabs(dot(p, up)), tall * dot(p, forward));
    }
  }
}

TEST(Picture, BadSettingsAreErrors) {
  PictureSettings settings;
  settings.width = 0;
  EXPECT_THROW(drawPicture({}, settings), Error);
  settings = {};
  settings.eye = settings.target;
  EXPECT_THROW(drawPicture({}, settings), Error);
  settings = {};
  settings.fieldOfView = 4;
  EXPECT_THROW(drawPicture({}, settings), Error);
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
