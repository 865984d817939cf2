/// Pictures by compute shaders against those by triangles and fragments, and against what boxes must cover.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>
#include <rubble/error.h>

#include "scenes/registry.h"
#include "tests/render/look.h"

namespace rubble::render {
namespace {

constexpr int kWidth = 320, kHeight = 180;
/// What rounding may change.
constexpr double kLeastStructure = .995, kLargestDifference = 8;

/// Asks for a way to draw as long as it lives.
struct Asked {
  explicit Asked(const char* word) { setenv("RUBBLE_GL_COMPUTE", word, 1); }
  ~Asked() { unsetenv("RUBBLE_GL_COMPUTE"); }
};

class ComputedBoxes : public testing::Test {
 protected:
  void SetUp() override {
    if (!gl::canCompute()) GTEST_SKIP() << "OpenGL below 4.3";
  }
  HeadlessContext& context_ = softwareContext();
};

std::vector<io::PictureBody> numbered(std::vector<io::PictureBody> bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].key = static_cast<std::uint32_t>(i);
  return bodies;
}

std::unique_ptr<Stage> stageOf(const char* way, const std::vector<io::PictureBody>& bodies,
                               const Camera& camera) {
  const Asked asked(std::string(way) == "compute" ? "on" : "off");
  auto stage = std::make_unique<Stage>(bodies, Vec3{0, 0, -9.81}, camera, kWidth, kHeight);
  EXPECT_EQ(stage->renderer().bodies().computesBoxes(), std::string(way) == "compute");
  return stage;
}

std::vector<int> bodiesIn(const Stage& stage) {
  std::vector<int> seen;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) seen.push_back(const_cast<Stage&>(stage).renderer().bodyAt(x, y));
  return seen;
}

/// Both ways to draw bodies must agree: pictures, and which body a pixel shows but for edges that run through
/// a pixel's center.
void expectAlike(const std::vector<io::PictureBody>& bodies, const Camera& camera, const Quality& quality) {
  const auto triangles = stageOf("triangles", bodies, camera), computed = stageOf("compute", bodies, camera);
  const io::Image a = triangles->picture(camera, quality), b = computed->picture(camera, quality);
  const Likeness found = likeness(a, b);
  EXPECT_GT(found.structure, kLeastStructure);
  EXPECT_LT(found.largest, kLargestDifference);
  const std::vector<int> seenA = bodiesIn(*triangles), seenB = bodiesIn(*computed);
  int other = 0;
  for (std::size_t i = 0; i < seenA.size(); ++i) other += seenA[i] != seenB[i];
  EXPECT_LT(other, kWidth * kHeight / 500) << "pixels with another body";
  if (testing::Test::HasFailure()) {
    io::writePng(a, "boxes-triangles.png");
    io::writePng(b, "boxes-compute.png");
  }
}

/// Boxes of all sizes and turns on a plane, a ball and a rod among them.
std::vector<io::PictureBody> heap() {
  std::vector<io::PictureBody> bodies{bodyOf(Shape::plane()), bodyOf(Shape::sphere(1), {2, -1, 1}),
                                      bodyOf(Shape::capsule(.3, 1), {-2, -2, 1.3}),
                                      bodyOf(Shape::box({3, 3, .2}), {0, 3, .2})};
  for (int i = 0; i < 150; ++i) {
    const double size = .05 * (1 + i % 7);
    io::PictureBody box = bodyOf(Shape::box({size, 1.4 * size, .8 * size}),
                                 {1.1 * (i % 12) - 6, .9 * (i / 12) - 4, .4 + .11 * (i % 5)});
    box.orientation = fromAxisAngle(normalize(Vec3{1., .3 * (i % 4), -.5}), .37 * i);
    bodies.push_back(box);
  }
  return numbered(bodies);
}

TEST_F(ComputedBoxes, LookLikeTriangles) {
  expectAlike(heap(), {{7, -12, 6}, {0, 0, 0}, {0, 0, 1}, .6}, {4, 1024, 4, 8});
}

TEST(CudaComputedBoxes, LookLikeTrianglesOnTheDevice) {
  const std::vector<std::string> all = backends();
  if (std::find(all.begin(), all.end(), "cuda") == all.end()) GTEST_SKIP() << "no CUDA device";
  const HeadlessContext context;
  if (context.isSoftware()) GTEST_SKIP() << "OpenGL has no device";
  ASSERT_TRUE(gl::canCompute()) << context.renderer();
  expectAlike(heap(), {{7, -12, 6}, {0, 0, 0}, {0, 0, 1}, .6}, {4, 1024, 4, 8});
  expectAlike(heap(), {{.3, .2, .95}, {2, -4, .3}, {0, 0, 1}, 1.}, {8, 1024, 4, 8});
}

TEST_F(ComputedBoxes, LookLikeTrianglesFromAmongThem) {
  // The slab reaches behind the eye and some boxes fill much of the picture.
  expectAlike(heap(), {{.3, .2, .95}, {2, -4, .3}, {0, 0, 1}, 1.}, {8, 1024, 4, 8});
}

TEST_F(ComputedBoxes, LookLikeTrianglesWhereBricksAreSmallerThanPixels) {
  const scenes::Spec& spec = scenes::find("pile");
  const scenes::Job job = scenes::prepare(
      spec, scenes::resolve(spec, {{"nx", 8}, {"nz", 8}, {"levels", 20}, {"smash", 0}}));
  std::vector<io::PictureBody> bodies = io::pictureBodies(job.scene);
  const Vec3 up = normalize(-job.scene.gravity);
  const Vec3 away = normalize(cross(up, Vec3{1, .3, .2})) * 3 + up;
  const Camera camera{away * 90, {}, up, .5};
  const auto triangles = stageOf("triangles", bodies, camera), computed = stageOf("compute", bodies, camera);
  const Likeness found = likeness(triangles->picture(camera, {4, 1024, 4, 8}),
                                  computed->picture(camera, {4, 1024, 4, 8}));
  EXPECT_GT(found.structure, kLeastStructure);
  EXPECT_LT(found.largest, kLargestDifference);
}

TEST_F(ComputedBoxes, CoverTheirPixels) {
  // One metre at the near face, `distance` away, is 90 / distance pixels: drawn by one thread, by a thread
  // group or by several groups.
  const Camera camera{{0, -10, 0}, {0, 0, 0}, {0, 0, 1}, 2 * std::atan(1.)};
  for (const double half : {.2, 1., 6.}) {
    const auto stage = stageOf("compute", numbered({bodyOf(Shape::box({half, 1, half}))}), camera);
    stage->picture(camera, {});
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double across = std::max(std::fabs(x + .5 - kWidth / 2), std::fabs(y + .5 - kHeight / 2));
        ASSERT_EQ(stage->renderer().bodyAt(x, y), across < 10 * half ? 0 : -1)
            << half << " m: " << x << ", " << y;
      }
    }
    const Vec3 middle = stage->renderer().pointAt(kWidth / 2, kHeight / 2);
    EXPECT_NEAR(middle.y, -1, 1e-3) << "depth of the near face";
  }
}

TEST_F(ComputedBoxes, AreTheSameBitsWhateverWasDrawnBefore) {
  const std::vector<io::PictureBody> bodies = heap();
  std::vector<io::PictureBody> moved = bodies;
  for (io::PictureBody& body : moved) body.position.z += .3;
  const Camera camera{{7, -12, 6}, {0, 0, 0}, {0, 0, 1}, .6}, other{{-9, 2, 3}, {0, 0, 0}, {0, 0, 1}, .9};
  const auto fresh = stageOf("compute", bodies, camera), used = stageOf("compute", bodies, camera);
  used->setBodies(moved);
  used->picture(other, {2, 512, 2, 4});
  used->picture(camera, {});
  used->setBodies(bodies);
  EXPECT_EQ(used->picture(camera, {}).rgb, fresh->picture(camera, {}).rgb);
}

TEST_F(ComputedBoxes, AreReplacedByTrianglesOnRequest) {
  EXPECT_FALSE(stageOf("triangles", heap(), {})->renderer().bodies().computesBoxes());
  const Asked asked("points");
  EXPECT_THROW(Renderer(8, 8), Error);
}

}  // namespace
}  // namespace rubble::render
