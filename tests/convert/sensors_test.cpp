/// Sensors of MJCF models, and their readings in a running world.
#include <cmath>

#include <gtest/gtest.h>

#include <rubble/sensors.h>
#include <rubble/world.h>

#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Effect;
using convert::Import;
using test::expectNear;
using test::importText;
using test::mjcf;

/// The readings of a model after a time [s], by the names of its sensors.
class Readings {
 public:
  Readings(const Import& model, double seconds) : world_(model.file.scene, optionsOf(model)) {
    sensors_ = std::make_unique<Sensors>(model.file.sensors, world_);
    for (int i = 0; i < std::lround(seconds / model.file.dt); ++i) world_.step(), sensors_->update(world_);
  }
  std::vector<double> operator[](const std::string& name) const {
    for (std::size_t i = 0; i < sensors_->definitions().size(); ++i)
      if (sensors_->definitions()[i].name == name) {
        const auto values = sensors_->values(i);
        return {values.begin(), values.end()};
      }
    throw Error("sensor", "one of that name", name);
  }
  Vec3 vector(const std::string& name) const {
    const std::vector<double> v = (*this)[name];
    return {v.at(0), v.at(1), v.at(2)};
  }
  const World& world() const { return world_; }

 private:
  static WorldOptions optionsOf(const Import& model) {
    WorldOptions options;
    options.backend = "reference", options.threads = 1;
    options.params.dt = model.file.dt, options.params.iterations = model.file.iterations;
    return options;
  }
  World world_;
  std::unique_ptr<Sensors> sensors_;
};

TEST(SensorsOfModels, AHangingBodyShowsItsWeight) {
  // 2 kg at 0.5 m below a hinge, and a site that is turned by 90 degrees about x
  const Readings readings(
      importText(mjcf("<body name='b' pos='0 0 1'><joint name='j' axis='0 1 0' damping='1'/>"
                      "<geom size='.1' pos='0 0 -.5' mass='2'/><site name='s' euler='90 0 0'/></body>",
                      "<sensor><accelerometer name='a' site='s'/><force name='f' site='s'/>"
                      "<torque name='t' site='s'/><gyro name='g' site='s'/></sensor>")),
      0.1);
  expectNear(readings.vector("a"), {0, 9.81, 0}, 1e-3);
  expectNear(readings.vector("f"), {0, 2 * 9.81, 0}, 1e-2);
  expectNear(readings.vector("t"), {}, 1e-2);
  expectNear(readings.vector("g"), {}, 1e-4);
}

TEST(SensorsOfModels, JointsReadTheCoordinatesOfTheModel) {
  // its coordinate is 0.3 rad in the pose of the file
  const Readings readings(
      importText(mjcf("<body name='b'><joint name='j' axis='0 1 0' ref='17.188733853924695'/>"
                      "<geom size='.1' pos='0 0 -.5' mass='2'/></body>",
                      "<option gravity='0 0 0'/>"
                      "<actuator><velocity name='v' joint='j' kv='1000' ctrlrange='0 1'/>"
                      "<motor name='m' joint='j' gear='5'/></actuator>"
                      "<sensor><jointpos name='p' joint='j'/><jointvel name='s' joint='j'/>"
                      "<actuatorpos name='q' actuator='m'/><clock name='c'/></sensor>")),
      0.5);
  EXPECT_NEAR(readings["p"][0], 0.3, 1e-6);
  EXPECT_NEAR(readings["s"][0], 0, 1e-6);
  EXPECT_NEAR(readings["q"][0], 1.5, 1e-5);
  EXPECT_NEAR(readings["c"][0], 0.5, 1e-9);
}

TEST(SensorsOfModels, FramesMoveWithTheirBodiesAndAreSeenFromOthers) {
  // it turns by 2 rad/s about z, and is seen from a frame of the world at x = 1 that is turned by 90 degrees
  convert::ImportOptions options;
  options.key = "k";
  const Import model = importText(
      mjcf("<site name='home' pos='1 0 0' euler='0 0 90'/><body name='b' pos='0 0 1'><freejoint/>"
           "<geom size='.1' mass='1'/><site name='s' pos='.5 0 0'/></body>",
           "<option gravity='0 0 0'/><keyframe><key name='k' qpos='0 0 1 1 0 0 0' qvel='0 0 0 0 0 "
           "2'/></keyframe>"
           "<sensor><framepos name='p' objtype='site' objname='s' reftype='site' refname='home'/>"
           "<framelinvel name='v' objtype='site' objname='s'/><velocimeter name='l' site='s'/>"
           "<frameangvel name='w' objtype='body' objname='b'/><framequat name='q' objtype='xbody' "
           "objname='b'/>"
           "<framexaxis name='x' objtype='xbody' objname='b'/></sensor>"),
      "model.xml", options);
  const Readings readings(model, 0.25);
  const double angle = 0.5, c = std::cos(angle), s = std::sin(angle);
  expectNear(readings.vector("p"), {.5 * s, 1 - .5 * c, 1}, 2e-3);
  expectNear(readings.vector("v"), {-s, c, 0}, 2e-3);
  expectNear(readings.vector("l"), {0, 1, 0}, 2e-3);
  expectNear(readings.vector("w"), {0, 0, 2}, 1e-6);
  expectNear(readings.vector("x"), {c, s, 0}, 2e-3);
  EXPECT_NEAR(readings["q"][3], std::sin(angle / 2), 2e-3);
}

TEST(SensorsOfModels, TouchAndRangeMeasureWhatIsBelow) {
  const Readings readings(
      importText(
          mjcf("<geom type='plane' size='5 5 .1'/><body name='b' pos='0 0 .1'><freejoint/>"
               "<geom type='box' size='.1 .1 .1' mass='3'/><site name='pad' type='box' size='.1 .1 .02' "
               "pos='0 0 -.1'/><site name='top' type='box' size='.1 .1 .02' pos='0 0 3'/></body>"
               "<site name='eye' pos='2 0 4' euler='180 0 0'/>",
               "<sensor><touch name='t' site='pad'/><rangefinder name='r' site='eye'/>"
               "<rangefinder name='n' site='top'/></sensor>")),
      0.5);
  EXPECT_NEAR(readings["t"][0], 3 * 9.81, 0.1);
  EXPECT_NEAR(readings["r"][0], 4, 1e-6);
  EXPECT_EQ(readings["n"][0], -1) << "a ray upward meets nothing";
}

TEST(SensorsOfModels, TouchLeavesOutWhatIsOnTheFarSideOfItsBody) {
  const Readings readings(
      importText(
          mjcf("<geom type='plane' size='5 5 .1'/>"
               "<body name='b' pos='0 0 .1'><freejoint/><geom type='box' size='.1 .1 .1' mass='3'/>"
               "<site name='pad' type='box' size='.1 .1 .02' pos='0 0 -.1'/>"
               "<site name='lid' type='box' size='.1 .1 .02' pos='0 0 .1'/></body>"
               "<body name='c' pos='0 0 .3'><freejoint/><geom type='box' size='.1 .1 .1' mass='2'/></body>",
               "<sensor><touch name='p' site='pad'/><touch name='l' site='lid'/></sensor>")),
      0.5);
  EXPECT_NEAR(readings["p"][0], 5 * 9.81, 0.1);
  EXPECT_NEAR(readings["l"][0], 2 * 9.81, 0.1);
}

TEST(SensorsOfModels, WhatIsNotMeasuredIsNamedWithItsLine) {
  const Import model = importText(mjcf("<body name='b'><joint name='j' type='ball'/><geom size='.1'/></body>",
                                       "<sensor>\n<ballquat name='q' joint='j'/></sensor>"));
  ASSERT_TRUE(model.file.sensors.empty());
  const auto& notes = model.report.notes;
  const auto found = std::ranges::find(notes, "ballquat 'q'", &convert::Note::what);
  ASSERT_NE(found, notes.end());
  EXPECT_EQ(found->effect, Effect::None);
  EXPECT_EQ(found->place.line, 2);
}

TEST(SensorsOfModels, SceneFilesKeepThemBitForBit) {
  const Import model = importText(mjcf(
      "<body name='b'><joint name='j' axis='0 1 0'/><geom size='.1'/><site name='s' pos='.1 .2 .3'/></body>",
      "<sensor><touch name='t' site='s'/><jointpos name='p' joint='j' cutoff='2'/>"
      "<framepos name='f' objtype='site' objname='s' reftype='body' refname='b'/></sensor>"));
  ASSERT_EQ(model.file.sensors.size(), 3u);
  const std::string text = io::toJson(model.file);
  std::vector<io::Fault> faults;
  const io::SceneFile back = io::parseScene(text, faults);
  ASSERT_TRUE(faults.empty()) << faults.front().text();
  EXPECT_EQ(io::toJson(back), text);
}

}  // namespace
}  // namespace rubble
