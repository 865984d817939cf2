/// Invalid input throws with the path of the faulty field.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::expectError;
using test::kNan;

void expectBadScene(const std::string& path, const std::function<void(Scene&)>& spoil) {
  Scene scene = test::tower(3);
  scene.joints.push_back(test::ball(1, {0, 0, .5}, 2, {0, 0, -.5}));
  EXPECT_NO_THROW(validate(scene));
  spoil(scene);
  expectError(path, [&] { validate(scene); });
  expectError(path, [&] { World world(scene, test::options()); });
}

TEST(Validation, NamesTheBodyAndFieldThatIsWrong) {
  expectBadScene("bodies[2].shape.halfExtents.y", [](Scene& s) { s.bodies[2].shape.halfExtents.y = 0; });
  expectBadScene("bodies[2].shape.radius", [](Scene& s) { s.bodies[2].shape = Shape::sphere(-1); });
  expectBadScene("bodies[2].shape.halfLength", [](Scene& s) { s.bodies[2].shape = Shape::capsule(1, kNan); });
  expectBadScene("bodies[3].mass", [](Scene& s) { s.bodies[3].mass = 0; });
  expectBadScene("bodies[3].density", [](Scene& s) { s.bodies[3].mass.reset(), s.bodies[3].density = -5; });
  expectBadScene("bodies[1].position", [](Scene& s) { s.bodies[1].position.x = kNan; });
  expectBadScene("bodies[1].orientation", [](Scene& s) { s.bodies[1].orientation = {0, 0, 0, 0}; });
  expectBadScene("bodies[1].velocity", [](Scene& s) { s.bodies[1].velocity.z = kHard; });
  expectBadScene("bodies[1].angularVelocity", [](Scene& s) { s.bodies[1].angularVelocity.z = kNan; });
  expectBadScene("bodies[1].gravityScale", [](Scene& s) { s.bodies[1].gravityScale = kNan; });
  expectBadScene("bodies[1].material.staticFriction",
                 [](Scene& s) { s.bodies[1].material.staticFriction = -.1; });
  expectBadScene("bodies[1].material.dynamicFriction",
                 [](Scene& s) { s.bodies[1].material.dynamicFriction = 2; });
  expectBadScene("bodies[0].shape", [](Scene& s) { s.bodies[0].motion = Motion::Dynamic; });
  expectBadScene("gravity", [](Scene& s) { s.gravity.y = kNan; });
}

/// Two bodies with a joint that has fields of its own.
Scene withJoint(const char* type, std::any own) {
  Scene scene = test::tower(3);
  JointDef joint;
  joint.type = jointType(type);
  joint.bodyA = 1, joint.bodyB = 2;
  joint.own = std::move(own);
  scene.joints.push_back(std::move(joint));
  return scene;
}

TEST(Validation, NamesTheNumberOfATendonThatIsWrong) {
  const TendonFields good{{0, 0, 0, 0, 1, 1, 0, 0, 0, 0},
                          {0, 0, 2, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0},
                          {0, 2, 0, 0, 5, 0, 1, 0, .5, 0, 0, 0, 0}};
  const auto spoilt = [&](const std::string& field, const std::function<void(TendonFields&)>& spoil) {
    Scene scene = withJoint("tendon", good);
    EXPECT_NO_THROW(validate(scene));
    TendonFields bad = good;
    spoil(bad);
    scene.joints[0].own = bad;
    expectError("joints[0]." + field, [&] { validate(scene); });
  };
  spoilt("path", [](TendonFields& t) { t.path.pop_back(); });
  spoilt("path[0]", [](TendonFields& t) { t.path[0] = 4; });
  spoilt("path[9]", [](TendonFields& t) { t.path[9] = -1; });
  // one segment, with the number 0
  spoilt("wraps[0]", [](TendonFields& t) { t.wraps[0] = 1; });
  spoilt("wraps[1]", [](TendonFields& t) { t.wraps[1] = 1.5; });
  spoilt("wraps[8]", [](TendonFields& t) { t.wraps[8] = 0; });
  spoilt("wraps[9]", [](TendonFields& t) { t.wraps[9] = 2; });
  spoilt("wraps[13]",
         [&](TendonFields& t) { t.wraps.insert(t.wraps.end(), good.wraps.begin(), good.wraps.end()); });
  spoilt("terms[0]", [](TendonFields& t) { t.terms[0] = 5; });
  spoilt("terms[1]", [](TendonFields& t) { t.terms[1] = 4; });
  spoilt("terms[2]", [](TendonFields& t) { t.terms[2] = -1; });
  spoilt("terms[2]", [](TendonFields& t) { t.terms[2] = 0; });
  spoilt("terms[3]", [](TendonFields& t) { t.terms[3] = 0; });
  spoilt("tilts", [](TendonFields& t) { t.tilts = {0}; });
  spoilt("tilts[1]", [](TendonFields& t) { t.tilts = {0, 2}; });
}

TEST(Validation, NamesTheFieldOfAGimbalThatIsWrong) {
  const auto with = [](const GimbalFields& fields) { return withJoint("gimbal", fields); };
  EXPECT_NO_THROW(validate(with({{1, 2, 3}, {0, 0, 1}, -1, 1.4})));
  expectError("joints[0].offsetB", [&] { validate(with({{kNan, 0, 0}, {}, 0, 0})); });
  expectError("joints[0].offsetA", [&] { validate(with({{}, {0, kNan, 0}, 0, 0})); });
  // parallel axes
  expectError("joints[0].tiltB", [&] { validate(with({{}, {}, 1.57, 0})); });
  expectError("joints[0].tiltA", [&] { validate(with({{}, {}, 0, -1.57})); });
}

TEST(Validation, NamesTheJointAndFieldThatIsWrong) {
  expectBadScene("joints[0].bodyA", [](Scene& s) { s.joints[0].bodyA = 9; });
  expectBadScene("joints[0].bodyB", [](Scene& s) { s.joints[0].bodyB = -2; });
  expectBadScene("joints[0]", [](Scene& s) { s.joints[0].bodyB = 1; });
  expectBadScene("joints[0]", [](Scene& s) { s.joints[0].bodyA = 0, s.joints[0].bodyB = kWorld; });
  expectBadScene("joints[0].anchorA", [](Scene& s) { s.joints[0].anchorA.x = kNan; });
  expectBadScene("joints[0].orientationAtoB", [](Scene& s) { s.joints[0].orientationAtoB = {2, 0, 0, 0}; });
  expectBadScene("joints[0].stiffness", [](Scene& s) { s.joints[0].stiffness = 0; });
  expectBadScene("joints[0].angularStiffness", [](Scene& s) { s.joints[0].angularStiffness = kNan; });
  expectBadScene("joints[0].breakForce", [](Scene& s) { s.joints[0].breakForce = -1; });
  expectBadScene("joints[0].breakTorque", [](Scene& s) { s.joints[0].breakTorque = 0; });
}

TEST(Validation, NamesTheEventThatIsWrong) {
  expectBadScene("events[0].step", [](Scene& s) { s.events.resize(1), s.events[0].step = -1; });
  expectBadScene("events[0].add[0].position", [](Scene& s) {
    s.events.resize(1);
    s.events[0].add.push_back(test::unitCube({kNan, 0, 0}));
  });
}

TEST(Validation, RefusesTwoBodiesOfOneName) {
  Scene scene = test::tower(2);
  scene.bodies[1].name = scene.bodies[2].name = "twin";
  expectError("bodies[2].name", [&] { World world(scene, test::options()); });
}

TEST(Validation, OfOptionsNamesWhatThereIs) {
  const Scene scene = test::tower(1);
  expectError("backend", [&] { World world(scene, test::options(4, "quantum")); });
  expectError("threads", [&] { World world(scene, test::options(4, "cpu", -1)); });
  WorldOptions set;
  set.instructionSet = "abacus";
  expectError("instructionSet", [&] { World world(scene, set); });
  const auto expectBadRanks = [&](const char* path, auto&& change) {
    WorldOptions options = test::options(4, "distributed");
    change(options.ranks);
    expectError(path, [&] { World world(scene, options); });
  };
  expectBadRanks("ranks.count", [](RankOptions& ranks) { ranks.count = -1; });
  expectBadRanks("ranks.cutInterval", [](RankOptions& ranks) { ranks.cutInterval = -1; });
  expectBadRanks("ranks.maxImbalance", [](RankOptions& ranks) { ranks.maxImbalance = kNan; });
  expectBadRanks("ranks.timeout", [](RankOptions& ranks) { ranks.timeout = 0; });
  try {
    World world(scene, test::options(4, "quantum"));
  } catch (const Error& e) {
    for (const std::string& name : backends())
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
  }
}

TEST(Validation, OfEditsWhileRunning) {
  World world(test::tower(2), test::options());
  BodyDef bad = test::unitCube({0, 0, 5});
  bad.velocity.x = kNan;
  expectError("body.velocity", [&] { world.addBody(bad); });
  BodyState state = world.state(world.bodyAt(1));
  state.position.x = kNan;
  EXPECT_THROW(world.setState(world.bodyAt(1), state), Error);
  JointDef joint;
  EXPECT_THROW(world.addJoint(joint, world.bodyAt(1), world.bodyAt(1)), Error);
  EXPECT_THROW(world.addJoint(joint, world.bodyAt(1), BodyId{77, 0}), Error);
}

TEST(Parameters, AreSetByNameWithinTheirRange) {
  for (const ParamField& field : paramFields()) {
    Params params;
    const double before = field.get(params);
    EXPECT_NO_THROW(setParam(params, field.name, before)) << field.name;
    EXPECT_EQ(field.get(params), before) << field.name;
    expectError(std::string("params.") + field.name, [&] { setParam(params, field.name, kNan); });
    expectError(std::string("params.") + field.name, [&] { setParam(params, field.name, 1e300); });
    EXPECT_EQ(field.get(params), before) << field.name;
  }
  Params params;
  expectError("params", [&] { setParam(params, "viscosity", 1); });
  setParam(params, "iterations", 7);
  EXPECT_EQ(params.iterations, 7);
}

TEST(Parameters, OutOfRangeAreRefusedByTheWorld) {
  const Scene scene = test::tower(1);
  WorldOptions options = test::options();
  options.params.dt = 0;
  expectError("params.dt", [&] { World world(scene, options); });
  World world(scene, test::options());
  Params params = world.params();
  params.iterations = 0;
  expectError("params.iterations", [&] { world.setParams(params); });
  EXPECT_EQ(world.params().iterations, 10);
}

TEST(Parameters, OfEveryPresetAreValid) {
  for (const Preset preset : {Preset::Engine, Preset::Paper, Preset::Demo3d}) {
    EXPECT_NO_THROW(validate(Params::of(preset)));
    EXPECT_EQ(Params::of(preset).preset, preset);
  }
}

}  // namespace
}  // namespace rubble
