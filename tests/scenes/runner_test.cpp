#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <scenes/probes.h>
#include <scenes/registry.h>

namespace rubble::scenes {
namespace {

BodyDef cube(const std::string& name, const Vec3& position) {
  BodyDef body;
  body.name = name;
  body.position = position;
  return body;
}

/// Two cubes that fall freely, far from one another.
Job fallingJob() {
  Job job;
  job.scene.gravity = {0, 0, -10};
  job.scene.bodies = {cube("low", {0, 0, 0}), cube("high", {0, 0, 100})};
  job.steps = 60;
  return job;
}

WorldOptions options(double dt = 1.0 / 60) {
  WorldOptions result;
  result.threads = 1;
  result.params.dt = dt;
  return result;
}

Event removal(int step, const std::string& pattern) {
  Event event;
  event.step = step;
  event.remove = {pattern};
  return event;
}

TEST(Runner, AppliesEventsBeforeTheirStep) {
  Job job = fallingJob();
  Event add, push;
  add.step = 3;
  add.add = {cube("late", {50, 0, 0})};
  push.step = 5;
  push.setVelocity = {{"late", {1, 0, 0}, {}}};
  job.scene.events = {push, add};  // in any order
  Runner runner(std::move(job), options());
  for (int i = 0; i < 3; ++i) runner.step();
  EXPECT_THROW(runner.world().findBody("late"), Error);
  runner.step();
  const BodyId late = runner.world().findBody("late");
  EXPECT_NEAR(runner.world().state(late).velocity.x, 0, 1e-6);
  runner.step();
  runner.step();
  EXPECT_NEAR(runner.world().state(late).velocity.x, 1, 1e-5);
}

TEST(Runner, RemovesByNameAndByPrefix) {
  Job job = fallingJob();
  job.scene.bodies.push_back(cube("brick0", {10, 0, 0}));
  job.scene.bodies.push_back(cube("brick1", {20, 0, 0}));
  job.scene.events = {removal(0, "brick*"), removal(1, "low")};
  Runner runner(std::move(job), options());
  runner.step();
  EXPECT_EQ(runner.world().bodies().size(), 2u);
  runner.step();
  EXPECT_EQ(runner.world().bodies().size(), 1u);
  EXPECT_NO_THROW(runner.world().findBody("high"));
}

TEST(Runner, RefusesEventsThatNameNothing) {
  for (const char* pattern : {"nobody", "nobody*"}) {
    Job job = fallingJob();
    job.scene.events = {removal(0, pattern)};
    Runner runner(std::move(job), options());
    EXPECT_THROW(runner.step(), Error) << pattern;
  }
}

TEST(Runner, KeepsTimesAtAnotherTimeStep) {
  for (const auto& [perSecond, factor] : {std::pair{30, .5}, {60, 1.0}, {240, 4.0}}) {
    Job job = fallingJob();
    job.smashStep = 120;
    job.scene.events = {removal(90, "low")};
    const Runner runner(std::move(job), options(1.0 / perSecond));
    EXPECT_EQ(runner.job().steps, int(60 * factor));
    EXPECT_EQ(runner.job().smashStep, int(120 * factor));
    EXPECT_EQ(runner.job().scene.events[0].step, int(90 * factor));
  }
}

TEST(Runner, StopsWhenTheObserverSaysSo) {
  Runner runner(fallingJob(), options());
  int seen = 0;
  const RunResult result = runner.run(20, [&](const World&, const StepReport&, int step, int steps) {
    EXPECT_EQ(steps, 20);
    EXPECT_EQ(step, seen++);
    return step < 4;
  });
  EXPECT_EQ(result.reports.size(), 5u);
  EXPECT_EQ(runner.world().stepCount(), 5);
}

TEST(Runner, JudgesWhatItMeasures) {
  Job job = fallingJob();
  job.probes.push_back(stackProbe(job.scene, 10));
  job.claims = {{"top_drop_m", 5, 5.2, "10 m/s2 for 1 s"},
                {"bricks_lost", 2, 2, "both"},
                {"nothing", 0, 0, "not measured"}};
  Runner runner(std::move(job), options());
  const RunResult result = runner.run(60);
  ASSERT_EQ(result.verdict.results.size(), 3u);
  EXPECT_TRUE(result.verdict.results[0].holds) << result.verdict.results[0].value;
  EXPECT_TRUE(result.verdict.results[1].holds);
  EXPECT_FALSE(result.verdict.results[2].holds);
  EXPECT_FALSE(result.verdict.holds);
}

TEST(FallProbe, GivesOneForFreeFallFromRestAtEveryTimeStep) {
  for (const int perSecond : {30, 60, 240}) {
    Job job = fallingJob();
    for (BodyDef& body : job.scene.bodies) body.gravityScale = 0;
    job.probes.push_back(fallProbe(job.scene, .5, .5));
    Runner runner(std::move(job), options(1.0 / perSecond));
    for (int i = 0; i < perSecond / 2; ++i) runner.step();
    // They hover for half a second; then a force takes the place of gravity.
    Metrics metrics;
    for (int i = 0; i < perSecond / 2; ++i) {
      for (const BodyId id : runner.world().bodies())
        runner.world().applyForce(id, {0, 0, -10 * runner.world().massOf(id).mass});
      runner.step();
    }
    runner.job().probes[0]->finish(runner.world(), metrics);
    EXPECT_NEAR(metrics.at("fall_ratio"), 1, 1e-3) << perSecond;
    EXPECT_NEAR(metrics.at("fall_ratio_min"), 1, 1e-3) << perSecond;
  }
}

TEST(StackProbe, IsTakenAtItsTime) {
  Job job = fallingJob();
  job.probes.push_back(stackProbe(job.scene, .5));
  Runner runner(std::move(job), options());
  const double h = 1.0 / 60;
  EXPECT_NEAR(runner.run(60).metrics.at("top_drop_m"), 10 * h * h * 30 * 31 / 2, 1e-4);
}

TEST(StackProbe, MeasuresAtTheEndOfAShorterRun) {
  Job job = fallingJob();
  job.probes.push_back(stackProbe(job.scene, 2));
  Runner runner(std::move(job), options());
  const double h = 1.0 / 60;
  EXPECT_NEAR(runner.run(12).metrics.at("top_drop_m"), 10 * h * h * 12 * 13 / 2, 1e-4);
}

TEST(SmashProbes, SayNothingOfARunThatEndsBefore) {
  Job job = fallingJob();
  job.probes = smashProbes(job.scene, 2);
  Runner runner(std::move(job), options());
  EXPECT_FALSE(runner.run(60).metrics.contains("smash_moved_ratio"));
}

TEST(EnergyProbe, FindsNoGainInFreeFall) {
  Job job = fallingJob();
  job.probes.push_back(energyProbe(2 * 1000 * 10 * 5.0));
  Runner runner(std::move(job), options());
  const Metrics metrics = runner.run(60).metrics;
  EXPECT_LT(metrics.at("energy_gain_ratio"), 1e-3);
  // Implicit Euler loses m g^2 t h / 2 a body.
  EXPECT_NEAR(metrics.at("energy_end_ratio"), -(100.0 / 60 / 2) / 50, 1e-3);
}

}  // namespace
}  // namespace rubble::scenes
