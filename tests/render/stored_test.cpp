/// Pictures of fixed scenes against stored ones. RUBBLE_UPDATE_PICTURES=1 stores them anew: look at them before they are committed.
#include <cstdlib>

#include <gtest/gtest.h>

#include "scenes/registry.h"
#include "tests/render/look.h"

namespace rubble::render {
namespace {

constexpr int kWidth = 240, kHeight = 136;
/// What another version of the driver may differ by.
constexpr double kLeastStructure = .97, kLargestDifference = 14;

struct Picture {
  const char* name;
  std::vector<io::PictureBody> bodies;
  Vec3 gravity{0, 0, -9.81};
  Vec3 direction;
};

Picture ofScene(const char* name, const char* scene, const scenes::Arguments& arguments) {
  const scenes::Spec& spec = scenes::find(scene);
  const scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, arguments));
  return {name, io::pictureBodies(job.scene), job.scene.gravity, job.camera.target - job.camera.eye};
}

Picture shapes() {
  std::vector<io::PictureBody> bodies{bodyOf(Shape::plane()), bodyOf(Shape::box({1, .6, .5}), {0, 0, .5}),
                                      bodyOf(Shape::sphere(.7), {2.2, 0, .7}), bodyOf(Shape::capsule(.4, .8), {-2, 0, 1.2}),
                                      bodyOf(Shape::box({.4, .4, .4}), {.3, -.2, 1.4})};
  bodies[4].orientation = fromAxisAngle(Vec3{0, 0, 1}, .6);
  bodies[3].orientation = fromAxisAngle(Vec3{0, 1, 0}, .3);
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].key = static_cast<std::uint32_t>(i);
  return {"shapes", bodies, {0, 0, -9.81}, {}};
}

io::Image draw(const Picture& picture) {
  softwareContext();
  io::PictureSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.fieldOfView = .5;
  io::frameBodies(picture.bodies, picture.gravity, settings, {picture.direction, 0});
  const Camera camera{settings.eye, settings.target, settings.up, settings.fieldOfView};
  Stage stage(picture.bodies, picture.gravity, camera, kWidth, kHeight);
  return stage.picture(camera, {8, 1024, 4, 8});
}

class StoredPicture : public testing::TestWithParam<const char*> {};

Picture pictureNamed(const std::string& name) {
  if (name == "pile") return ofScene("pile", "pile", {{"nx", 4}, {"nz", 5}, {"levels", 10}, {"smash", 0}});
  if (name == "pyramid") return ofScene("pyramid", "pyramid", {{"base", 12}});
  return shapes();
}

TEST_P(StoredPicture, LooksAsItDid) {
  const std::string file = std::string(RUBBLE_SOURCE_DIR) + "/tests/render/pictures/" + GetParam() + ".png";
  const io::Image now = draw(pictureNamed(GetParam()));
  if (std::getenv("RUBBLE_UPDATE_PICTURES")) io::writePng(now, file);
  const Likeness found = likeness(now, readPng(file));
  if (found.structure < kLeastStructure || found.largest > kLargestDifference) io::writePng(now, std::string(GetParam()) + "-now.png");
  EXPECT_GE(found.structure, kLeastStructure) << "what was drawn lies beside the test program";
  EXPECT_LE(found.largest, kLargestDifference);
}

INSTANTIATE_TEST_SUITE_P(Scenes, StoredPicture, testing::Values("pile", "pyramid", "shapes"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Likeness, SeesAMissingBrick) {
  Picture pile = pictureNamed("pile");
  const io::Image whole = draw(pile);
  const Likeness same = likeness(whole, draw(pile));
  EXPECT_EQ(same.structure, 1);
  EXPECT_EQ(same.largest, 0);
  pile.bodies[pile.bodies.size() - 3].position.x = std::nan("");
  EXPECT_GT(likeness(whole, draw(pile)).largest, kLargestDifference);
}

TEST(Likeness, SeesAScenePushedAside) {
  Picture shifted = pictureNamed("shapes");
  const io::Image there = draw(shifted);
  shifted.bodies[2].position.x -= .3;
  const Likeness found = likeness(there, draw(shifted));
  EXPECT_TRUE(found.structure < kLeastStructure || found.largest > kLargestDifference);
}

}  // namespace
}  // namespace rubble::render
