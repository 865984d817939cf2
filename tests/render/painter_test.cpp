/// Several painters at once.
#include <thread>

#include <gtest/gtest.h>

#include "render/painter.h"
#include "tests/render/look.h"

namespace rubble::render {
namespace {

const Camera kCamera{{0, -10, 0}, {0, 0, 0}, {0, 0, 1}, .9};

std::vector<io::PictureBody> cube() { return {bodyOf(Shape::box({2, 2, 2}))}; }

std::unique_ptr<Painter> painterOf(PaintDevice& device, int width, int height) {
  PaintSettings settings;
  settings.width = width, settings.height = height;
  return device.painter(cube(), {0, 0, -9.81}, kCamera, settings);
}

io::Image drawnBy(Painter& painter) { return painter.paint(cube(), kCamera); }

/// Of a painter with a device of its own.
io::Image drawnAlone(int width, int height) { return drawnBy(*painterOf(*makePaintDevice(), width, height)); }

void expectPicture(const io::Image& image, const io::Image& expected) {
  EXPECT_EQ(image.width, expected.width);
  EXPECT_EQ(image.height, expected.height);
  EXPECT_EQ(image.rgb, expected.rgb);
}

class Painters : public testing::Test {
 protected:
  void SetUp() override { setenv("RUBBLE_GL", "software", 1); }
};

TEST_F(Painters, OfTwoDevicesDrawInTurn) {
  const io::Image small = drawnAlone(64, 48), large = drawnAlone(120, 80);
  const auto deviceA = makePaintDevice(), deviceB = makePaintDevice();
  const auto a = painterOf(*deviceA, 64, 48), b = painterOf(*deviceB, 120, 80);
  expectPicture(drawnBy(*a), small);
  expectPicture(drawnBy(*b), large);
  expectPicture(drawnBy(*a), small);
  EXPECT_EQ(b->depths().size(), 120u * 80);
  EXPECT_EQ(a->normals().size(), 3 * 64u * 48);
}

TEST_F(Painters, DrawAfterAnotherOneHasEnded) {
  const auto device = makePaintDevice();
  const auto painter = painterOf(*device, 64, 48);
  const io::Image first = drawnBy(*painter);
  drawnAlone(120, 80);
  expectPicture(drawnBy(*painter), first);
}

TEST_F(Painters, OutliveTheirDeviceAndGoToAnotherThread) {
  auto device = makePaintDevice();
  auto painter = painterOf(*device, 64, 48);
  const io::Image first = drawnBy(*painter);
  device.reset();
  expectPicture(drawnBy(*painter), first);
  std::thread([&] {
    expectPicture(drawnBy(*painter), first);
    painter.reset();
  }).join();
}

TEST_F(Painters, LeaveTheContextOfTheirThread) {
  softwareContext().makeCurrent();
  const auto camera = kCamera;
  Stage stage(cube(), {0, 0, -9.81}, camera, 64, 48);
  const io::Image before = stage.picture(camera, {});
  drawnAlone(120, 80);
  expectPicture(stage.picture(camera, {}), before);
}

}  // namespace
}  // namespace rubble::render
