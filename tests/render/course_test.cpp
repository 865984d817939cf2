/// The default camera of every scene of the registry shows what happens in its run.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>

#include "render/view_plan.h"
#include "scenes/registry.h"
#include "tests/render/look.h"

namespace rubble::render {
namespace {

constexpr int kWidth = 320, kHeight = 180;
/// Moments of a run that the camera is chosen for, and those that are drawn.
constexpr int kMoments = 24, kPictures = 3;

/// Something is seen.
constexpr int kLeastPixels = 40;
/// Bodies that are smaller than this share of the picture, links of long chains and bullets, are seen as
/// points.
constexpr double kTiny = .012;

struct Run {
  std::vector<std::vector<io::PictureBody>> moments;
  Vec3 gravity, direction;
};

/// A run of a test's size, shortened where it is long.
Run runOf(const scenes::Spec& spec) {
  scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
  job.probes.clear();
  Run run{{}, job.scene.gravity, job.camera.target - job.camera.eye};
  const int wanted = spec.testSteps > 0 ? spec.testSteps : spec.steps;
  const double bodies = static_cast<double>(io::pictureBodies(job.scene, true).size());
  const int steps = std::max(6, std::min(wanted, static_cast<int>(60000 / bodies)));
  WorldOptions options;
  options.threads = 1;
  options.params.iterations = spec.iterations, options.params.substeps = spec.substeps;
  scenes::Runner runner(std::move(job), options);
  run.moments.push_back(io::pictureBodies(runner.world()));
  for (int step = 1; step <= steps; ++step) {
    runner.step();
    if (step == steps || step % std::max(1, steps / kMoments) == 0)
      run.moments.push_back(io::pictureBodies(runner.world()));
  }
  return run;
}

/// Pixels of what moves.
struct Subject {
  int pixels = 0, onEdges = 0;
  double flat = 0;  ///< share of the pixels of the most frequent color
};

Subject drawn(Stage& stage, const ViewPlan& plan, const std::vector<io::PictureBody>& bodies,
              io::Image& image) {
  const std::vector<io::PictureBody> shown = plan.shown(bodies);
  stage.setBodies(shown);
  image = stage.picture(plan.camera(bodies), {1, 512, 2, 4});
  const std::vector<int> seen = stage.renderer().readBodies();
  Subject subject;
  std::map<int, int> colors;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t at = static_cast<std::size_t>(y * kWidth + x);
      ++colors[(image.rgb[3 * at] / 8 << 10) + (image.rgb[3 * at + 1] / 8 << 5) + image.rgb[3 * at + 2] / 8];
      const bool moves = seen[at] <= -2 ||
                         (seen[at] >= 0 &&
                          shown[static_cast<std::size_t>(seen[at])].motion != Motion::Static);
      if (!moves) continue;
      ++subject.pixels;
      subject.onEdges += x == 0 || y == 0 || x == kWidth - 1 || y == kHeight - 1;
    }
  for (const auto& [color, count] : colors)
    subject.flat = std::max(subject.flat, count / double(kWidth * kHeight));
  return subject;
}

/// Of everything that moves, in all moments.
struct Reach {
  double wide = 0, tall = 0;  ///< shares of the picture
  double bodySize = 0;        ///< size of a typical body over the height of the picture
};
Reach reachOf(const Run& run, const ViewPlan& plan) {
  double low[2] = {1e30, 1e30}, high[2] = {-1e30, -1e30};
  Reach reach;
  for (const std::vector<io::PictureBody>& moment : run.moments) {
    const Camera camera = plan.camera(moment);
    const Vec3 forward = normalize(camera.target - camera.eye), right = normalize(cross(forward, camera.up)),
               up = cross(right, forward);
    const double spanY = std::tan(camera.fieldOfView / 2), spanX = spanY * kWidth / kHeight;
    reach.bodySize = io::typicalSize(moment) / (length(camera.target - camera.eye) * spanY);
    for (const io::PictureBody& body : moment) {
      if (body.motion == Motion::Static || plan.isGone(body)) continue;
      const Vec3 p = body.position - camera.eye;
      const double depth = std::max(1e-9, dot(p, forward));
      const double at[2] = {dot(p, right) / (depth * spanX), dot(p, up) / (depth * spanY)},
                   size[2] = {io::extentAlong(body, right) / (depth * spanX),
                              io::extentAlong(body, up) / (depth * spanY)};
      for (int axis = 0; axis < 2; ++axis)
        low[axis] = std::min(low[axis], at[axis] - size[axis]),
        high[axis] = std::max(high[axis], at[axis] + size[axis]);
    }
  }
  reach.wide = (high[0] - low[0]) / 2, reach.tall = (high[1] - low[1]) / 2;
  return reach;
}

void expectGoodView(const scenes::Spec& spec) {
  const Run run = runOf(spec);
  softwareContext();
  const ViewPlan plan(run.moments, run.gravity, {run.direction, 0, double(kWidth) / kHeight, .5});
  Stage stage(plan.shown(run.moments[0]), run.gravity, plan.camera(run.moments[0]), kWidth, kHeight);
  const Reach reach = reachOf(run, plan);
  const int least = reach.bodySize > kTiny ? kLeastPixels : reach.bodySize * kHeight > 1 ? 1 : 0;
  for (int k = 0; k < kPictures; ++k) {
    io::Image image;
    const std::size_t moment = (run.moments.size() - 1) * static_cast<std::size_t>(k) / (kPictures - 1);
    const Subject subject = drawn(stage, plan, run.moments[moment], image);
    if (const char* const folder = std::getenv("RUBBLE_PICTURES"))
      io::writePng(image, std::string(folder) + "/" + spec.name + "-" + std::to_string(k) + ".png");
    const std::string where = spec.name + ", picture " + std::to_string(k);
    EXPECT_GE(subject.pixels, least) << where << ": what moves is not seen";
    EXPECT_LE(subject.onEdges, .02 * 2 * (kWidth + kHeight)) << where << ": cut by an edge";
    EXPECT_LE(subject.flat, .6) << where << ": one flat color";
  }
  // of what stands or hangs slender the length counts
  EXPECT_TRUE(reach.wide * reach.tall >= .08 || reach.wide >= .5 || reach.tall >= .5)
      << spec.name << ": what moves is small in the picture, " << reach.wide << " x " << reach.tall;
}

TEST(Course, OfSomeScenesIsInThePicture) {
  for (const char* name : {"bounce", "hourglass", "pendulum", "projectile"})
    expectGoodView(scenes::find(name));
}

class LongCourse : public ::testing::TestWithParam<std::string> {};
TEST_P(LongCourse, IsInThePicture) { expectGoodView(scenes::find(GetParam())); }
std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const scenes::Spec& spec : scenes::registry()) all.push_back(spec.name);
  return all;
}
INSTANTIATE_TEST_SUITE_P(LongRegistry, LongCourse, ::testing::ValuesIn(names()), [](const auto& info) {
  std::string name = info.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(ViewPlan, FollowsWhatTravelsAndStandsOtherwise) {
  for (const double way : {2., 40.}) {
    std::vector<std::vector<io::PictureBody>> moments;
    for (int k = 0; k <= 20; ++k) moments.push_back({bodyOf(Shape::box({1, .5, .5}), {way * k / 20, 0, 1})});
    const ViewPlan plan(moments, {0, 0, -9.81}, {});
    EXPECT_EQ(plan.follows(), way > 10);
    const Camera first = plan.camera(moments.front()), last = plan.camera(moments.back());
    EXPECT_NEAR(last.eye.x - first.eye.x, plan.follows() ? way : 0, 1e-9);
  }
}

TEST(ViewPlan, LooksAroundAWallAndLeavesOutABox) {
  const auto wall = [](const Vec3& half, const Vec3& position, std::uint32_t key) {
    io::PictureBody body = bodyOf(Shape::box(half), position);
    body.motion = Motion::Static;
    body.key = key;
    return body;
  };
  io::PictureBody ball = bodyOf(Shape::sphere(0.5), {0, 0, 1});
  ball.key = 9;
  const Framing front{{0, 1, 0}};
  // a wall between the eye and the ball
  const std::vector<std::vector<io::PictureBody>> behind{{wall({3, .1, 3}, {0, -1.2, 0}, 1), ball}};
  const ViewPlan around(behind, {0, 0, -9.81}, front);
  EXPECT_EQ(around.shown(behind[0]).size(), 3u) << "both, and a floor";
  EXPECT_GT(std::fabs(around.camera(behind[0]).eye.x), .5);
  // a closed box about it
  std::vector<io::PictureBody> closed{ball};
  std::uint32_t key = 1;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.5, 1.5}) {
      Vec3 half{1.6, 1.6, 1.6}, at{0, 0, 1};
      half[axis] = .1, at[axis] += side;
      closed.push_back(wall(half, at, key++));
    }
  const ViewPlan open(std::vector<std::vector<io::PictureBody>>{closed}, {0, 0, -9.81}, front);
  EXPECT_LT(open.shown(closed).size(), closed.size() + 1);
}

TEST(ViewPlan, LeavesTheHidingWallOutWhereTheCameraIsGiven) {
  io::PictureBody wall = bodyOf(Shape::box({3, 0.1, 3}), {0, -1.2, 0}),
                  ball = bodyOf(Shape::sphere(0.5), {0, 0, 1});
  wall.motion = Motion::Static, wall.key = 1, ball.key = 2;
  const std::vector<std::vector<io::PictureBody>> moments{{wall, ball}};
  const Framing front{{0, 1, 0}};
  const auto shown = [&](const std::optional<Vec3>& eye) {
    const ViewPlan plan(moments, {0, 0, -9.81}, front, false, eye);
    EXPECT_NEAR(plan.camera(moments[0]).eye.x, 0, 1e-9) << "it does not turn";
    return plan.shown(moments[0]).size();
  };
  EXPECT_EQ(shown({}), 2u) << "the ball and a floor";
  EXPECT_EQ(shown(Vec3{0, 5, 1}), 3u) << "from behind, the wall as well";
}

}  // namespace
}  // namespace rubble::render
