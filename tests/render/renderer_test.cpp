#include <cmath>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>
#include <rubble/error.h>

#include "tests/render/look.h"

namespace rubble::render {
namespace {

/// Looks along +y from ten metres, up z: one metre at the target is `kPixelsPerMetre` pixels.
constexpr double kPixelsPerMetre = 10;
Camera frontView() { return {{0, -10, 0}, {0, 0, 0}, {0, 0, 1}, 2 * std::atan(.5)}; }
constexpr int kWidth = 200, kHeight = 100;

class Rendering : public testing::Test {
 protected:
  HeadlessContext& context_ = softwareContext();
};

std::vector<io::PictureBody> numbered(std::vector<io::PictureBody> bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].key = static_cast<std::uint32_t>(i);
  return bodies;
}

io::Image drawn(const std::vector<io::PictureBody>& unnumbered, const Camera& camera = frontView(),
                int samples = 1) {
  const std::vector<io::PictureBody> bodies = numbered(unnumbered);
  Stage stage(bodies, {0, 0, -9.81}, camera, kWidth, kHeight);
  return stage.picture(camera, {samples, 1024, 2, 4});
}

/// Body that a stage shows at each pixel.
std::vector<int> bodiesSeen(const std::vector<io::PictureBody>& unnumbered,
                            const Camera& camera = frontView()) {
  const std::vector<io::PictureBody> bodies = numbered(unnumbered);
  Stage stage(bodies, {0, 0, -9.81}, camera, kWidth, kHeight);
  stage.picture(camera, {});
  std::vector<int> seen;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) seen.push_back(stage.renderer().bodyAt(x, y));
  return seen;
}

int at(const std::vector<int>& seen, int x, int y) { return seen[static_cast<std::size_t>(y * kWidth + x)]; }

TEST_F(Rendering, ACubeCoversItsPixels) {
  // The near face of a cube of 4 m about the origin is 8 m away and 2 m to each side: 25 pixels.
  const std::vector<int> seen = bodiesSeen({bodyOf(Shape::box({2, 2, 2}))});
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double across = std::max(std::fabs(x + .5 - 100), std::fabs(y + .5 - 50));
      EXPECT_EQ(at(seen, x, y), across < 25 ? 0 : -1) << x << ", " << y;
    }
  }
}

TEST_F(Rendering, APartIsDrawnInPlaceOfItsBodyAndInItsColor) {
  // the box, of 25 pixels each way, is drawn as a red ball of the same reach in its middle alone
  const std::vector<io::PictureBody> bodies = numbered({bodyOf(Shape::box({2, 2, 2}))});
  Appearance appearance;
  appearance.looks = {{0, {{Shape::sphere(1), {}, {}, Vec3{1, 0, 0}}}}};
  Stage stage(bodies, {0, 0, -9.81}, frontView(), kWidth, kHeight, appearance);
  const io::Image picture = stage.picture(frontView(), {1, 1024, 2, 4});
  const std::uint8_t* const middle = &picture.rgb[3 * (50 * kWidth + 100)];
  EXPECT_GT(middle[0], 3 * middle[1]);
  EXPECT_GT(middle[0], 3 * middle[2]);
  EXPECT_EQ(stage.renderer().bodyAt(100, 50), 0);
  EXPECT_EQ(stage.renderer().bodyAt(120, 50), -1) << "the body itself is drawn as well";
}

TEST_F(Rendering, ATurnedBoxCoversWhatItsCornersSpan) {
  // By 45 degrees about the line of sight, 1 m behind it in front: a diamond of half diagonal sqrt(2) m, 9 m
  // away.
  io::PictureBody box = bodyOf(Shape::box({1, 1, 1}));
  box.orientation = fromAxisAngle(Vec3{0, 1, 0}, std::acos(-1.) / 4);
  const std::vector<int> seen = bodiesSeen({box});
  const double reach = 100. / 9 * std::sqrt(2.);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double across = std::fabs(x + .5 - 100) + std::fabs(y + .5 - 50);
      if (std::fabs(across - reach) > .8) {
        EXPECT_EQ(at(seen, x, y), across < reach ? 0 : -1) << x << ", " << y;
      }
    }
  }
}

TEST_F(Rendering, SpheresAndCapsulesCoverTheirPixels) {
  // A sphere is seen at the angle asin(1/10) from its center.
  const double radius = 100 * std::tan(std::asin(.1));
  io::PictureBody rod = bodyOf(Shape::capsule(.5, 3));
  rod.orientation = fromAxisAngle(Vec3{0, 1, 0}, std::acos(0.));
  const std::vector<int> ball = bodiesSeen({bodyOf(Shape::sphere(1))}), capsule = bodiesSeen({rod});
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double dx = x + .5 - 100, dy = y + .5 - 50, fromBall = std::hypot(dx, dy) - radius;
      if (std::fabs(fromBall) > 1) {
        EXPECT_EQ(at(ball, x, y), fromBall < 0 ? 0 : -1) << x << ", " << y;
      }
      const double fromRod = std::hypot(std::max(0., std::fabs(dx) - 3 * kPixelsPerMetre), dy) -
                             .5 * kPixelsPerMetre;
      if (std::fabs(fromRod) > 1) {
        EXPECT_EQ(at(capsule, x, y), fromRod < 0 ? 0 : -1) << x << ", " << y;
      }
    }
  }
}

TEST_F(Rendering, TheNearerOfTwoBodiesIsSeenWhateverTheirOrder) {
  const io::PictureBody near = bodyOf(Shape::box({1, .5, 1}), {0, -2, 0}),
                        far = bodyOf(Shape::sphere(3), {0, 4, 0});
  EXPECT_EQ(at(bodiesSeen({near, far}), 100, 50), 0);
  EXPECT_EQ(at(bodiesSeen({far, near}), 100, 50), 1);
  EXPECT_EQ(at(bodiesSeen({far, near}), 118, 50), 0) << "the sphere stands out at the side";
}

TEST_F(Rendering, BodiesOfManyChunksAllHaveTheirPlace) {
  // 20 x 10 little boxes, ten pixels apart: more than one chunk, in an order of their own.
  std::vector<io::PictureBody> bodies;
  for (int i = 0; i < 200; ++i) {
    const int k = i * 77 % 200;
    bodies.push_back(bodyOf(Shape::box({.2, .1, .2}), {k % 20 - 9.5, 0, 4.5 - k / 20}));
  }
  const std::vector<int> seen = bodiesSeen(bodies);
  for (int i = 0; i < 200; ++i) {
    const int k = i * 77 % 200;
    EXPECT_EQ(at(seen, 5 + 10 * (k % 20), 5 + 10 * (k / 20)), i);
  }
}

TEST_F(Rendering, WhatIsNotFiniteIsNotDrawn) {
  io::PictureBody lost = bodyOf(Shape::box({2, 2, 2}));
  lost.position.x = std::numeric_limits<double>::quiet_NaN();
  const std::vector<int> seen = bodiesSeen({lost, bodyOf(Shape::sphere(1), {5, 0, 0})});
  EXPECT_EQ(at(seen, 100, 50), -1);
  EXPECT_EQ(at(seen, 150, 50), 1);
}

TEST_F(Rendering, WhatIsOutOfSightIsNotSent) {
  std::vector<io::PictureBody> bodies;
  for (int i = 0; i < 640; ++i)
    bodies.push_back(bodyOf(Shape::box({.1, .1, .1}), {i < 64 ? 0. : 1000., .2 * (i % 64), 0}));
  bodies = numbered(bodies);
  const Camera camera = frontView();
  Stage stage(bodies, {0, 0, -9.81}, camera, kWidth, kHeight);
  stage.picture(camera, {});
  EXPECT_EQ(stage.renderer().bodies().drawn(), 64u) << "one chunk of ten lies before the camera";
}

TEST_F(Rendering, ABodyThrowsItsShadowAwayFromTheSun) {
  // A slab hovers over a plane; straight up from the plane along the sun's direction it is hit.
  const Camera camera{{0, -14, 10}, {0, 0, 0}, {0, 0, 1}, .8};
  const std::vector<io::PictureBody> ground{bodyOf(Shape::plane())};
  std::vector<io::PictureBody> both = ground;
  both.push_back(bodyOf(Shape::box({1, 1, .1}), {0, 0, 3}));
  both = numbered(both);
  Stage stage(both, {0, 0, -9.81}, camera, kWidth, kHeight);
  const io::Image with = stage.picture(camera, {1, 1024, 2, 4}), without = drawn(ground, camera);
  const Vec3 toSun = stage.setting().toSun;
  const Eye eye(camera, {}, kWidth, kHeight);
  int dark = 0, light = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      // Open ground, some pixels away from the slab: its outline is smoothed and throws a little occlusion
      // about.
      bool open = true;
      for (int dy = -4; dy <= 4; dy += 2)
        for (int dx = -4; dx <= 4; dx += 2) open = open && stage.renderer().bodyAt(x + dx, y + dy) == 0;
      if (!open) continue;
      const Vec3f ray = eye.at(static_cast<float>(2 * x + 1) / kWidth - 1,
                               1 - static_cast<float>(2 * y + 1) / kHeight, 1) -
                        eye.position;
      const Vec3 p(eye.position + ray * (-eye.position.z / ray.z));
      const Vec3 atSlab = p + toSun * (3 / toSun.z);
      const double across = std::max(std::fabs(atSlab.x), std::fabs(atSlab.y));
      const double ratio = (brightness(with, x, y) + 1) / (brightness(without, x, y) + 1);
      if (across < .75) {
        EXPECT_LT(ratio, .8) << x << ", " << y;
        ++dark;
      } else if (across > 1.25 && length(p) < 8 && length(p) > 3.5) {
        EXPECT_GT(ratio, .93) << x << ", " << y;
        ++light;
      }
    }
  }
  EXPECT_GT(dark, 40);
  EXPECT_GT(light, 500);
}

/// A body in front of the camera under lights of its own.
io::Image lit(const Shape& shape, const Appearance& appearance) {
  Stage stage(numbered({bodyOf(shape)}), {0, 0, -9.81}, frontView(), kWidth, kHeight, appearance);
  return stage.picture(frontView(), {1, 1024, 2, 4});
}
io::Image litBall(const Appearance& appearance) { return lit(Shape::sphere(2), appearance); }

TEST_F(Rendering, ALampLightsTheSideThatFacesItInItsColor) {
  Appearance night;
  night.daylight.sunStrength = 0, night.daylight.skyStrength = 0;
  const io::Image dark = litBall(night);
  EXPECT_LT(brightness(dark, 100, 50), 3);
  EXPECT_LT(brightness(dark, 5, 5), 3) << "the sky";
  night.lights = {{{8, -6, 0}, {1, 0, 0}, 40}};
  const io::Image red = litBall(night);
  EXPECT_GT(brightness(red, 112, 50), 4 * brightness(red, 86, 50) + 10);
  EXPECT_GT(channel(red, 112, 50, 0), 10 * channel(red, 112, 50, 2));
  night.lights[0].position.x = -8;
  const io::Image left = litBall(night);
  EXPECT_GT(brightness(left, 88, 50), 4 * brightness(left, 114, 50) + 10);
  EXPECT_EQ(litBall(night).rgb, left.rgb);
}

TEST_F(Rendering, ALampIsAsBrightAsTheSunThatItsIntensitySays) {
  // white, 20 m in front of the face of a box, where the sun stands
  Appearance sunny, lamp;
  sunny.daylight.toSun = Vec3{0, -1, 0}, sunny.daylight.skyStrength = lamp.daylight.skyStrength = 0;
  lamp.daylight.sunStrength = 0;
  lamp.lights = {{{0, -22, 0}, {1, 1, 1}, 400}};
  // green: sunlight is warm, and as green as a white lamp
  const auto green = [](const Appearance& by) {
    return double(channel(lit(Shape::box({2, 2, 2}), by), 100, 50, 1));
  };
  const double bySun = green(sunny), byLamp = green(lamp);
  EXPECT_NEAR(byLamp, bySun, 0.03 * bySun);
  lamp.lights[0].position.y = -42;
  EXPECT_LT(green(lamp), 0.8 * byLamp) << "a quarter of the light";
}

TEST_F(Rendering, SunAndSkyHaveTheirStrength) {
  Appearance usual, blue, dim;
  blue.daylight.sunColor = {0.2, 0.2, 1};
  dim.daylight.skyStrength = 0.2;
  const io::Image plain = litBall(usual), tinted = litBall(blue), darker = litBall(dim);
  const auto redOverBlue = [](const io::Image& image) {
    return channel(image, 94, 40, 0) / double(channel(image, 94, 40, 2));
  };
  EXPECT_LT(redOverBlue(tinted), 0.8 * redOverBlue(plain));
  EXPECT_LT(brightness(darker, 5, 5), 0.7 * brightness(plain, 5, 5)) << "the sky";
  EXPECT_LT(brightness(darker, 106, 62), 0.8 * brightness(plain, 106, 62)) << "the shadow side";
}

TEST_F(Rendering, CrevicesAreDarkerThanOpenGround) {
  // Two walls with a gap: its floor sees little of the sky. The sun is kept out of the comparison by looking
  // straight down.
  const Camera camera{{0, -.01, 20}, {0, 0, 0}, {0, 1, 0}, .5};
  const auto wall = [](double x) { return bodyOf(Shape::box({.9, 4, 1}), {x, 0, 1}); };
  std::vector<io::PictureBody> bodies{bodyOf(Shape::plane()), wall(-1.2), wall(1.2)};
  bodies = numbered(bodies);
  Stage stage(bodies, {0, 0, -9.81}, camera, kWidth, kHeight);
  const io::Image image = stage.picture(camera, {4, 1024, 2, 4});
  EXPECT_LT(brightness(image, 100, 50), .75 * brightness(image, 20, 50));
}

TEST_F(Rendering, ManySamplesSmoothAnEdge) {
  // Along the slanted side of a turned box: with one sample smoothed afterwards, and with 32, few pixels
  // jump.
  io::PictureBody box = bodyOf(Shape::box({3, .5, 3}));
  box.orientation = fromAxisAngle(Vec3{0, 1, 0}, .2);
  const io::Image many = drawn({box}, frontView(), 32);
  const io::Image empty = drawn({}, frontView(), 32);
  int between = 0;
  for (int y = 0; y < kHeight; ++y) {
    const double inside = brightness(many, 100, 50), outside = brightness(empty, 4, y);
    for (int x = 0; x < kWidth; ++x) {
      const double part = (brightness(many, x, y) - outside) / (inside - outside);
      between += part > .2 && part < .8;
    }
  }
  EXPECT_GT(between, 40) << "edges of 240 pixels must have some in between";
}

TEST_F(Rendering, ADeformableObjectOfAWorldIsDrawnInEveryFrame) {
  Scene scene;
  scene.gravity = {};
  scene.deformables.push_back(clothSheet({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, 4, 4));
  World world(scene);
  const Camera camera = frontView();
  Stage stage(io::pictureBodies(world), {0, 0, -9.81}, camera, kWidth, kHeight);
  const io::Image first = stage.picture(camera, {});
  const DeformableId sheet = world.deformableAt(0);
  std::vector<Vec3> moved = world.positions(sheet);
  for (Vec3& x : moved) x.x -= 5;
  world.setVertices(sheet, moved, world.velocities(sheet));
  stage.setBodies(io::pictureBodies(world));
  const io::Image second = stage.picture(camera, {});
  world.removeDeformable(sheet);
  stage.setBodies(io::pictureBodies(world));
  const io::Image none = stage.picture(camera, {});
  const auto seen = [&](const io::Image& image, int x) {
    return std::abs(channel(image, x, 50, 0) - channel(none, x, 50, 0)) > 20;
  };
  EXPECT_TRUE(seen(first, 100));
  EXPECT_FALSE(seen(first, 50));
  EXPECT_FALSE(seen(second, 100));
  EXPECT_TRUE(seen(second, 50));
}

TEST_F(Rendering, ADeformableSurfaceIsDrawnWhereItIs) {
  Renderer renderer(kWidth, kHeight);
  Surface cloth;
  cloth.vertices = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  cloth.triangles = {{0, 1, 2}, {0, 2, 3}};
  cloth.color = {.8f, .1f, .1f};
  const std::vector<BodyLook> looks{{kRound, {.5f, .5f, .5f}, 0, {.1f, .1f, .8f}, Finish::Plastic}};
  const std::vector<Pose> poses{{5, 0, 0, 0, 0, 0, 0, 1}};
  renderer.bodies().setLooks(looks);
  renderer.setSurfaces({&cloth, 1});
  renderer.bodies().setPoses(poses);
  renderer.draw(frontView(), {}, {});
  const io::Image image = renderer.read();
  const auto red = [&](int x, int y) { return channel(image, x, y, 0) - channel(image, x, y, 2); };
  EXPECT_GT(red(100, 50), 60);
  EXPECT_GT(red(92, 42), 60);
  EXPECT_LT(red(85, 50), 30) << "it ends at 90";
  EXPECT_LT(red(150, 50), -60) << "the body beside it is blue";
  // The next frame has it elsewhere.
  for (Vec3f& vertex : cloth.vertices) vertex.x -= 5;
  renderer.setSurfaces({&cloth, 1});
  renderer.bodies().setPoses(poses);
  renderer.draw(frontView(), {}, {});
  const io::Image moved = renderer.read();
  EXPECT_GT(channel(moved, 50, 50, 0) - channel(moved, 50, 50, 2), 60);
  EXPECT_LT(channel(moved, 100, 50, 0) - channel(moved, 100, 50, 2), 30);
}

TEST_F(Rendering, AMeshOfOnesOwnIsDrawn) {
  Renderer renderer(kWidth, kHeight);
  const std::vector<Vec3f> corners{{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}, {0, 0, 1}};
  const std::vector<Triangle> faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const int geometry = renderer.bodies().addMesh(corners, faces);
  const std::vector<BodyLook> looks(3, {geometry, {2, 2, 2}, 0, {.5f, .4f, .3f}, Finish::Stone});
  const std::vector<Pose> poses{
      {-6, 0, 0, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 0, 0, 1}, {6, 0, 0, 0, 0, 0, 0, 1}};
  renderer.bodies().setLooks(looks);
  renderer.bodies().setPoses(poses);
  renderer.draw(frontView(), {}, {});
  EXPECT_EQ(renderer.bodyAt(100, 60), 1);
  EXPECT_EQ(renderer.bodyAt(42, 60), 0);
  EXPECT_EQ(renderer.bodyAt(158, 60), 2);
  EXPECT_EQ(renderer.bodyAt(85, 32), -1) << "beside the tip";
}

TEST_F(Rendering, CamerasThatGiveNoPictureAreRefused) {
  Camera camera = frontView();
  camera.target = camera.eye;
  EXPECT_THROW(drawn({}, camera), Error);
  camera = frontView();
  camera.fieldOfView = 4;
  EXPECT_THROW(drawn({}, camera), Error);
}

}  // namespace
}  // namespace rubble::render
