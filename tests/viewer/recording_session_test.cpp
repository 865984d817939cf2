#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "apps/viewer/recording_session.h"

namespace rubble::viewer {
namespace {

WorldOptions quietOn(const char* backend) {
  WorldOptions options;
  options.backend = backend, options.threads = 1, options.timings = false;
  return options;
}

/// A file of a ball that falls, 90 steps.
class Recorded : public testing::Test {
 protected:
  void SetUp() override {
    file_ = testing::TempDir() + "rubble_playback_" +
            testing::UnitTest::GetInstance()->current_test_info()->name() + ".rubble";
    Scene scene;
    BodyDef ball;
    ball.name = "ball";
    ball.shape = Shape::sphere(.5);
    ball.position = {0, 0, 20};
    scene.bodies = {ball};
    World world(scene, quietOn("cpu"));
    io::RecordingWriter writer(file_, {"fall", world.params().dt, world.gravity(), 1e-5});
    for (int step = 0; step <= 90; ++step) {
      heights_.push_back(world.state(world.findBody("ball")).position.z);
      writer.write(io::recordedBodies(world), io::recordedFrame(world));
      world.step();
    }
    writer.finish();
  }
  void TearDown() override { std::filesystem::remove(file_); }

  std::string file_;
  std::vector<double> heights_;
};

TEST_F(Recorded, EveryFrameIsFoundInAnyOrder) {
  RecordingSession film(file_);
  EXPECT_EQ(film.title().substr(0, 4), "fall");
  EXPECT_EQ(film.last(), 90);
  for (const int step : {0, 90, 31, 32, 33, 64, 7}) {
    film.seek(step);
    EXPECT_EQ(film.now(), step);
    EXPECT_NEAR(film.bodies(0, io::ColorBy::Body).front().position.z,
                heights_[static_cast<std::size_t>(step)], 1e-5);
  }
  EXPECT_NEAR(film.bodies(0, io::ColorBy::Speed).front().speed, 9.81 * 7 / 60, 1e-2)
      << "from the frame before, where implicit Euler fell with the speed of step 7";
}

TEST_F(Recorded, ItPlaysToItsEndAndStops) {
  RecordingSession film(file_);
  for (int i = 0; i < 60; ++i) film.play(1. / 30);
  EXPECT_EQ(film.now(), 90);
  EXPECT_TRUE(film.paused);
  EXPECT_FALSE(film.step());
  EXPECT_TRUE(film.complete());
}

TEST_F(Recorded, ARunThatWasCutOffIsShownAsFarAsItCame) {
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) * 3 / 4);
  RecordingSession film(file_);
  EXPECT_FALSE(film.complete());
  EXPECT_LT(film.last(), 90);
  EXPECT_GE(film.last(), 31) << "whole chunks are kept";
}

TEST_F(Recorded, ADamagedFileIsRefusedWithItsName) {
  std::fstream(file_, std::ios::in | std::ios::out | std::ios::binary).seekp(60).write("\xff\xff\xff\xff", 4);
  try {
    RecordingSession film(file_);
    film.seek(90);
    FAIL() << "it was opened";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(file_), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace rubble::viewer
