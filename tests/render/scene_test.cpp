/// Pictures of whole scenes: deformable objects, values as colors, any camera, and cameras that show all.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "render/framing.h"
#include "tests/render/look.h"

namespace rubble::render {
namespace {

/// Looks along +y from ten metres, up z: one metre at the target is `kPixelsPerMetre` pixels.
constexpr double kPixelsPerMetre = 10;
constexpr int kWidth = 200, kHeight = 100;
Camera frontView() { return {{0, -10, 0}, {0, 0, 0}, {0, 0, 1}, 2 * std::atan(.5)}; }

io::Image drawn(const std::vector<io::PictureBody>& bodies, const Camera& camera,
                io::ColorBy colorBy = io::ColorBy::Body, double fullValue = 0) {
  softwareContext();
  Stage stage(bodies, {0, 0, -9.81}, camera, kWidth, kHeight);
  stage.setBodies(bodies, colorBy, fullValue);
  return stage.picture(camera, {});
}

/// Is a pixel unlike the picture without bodies?
bool isCovered(const io::Image& image, const io::Image& empty, int x, int y) {
  int difference = 0;
  for (int c = 0; c < 3; ++c) difference += std::abs(channel(image, x, y, c) - channel(empty, x, y, c));
  return difference > 24;
}

/// An upright sheet in the middle of the view, a rod to its left, a particle and a solid to its right.
Scene softScene() {
  Scene scene;
  scene.gravity = {};
  ClothDef sheet = clothSheet({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, 4, 4);
  CableDef rod = straightCable({-5, 0, -2}, {-5, 0, 2}, 8);
  rod.radius = .3;
  ParticlesDef particles;
  particles.vertices = {{4, 0, 0}};
  particles.radius = .5;
  scene.deformables = {sheet, rod, particles, tetBox({6, -.5, -.5}, {1, 1, 1}, {1, 1, 1})};
  return scene;
}

TEST(ScenePicture, DeformableObjectsAreSeenWhereTheyAre) {
  World world(softScene());
  // Seen from the front and, the sheet, from behind.
  for (const double side : {1., -1.}) {
    Camera camera = frontView();
    camera.eye = camera.eye * side;
    const io::Image empty = drawn({}, camera);
    const auto covered = [&](const io::Image& image, double x, double z) {
      const int column = static_cast<int>(kWidth / 2 + kPixelsPerMetre * side * x);
      return isCovered(image, empty, column, static_cast<int>(kHeight / 2 - kPixelsPerMetre * z));
    };
    for (const auto& bodies : {io::pictureBodies(world), io::pictureBodies(softScene())}) {
      const io::Image image = drawn(bodies, camera);
      for (const double x : {0., .8, -5., 4., 6.5}) EXPECT_TRUE(covered(image, x, .3)) << x << ", " << side;
      for (const double x : {-2., 2., -4., 5.2, 8.}) EXPECT_FALSE(covered(image, x, .3)) << x << ", " << side;
    }
  }
}

TEST(ScenePicture, SpeedHasItsOwnColors) {
  std::vector<io::PictureBody> bodies{bodyOf(Shape::box({1, 1, 1}))};
  const io::Image slow = drawn(bodies, frontView(), io::ColorBy::Speed, 10);
  bodies[0].speed = 10;
  const io::Image fast = drawn(bodies, frontView(), io::ColorBy::Speed, 10);
  EXPECT_GT(channel(slow, 100, 50, 2), channel(slow, 100, 50, 0)) << "blue at rest";
  EXPECT_GT(channel(fast, 100, 50, 0), 1.5 * channel(fast, 100, 50, 2)) << "red at the full value";
}

TEST(ScenePicture, AnyCameraInAnySceneGivesAPicture) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> place(-3, 3);
  const auto point = [&] { return Vec3{place(random), place(random), place(random)}; };
  std::vector<io::PictureBody> bodies{bodyOf(Shape::plane())};
  for (int i = 0; i < 60; ++i) {
    const Shape shape = i % 3 == 0   ? Shape::box({.5, 1, .2})
                        : i % 3 == 1 ? Shape::sphere(.7)
                                     : Shape::capsule(.3, 1);
    bodies.push_back(bodyOf(shape, point()));
    bodies.back().orientation = normalize(Quat{place(random), place(random), place(random), 1});
    bodies.back().key = static_cast<std::uint32_t>(i);
  }
  bodies.push_back(bodyOf(Shape::sphere(1), {std::numeric_limits<double>::quiet_NaN(), 0, 0}));
  bodies.push_back(bodyOf(Shape::box({1e6, 1e6, 1e6}), {1e7, 0, 0}));
  int telling = 0;  // pictures of more than sky, or of one face from near by
  for (int i = 0; i < 20; ++i) {
    Camera camera{point(), point(), point(), .6};
    if (i % 5 == 0) camera.up = camera.target - camera.eye;
    const io::Image image = drawn(bodies, camera);
    ASSERT_EQ(image.rgb.size(), 3u * kWidth * kHeight);
    double low = 255, high = 0;
    for (int x = 0; x < kWidth; ++x) {
      for (int y = 0; y < kHeight; ++y) {
        low = std::min(low, brightness(image, x, y));
        high = std::max(high, brightness(image, x, y));
      }
    }
    telling += high - low > 40;
  }
  EXPECT_GE(telling, 15);
}

TEST(Framing, ShowsEverything) {
  std::vector<io::PictureBody> bodies;
  for (int i = 0; i < 20; ++i)
    bodies.push_back(bodyOf(Shape::box({.5, .25, .25}), {i * 1.05, .25 * i, 2. * (i % 3)}));
  for (const Vec3& gravity : {Vec3{0, -9.81, 0}, Vec3{0, 0, -9.81}, Vec3{}, Vec3{3, 1, -2}}) {
    for (const double aspect : {.5, 1., 16. / 9}) {
      const Camera camera = cameraShowing(bodies, gravity, {{}, 0, aspect, .6});
      const Vec3 forward = normalize(camera.target - camera.eye),
                 right = normalize(cross(forward, camera.up));
      const Vec3 up = cross(right, forward);
      const double tall = std::tan(camera.fieldOfView / 2), wide = tall * aspect;
      double most = 0;
      for (const io::PictureBody& body : bodies) {
        const Vec3 p = body.position - camera.eye;
        const double across = std::fabs(dot(p, right)) / (wide * dot(p, forward));
        most = std::max({most, across, std::fabs(dot(p, up)) / (tall * dot(p, forward))});
      }
      EXPECT_LT(most, 1) << aspect;
      EXPECT_GT(most, .4) << aspect << ": they fill the picture";
    }
  }
}

}  // namespace
}  // namespace rubble::render
