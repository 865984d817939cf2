/// Pictures of fixed scenes against stored ones. RUBBLE_UPDATE_PICTURES=1 stores them anew: look at them
/// before they are committed.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "render/framing.h"
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
                                      bodyOf(Shape::sphere(.7), {2.2, 0, .7}),
                                      bodyOf(Shape::capsule(.4, .8), {-2, 0, 1.2}),
                                      bodyOf(Shape::box({.4, .4, .4}), {.3, -.2, 1.4})};
  bodies[4].orientation = fromAxisAngle(Vec3{0, 0, 1}, .6);
  bodies[3].orientation = fromAxisAngle(Vec3{0, 1, 0}, .3);
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].key = static_cast<std::uint32_t>(i);
  return {"shapes", bodies, {0, 0, -9.81}, {}};
}

/// Convex shapes and what is made of them.
Picture solids() {
  const double g = 1.618;
  std::vector<Vec3> points;
  for (const double a : {-.45, .45})
    for (const double b : {-.45 * g, .45 * g}) points.insert(points.end(), {{0, a, b}, {a, b, 0}, {b, 0, a}});
  const Shape dumbbell = Shape::compound(
      {{Shape::sphere(.45), {-.7, 0, 0}, {}},
       {Shape::sphere(.45), {.7, 0, 0}, {}},
       {Shape::cylinder(.18, .7), {0, 0, 0}, fromAxisAngle(Vec3{0, 1, 0}, 1.5708)}});
  std::vector<io::PictureBody> bodies{bodyOf(Shape::plane()),
                                      bodyOf(Shape::hull(points), {-2.4, 0, .73}),
                                      bodyOf(Shape::cone(.6, .7), {-.8, .2, .7}),
                                      bodyOf(dumbbell, {.9, -.6, .45}),
                                      bodyOf(Shape::cylinder(.5, .6, .2), {.6, 1.3, .6}),
                                      bodyOf(Shape::box({.5, .5, .5}, .2), {2.5, .2, .5})};
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].key = static_cast<std::uint32_t>(i);
  return {"solids", bodies, {0, 0, -9.81}, {}};
}

/// Ground over a lattice, a solid by its distances, and a mesh.
Picture grounds() {
  constexpr int kSide = 17;
  std::vector<double> heights, distances;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) heights.push_back(.35 * std::sin(.7 * i) * std::cos(.5 * j));
  for (int k = 0; k < kSide; ++k)
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const Vec3 p{-1.2 + .15 * i, -1.2 + .15 * j, -1.2 + .15 * k};
        distances.push_back(std::hypot(std::hypot(p.x, p.y) - .7, p.z) - .28);
      }
  std::vector<io::PictureBody> bodies{
      bodyOf(Shape::heightField(kSide, kSide, {.4, .4, 1}, heights), {-3.2, -3.2, 0}),
      bodyOf(Shape::distanceField({kSide, kSide, kSide}, {-1.2, -1.2, -1.2}, .15, distances), {.3, .4, 1.3}),
      bodyOf(Shape::mesh({{0, 0, 0}, {1.4, 0, 0}, {0, 1.4, 0}, {.3, .3, 1.5}},
                         {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}),
             {-2.2, -1.6, .4})};
  bodies[1].orientation = fromAxisAngle(Vec3{1, 0, 0}, 1.);
  bodies[0].motion = Motion::Static;
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].key = static_cast<std::uint32_t>(i);
  return {"grounds", bodies, {0, 0, -9.81}, {}};
}

/// Cloth over nothing, a block of tetrahedra, a rod, a net and particles.
Picture deformables() {
  Scene scene;
  ClothDef cloth = clothSheet({-2.5, -.8, 1.6}, {1.8, 0, 0}, {0, 1.8, 0}, 16, 16);
  for (Vec3& p : cloth.vertices) p.z -= .25 * (p.x + 1.6) * (p.x + 1.6) + .1 * std::sin(5 * p.y);
  CableDef rod = straightCable({-2.5, -1.2, .3}, {.5, -1.4, .6}, 12);
  rod.radius = .08;
  for (std::size_t i = 0; i < rod.vertices.size(); ++i)
    rod.vertices[i].z += .25 * std::sin(.6 * static_cast<double>(i));
  NetDef net;
  net.vertices = {{1.6, .6, .2}, {2.4, .6, .2}, {2., .6, 1.1}, {2., 1.3, .5}};
  net.masses = {1};
  net.contactRadius = .05;
  for (int a = 0; a < 4; ++a)
    for (int b = a + 1; b < 4; ++b) net.edges.push_back({a, b, 100, 0, -1});
  ParticlesDef particles;
  particles.radius = .12;
  for (int i = 0; i < 20; ++i)
    particles.vertices.push_back({1.1 + .25 * (i % 4), -1.2 + .25 * (i / 4 % 3), .12 + .24 * (i / 12)});
  scene.deformables = {cloth, tetBox({-.3, -.4, .05}, {1, 1, 1}, {3, 3, 3}), rod, net, particles};
  std::vector<io::PictureBody> bodies = io::pictureBodies(scene);
  bodies.insert(bodies.begin(), bodyOf(Shape::plane()));
  return {"deformables", bodies, scene.gravity, {}};
}

io::Image draw(const Picture& picture) {
  softwareContext();
  const double aspect = static_cast<double>(kWidth) / kHeight;
  const Camera camera = cameraShowing(picture.bodies, picture.gravity, {picture.direction, 0, aspect, .5});
  Stage stage(picture.bodies, picture.gravity, camera, kWidth, kHeight);
  return stage.picture(camera, {8, 1024, 4, 8});
}

class StoredPicture : public testing::TestWithParam<const char*> {};

Picture pictureNamed(const std::string& name) {
  if (name == "pile") return ofScene("pile", "pile", {{"nx", 4}, {"nz", 5}, {"levels", 10}, {"smash", 0}});
  if (name == "pyramid") return ofScene("pyramid", "pyramid", {{"base", 12}});
  if (name == "solids") return solids();
  if (name == "grounds") return grounds();
  if (name == "deformables") return deformables();
  return shapes();
}

TEST_P(StoredPicture, LooksAsItDid) {
  const std::string file = std::string(RUBBLE_SOURCE_DIR) + "/tests/render/pictures/" + GetParam() + ".png";
  const io::Image now = draw(pictureNamed(GetParam()));
  if (std::getenv("RUBBLE_UPDATE_PICTURES")) io::writePng(now, file);
  const Likeness found = likeness(now, readPng(file));
  if (found.structure < kLeastStructure || found.largest > kLargestDifference)
    io::writePng(now, std::string(GetParam()) + "-now.png");
  EXPECT_GE(found.structure, kLeastStructure) << "what was drawn lies beside the test program";
  EXPECT_LE(found.largest, kLargestDifference);
}

INSTANTIATE_TEST_SUITE_P(Scenes, StoredPicture,
                         testing::Values("pile", "pyramid", "shapes", "solids", "grounds", "deformables"),
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
