/// Edits of many bodies at once, the state as arrays, and copies of poses.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support/random.h"
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
  ArrayView rowView = packedArray(rows.data(), 4), values = packedArray(velocities.data(), 4, 3),
            forceView = packedArray(forces.data(), 4, 3);
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

INSTANTIATE_TEST_SUITE_P(Backends, ManyBodies, ::testing::Values("cpu", "reference", "lockstep"),
                         [](const auto& info) { return std::string(info.param); });

/// Bodies of every kind apart from one another: with and without a name, with geometry that several share,
/// with materials that need an entry, and planes.
std::vector<BodyDef> assortment(test::Random& random, int count) {
  const Shape hull = Shape::hull({{0, 0, 0}, {.3, 0, 0}, {0, .4, 0}, {0, 0, .5}, {.2, .2, .4}});
  const Shape dumbbell = Shape::compound(
      {{Shape::sphere(.2), {.3, 0, 0}, {}}, {Shape::box({.1, .1, .2}), {}, {}}});
  std::vector<BodyDef> bodies;
  for (int k = 0; k < count; ++k) {
    const Shape shapes[] = {hull,
                            dumbbell,
                            Shape::sphere(random.uniform(.1, .3)),
                            Shape::capsule(.1, .2),
                            Shape::hull({{0, 0, 0}, {.3, 0, 0}, {0, .4, 0}, {0, 0, .5}}),
                            Shape::plane()};
    BodyDef& body = bodies.emplace_back(
        test::body(shapes[random.below(6)], 2 * random.vector() + Vec3{0, 0, 3}));
    body.orientation = random.rotation();
    body.velocity = random.vector();
    if (random.below(3) == 0) body.mass = random.uniform(1, 9);
    if (random.below(3) == 0)
      body.name = "a name that is too long to stand in its string, " + std::to_string(random.bits());
    if (random.below(4) == 0) body.material.name = random.below(2) == 0 ? "ice" : "felt";
    if (random.below(5) == 0) body.material.rollingFriction = .01 * random.below(3);
    if (random.below(6) == 0) body.motion = Motion::Kinematic;
    if (body.shape.type == ShapeType::Plane) {
      body.motion = Motion::Static;
      body.position = {0, 0, -.01 * k}, body.orientation = {};
    }
  }
  return bodies;
}

/// A world with contacts, free slots and shapes in its tables.
World usedWorld(std::uint64_t seed) {
  test::Random random(seed);
  World world(test::heap(2), options(4));
  world.addBodies(assortment(random, 9));
  test::run(world, 3);
  const std::vector<BodyId> ids = world.bodies();
  for (std::size_t k = 1; k < ids.size(); k += 3) world.removeBody(ids[k]);
  return world;
}

TEST(BodiesAdded, InABatchAreThoseAddedOneByOne) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    World one = usedWorld(seed), many = usedWorld(seed);
    test::Random random(100 + seed);
    const std::vector<BodyDef> bodies = assortment(random, 24);
    std::vector<BodyId> ids;
    for (const BodyDef& body : bodies) ids.push_back(one.addBody(body));
    EXPECT_EQ(many.addBodies(bodies), ids) << seed;
    EXPECT_EQ(one.snapshot().bytes(), many.snapshot().bytes()) << seed;
    test::run(one, 3), test::run(many, 3);
    EXPECT_EQ(one.hash(), many.hash()) << seed;
  }
}

TEST(BodiesAdded, WithASceneAreThoseOfABatch) {
  test::Random random(7);
  Scene scene = test::emptyScene();
  World many(scene, options(4));
  scene.bodies = assortment(random, 40);
  many.addBodies(scene.bodies);
  EXPECT_EQ(World(scene, options(4)).hash(), many.hash());
}

/// Faults of one body, and where they are found.
struct Flaw {
  const char* path;
  void (*make)(BodyDef&);
};
constexpr Flaw kFlaws[] = {
    {".position", [](BodyDef& b) { b.position.y = std::nan(""); }},
    {".material.restitution", [](BodyDef& b) { b.material.restitution = 2; }},
    {".shape.radius", [](BodyDef& b) { b.shape = Shape::sphere(-1); }},
    {".shape.points",
     [](BodyDef& b) {
       b.shape = Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
     }},
    {".mass", [](BodyDef& b) { b.shape = Shape::sphere(1e-14), b.mass = {}, b.motion = Motion::Dynamic; }},
    {".name", [](BodyDef& b) { b.name = "known"; }},
};

TEST(BodiesAdded, InABatchWithAFaultNameItAndLeaveTheWorldAsItWas) {
  std::uint64_t seed = 20;
  for (const Flaw& flaw : kFlaws) {
    World w = usedWorld(++seed);
    w.addBody([] {
      BodyDef known = test::unitCube({9, 9, 9});
      known.name = "known";
      return known;
    }());
    test::Random random(100 + seed);
    std::vector<BodyDef> bodies = assortment(random, 20);
    const std::size_t n = static_cast<std::size_t>(random.below(20));
    const BodyDef right = std::exchange(bodies[n], test::unitCube({0, 0, 9}));
    flaw.make(bodies[n]);
    const std::vector<std::byte> before = w.snapshot().bytes();
    const std::int64_t epoch = w.epoch();
    expectErrorAt([&] { w.addBodies(bodies); }, "bodies[" + std::to_string(n) + "]" + flaw.path);
    EXPECT_EQ(w.epoch(), epoch);
    EXPECT_EQ(w.snapshot().bytes(), before) << flaw.path;
    // nothing is left of the attempt
    World fresh(test::emptyScene(), options(4));
    fresh.restore(Snapshot::fromBytes(before));
    bodies[n] = right;
    EXPECT_EQ(w.addBodies(bodies), fresh.addBodies(bodies)) << flaw.path;
    EXPECT_EQ(w.snapshot().bytes(), fresh.snapshot().bytes()) << flaw.path;
  }
}

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
