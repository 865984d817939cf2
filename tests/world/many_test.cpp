/// Edits of many bodies at once, the state as arrays, and copies of poses.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::options;

/// The call must throw an Error whose path is that.
template <class F> void expectErrorAt(F&& call, const std::string& path) {
  try {
    call();
    ADD_FAILURE() << "no error at " << path;
  } catch (const Error& error) {
    EXPECT_EQ(error.path(), path) << error.what();
  }
}

class ManyBodies : public ::testing::TestWithParam<const char*> {
 protected:
  World world(const Scene& scene) const { return World(scene, options(4, GetParam())); }
};

std::vector<BodyId> dynamicOf(const World& world) {
  std::vector<BodyId> out;
  for (const BodyId id : world.bodies())
    if (world.definition(id).motion == Motion::Dynamic) out.push_back(id);
  return out;
}

template <class T> T numberAt(const ArrayView& view, std::int64_t row, std::int64_t column) {
  T out;
  std::memcpy(&out, static_cast<const char*>(view.data) + row * view.strides[0] + column * view.strides[1],
              sizeof out);
  return out;
}
double realAt(const ArrayView& view, std::int64_t row, std::int64_t column) {
  return view.typestr[2] == '8' ? numberAt<double>(view, row, column)
                                : static_cast<double>(numberAt<float>(view, row, column));
}

TEST_P(ManyBodies, AreEditedAsOneByOne) {
  World one = world(test::heap(3)), many = world(test::heap(3));
  test::run(one, 10), test::run(many, 10);
  const std::vector<BodyId> ids = dynamicOf(one);
  std::vector<BodyState> states;
  std::vector<Vec3> pushes, torques;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    BodyState s = one.state(ids[k]);
    s.velocity += Vec3{.1, 0, .01 * static_cast<double>(k)};
    states.push_back(s);
    pushes.push_back({.3 * static_cast<double>(k), 1, 2});
    torques.push_back({0, .5, -.1 * static_cast<double>(k)});
  }
  for (std::size_t k = 0; k < ids.size(); ++k) {
    one.setState(ids[k], states[k]);
    one.applyImpulse(ids[k], pushes[k]);
    one.applyForce(ids[k], pushes[k]);
    one.applyTorque(ids[k], torques[k]);
  }
  many.setStates(ids, states);
  many.applyImpulses(ids, pushes);
  many.applyForces(ids, pushes, torques);
  test::run(one, 3), test::run(many, 3);
  EXPECT_EQ(one.hash(), many.hash());

  const std::vector<BodyDef> fresh = {test::unitCube({5, 5, 9}), test::unitCube({7, 5, 9})};
  for (const BodyDef& body : fresh) one.addBody(body);
  const std::vector<BodyId> added = many.addBodies(fresh);
  EXPECT_EQ(added.size(), 2u);
  const std::vector<BodyId> gone = {ids[3], ids[7], ids[8]};
  for (const BodyId id : gone) one.removeBody(id);
  many.removeBodies(gone);
  test::run(one, 20), test::run(many, 20);
  EXPECT_EQ(one.bodies(), many.bodies());
  EXPECT_EQ(one.hash(), many.hash());
}

TEST_P(ManyBodies, ChangeNothingWhenOneOfThemIsWrong) {
  World w = world(test::tower(3));
  test::run(w, 2);
  const std::uint64_t hash = w.hash();
  const std::vector<BodyId> ids = dynamicOf(w);
  std::vector<BodyState> states(3, w.state(ids[0]));
  states[2].orientation = {2, 0, 0, 0};
  expectErrorAt([&] { w.setStates(ids, states); }, "states[2].orientation");
  states.pop_back();
  expectErrorAt([&] { w.setStates(ids, states); }, "states");
  const std::vector<Vec3> pushes = {{1, 0, 0}, {0, 0, std::nan("")}, {}};
  expectErrorAt([&] { w.applyImpulses(ids, pushes); }, "impulses[1]");
  expectErrorAt([&] { w.applyForces(ids, pushes); }, "forces[1]");
  const std::vector<BodyId> twice = {ids[0], ids[0]};
  expectErrorAt([&] { w.removeBodies(twice); }, "bodies");
  std::vector<BodyDef> bodies = {test::unitCube({9, 0, 1}), test::unitCube({12, 0, 1})};
  bodies[0].name = bodies[1].name = "twin";
  expectErrorAt([&] { w.addBodies(bodies); }, "bodies[1].name");
  EXPECT_EQ(w.hash(), hash);
}

TEST_P(ManyBodies, HaveTheirStateInArraysByIndex) {
  World w = world(test::heap(2));
  test::run(w, 5);
  const ArrayView position = w.array(StateArray::Position), orientation = w.array(StateArray::Orientation);
  const ArrayView velocity = w.array(StateArray::Velocity), spin = w.array(StateArray::AngularVelocity);
  EXPECT_EQ(position.shape[0], static_cast<std::int64_t>(w.bodies().size()));
  EXPECT_EQ(position.shape[1], 3);
  EXPECT_EQ(orientation.shape[1], 4);
  EXPECT_STREQ(position.typestr, "<f8");
  EXPECT_FALSE(position.device);
  for (const BodyId id : w.bodies()) {
    const BodyState s = w.state(id);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(realAt(position, id.index, k), s.position[k]);
      EXPECT_EQ(realAt(velocity, id.index, k), s.velocity[k]);
      EXPECT_EQ(realAt(spin, id.index, k), s.angularVelocity[k]);
      EXPECT_EQ(realAt(orientation, id.index, k + 1), s.orientation.v[k]);
    }
    EXPECT_EQ(realAt(orientation, id.index, 0), s.orientation.s);
  }
  // views live as long as the epoch, which steps and changes of state leave alone
  w.setState(w.bodyAt(3), w.state(w.bodyAt(3)));
  w.step();
  EXPECT_EQ(w.epoch(), position.epoch);
  EXPECT_EQ(w.array(StateArray::Position).data, position.data);
  w.removeBody(w.bodyAt(3));
  EXPECT_NE(w.epoch(), position.epoch);
}

TEST_P(ManyBodies, AreWrittenFromArrays) {
  World one = world(test::heap(2)), many = world(test::heap(2));
  test::run(one, 5), test::run(many, 5);
  const std::vector<BodyId> ids = {one.bodyAt(4), one.bodyAt(9), one.bodyAt(2)};
  // row 99 belongs to no body
  const std::vector<int> rows = {4, 9, 99, 2};
  const std::vector<double> velocities = {1, 2, 3, -1, 0, .5, 7, 7, 7, 0, .25, -2};
  const std::vector<float> forces = {10, 0, 0, 0, 20, 0, 1, 1, 1, 0, 0, 30};
  ArrayView rowView, values, forceView;
  rowView.data = rows.data(), rowView.typestr = "<i4";
  rowView.shape[0] = 4, rowView.shape[1] = 1, rowView.strides[0] = rowView.strides[1] = 4;
  values.data = velocities.data(), values.typestr = "<f8";
  values.shape[0] = 4, values.shape[1] = 3, values.strides[0] = 24, values.strides[1] = 8;
  forceView = values;
  forceView.data = forces.data(), forceView.typestr = "<f4", forceView.strides[0] = 12,
  forceView.strides[1] = 4;
  // a state that is set is normalized, velocities alone leave the orientation as it is
  for (const BodyId id : ids) many.setState(id, many.state(id));
  many.scatter(StateArray::Velocity, rowView, values);
  many.scatter(StateArray::Force, rowView, forceView);
  many.scatter(StateArray::Force, rowView, forceView);
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const std::size_t row = k == 2 ? 3 : k;
    BodyState s = one.state(ids[k]);
    s.velocity = {velocities[3 * row], velocities[3 * row + 1], velocities[3 * row + 2]};
    one.setState(ids[k], s);
    for (int i = 0; i < 2; ++i)
      one.applyForce(ids[k], {forces[3 * row], forces[3 * row + 1], forces[3 * row + 2]});
  }
  test::run(one, 10), test::run(many, 10);
  EXPECT_EQ(one.hash(), many.hash());

  values.typestr = "<i4";
  expectErrorAt([&] { many.scatter(StateArray::Velocity, rowView, values); }, "values.typestr");
  values.typestr = "<f8", values.shape[1] = 4;
  expectErrorAt([&] { many.scatter(StateArray::Velocity, rowView, values); }, "values.shape");
  values.shape[1] = 3, values.device = rowView.device = true;
  expectErrorAt([&] { many.scatter(StateArray::Velocity, rowView, values); }, "values");
}

TEST_P(ManyBodies, ArePhotographedWhileTheWorldStepsOn) {
  World w = world(test::heap(2));
  EXPECT_FALSE(w.posesReady());
  expectErrorAt([&] { w.takePoses(); }, "takePoses");
  const BodyId id = w.bodyAt(7);
  std::vector<Vec3> places;
  for (int i = 0; i < 6; ++i) {
    w.step();
    places.push_back(w.state(id).position);
    w.beginPoses();
    if (i == 0) continue;
    // that of the step before: this one is still under way
    const PoseFrame frame = w.takePoses();
    EXPECT_EQ(frame.step, i);
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(realAt(frame.position, id.index, k), places[static_cast<std::size_t>(i - 1)][k]);
  }
  w.beginPoses();
  expectErrorAt([&] { w.beginPoses(); }, "beginPoses");
  EXPECT_TRUE(w.posesReady());
}

INSTANTIATE_TEST_SUITE_P(Backends, ManyBodies, ::testing::Values("cpu", "reference", "lockstep"));

TEST(SnapshotCopies, DoNotFollowEditsOfTheWorld) {
  World world(test::heap(2), options(4));
  test::run(world, 5);
  const Snapshot before = world.snapshot();
  const std::uint64_t hash = world.hash();
  const std::vector<BodyId> ids = world.bodies();
  world.removeBody(world.bodyAt(6));
  world.addBody(test::unitCube({9, 9, 9}));
  world.addBody(test::unitCube({9, 9, 12}));
  test::run(world, 5);
  world.restore(before);
  EXPECT_EQ(world.bodies(), ids);
  EXPECT_EQ(world.hash(), hash);
  EXPECT_EQ(world.definition(world.bodyAt(6)).position, test::heap(2).bodies[6].position);
}

TEST(SnapshotCopies, OfAnotherPrecisionAreRefused) {
  World single(test::tower(2), options(4)), precise(test::tower(2), options(4, "reference"));
  expectErrorAt([&] { precise.restore(single.snapshot()); }, "snapshot");
  expectErrorAt([&] { single.restore(precise.snapshot()); }, "snapshot");
}

}  // namespace
}  // namespace rubble
