/// Shapes of a world: ids, uses, user data, and what becomes of those without use.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include <rubble/worlds.h>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr std::uint64_t kOwn = 7, kLeft = 21, kRight = 22;

Shape wedge(double width) {
  return Shape::hull({{0, 0, 0}, {width, 0, 0}, {0, 1, 0}, {0, 0, 1}, {width, 0, 1}});
}
Shape dumbbell() {
  std::vector<ShapePartDef> parts(2);
  parts[0].shape = parts[1].shape = Shape::sphere(.5);
  parts[0].shape.userData = kLeft, parts[1].shape.userData = kRight;
  parts[0].position = {-1, 0, 0}, parts[1].position = {1, 0, 0};
  Shape shape = Shape::compound(parts);
  shape.userData = kOwn;
  return shape;
}
Shape bowl() {
  return Shape::mesh({{-3, -3, 1}, {3, -3, 1}, {3, 3, 1}, {-3, 3, 1}, {0, 0, 0}},
                     {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
}
World emptyWorld() { return World(test::emptyScene(), test::options(4)); }

TEST(Shapes, AreSharedByBodiesThatAreGivenTheSame) {
  Scene scene = test::emptyScene();
  const Shape shape = wedge(1);
  for (int k = 0; k < 3; ++k) scene.bodies.push_back(test::body(shape, {3. * k, 0, 0}));
  scene.bodies.push_back(test::body(wedge(1), {9, 0, 0}));  // an equal copy of the geometry
  for (const double size : {.5, .5, .4}) scene.bodies.push_back(test::body(Shape::sphere(size), {0, 9, 0}));
  World world(scene, test::options(4));
  const auto shapeAt = [&](int k) { return world.shapeOf(world.bodyAt(k)); };
  EXPECT_EQ(shapeAt(0), shapeAt(2));
  EXPECT_NE(shapeAt(0), shapeAt(3));
  EXPECT_EQ(shapeAt(4), shapeAt(5));
  EXPECT_NE(shapeAt(4), shapeAt(6));
  EXPECT_EQ(world.shapes().size(), 4u);
  EXPECT_EQ(world.useCount(shapeAt(0)), 3);
  EXPECT_EQ(world.definition(shapeAt(0)).geometry, shape.geometry);
}

TEST(Shapes, EndWithTheirLastUse) {
  World world = emptyWorld();
  Shape shape = wedge(1);
  const std::weak_ptr<const ShapeGeometry> geometry = shape.geometry;
  const ShapeId id = world.addShape(shape);
  EXPECT_EQ(world.addShape(shape), id);
  shape = {};
  const BodyId body = world.addBody(test::body(world.definition(id), {}));
  EXPECT_EQ(world.shapeOf(body), id);
  EXPECT_EQ(world.useCount(id), 3);
  world.removeShape(id), world.removeShape(id);
  EXPECT_THROW(world.removeShape(id), Error) << "the body has it, no call";
  EXPECT_EQ(world.useCount(id), 1);
  world.setShape(body, Shape::sphere(1));
  EXPECT_FALSE(world.alive(id));
  EXPECT_TRUE(geometry.expired());
  EXPECT_THROW(world.definition(id), Error);
  const ShapeId sphere = world.shapeOf(body);
  world.removeBody(body);
  EXPECT_FALSE(world.alive(sphere));
  EXPECT_TRUE(world.shapes().empty());
}

TEST(Shapes, AreFoundAmongManyOthers) {
  World world = emptyWorld();
  std::vector<ShapeId> ids;
  for (int k = 1; k <= 500; ++k) ids.push_back(world.addShape(Shape::box({.01 * k, 1, 1})));
  for (int k = 1; k <= 500; k += 2) world.removeShape(ids[static_cast<std::size_t>(k)]);
  EXPECT_EQ(world.shapes().size(), 250u);
  for (int k = 1; k <= 500; ++k) {
    const ShapeId again = world.addShape(Shape::box({.01 * k, 1, 1}));
    EXPECT_EQ(again == ids[static_cast<std::size_t>(k - 1)], k % 2 == 1) << k;
  }
  EXPECT_EQ(world.shapes().size(), 500u);
}

TEST(Shapes, LeaveTheirPlacesInTablesToOthers) {
  World world(test::tower(1), test::options(4));
  world.addBody(test::body(dumbbell(), {9, 0, .5}));
  const auto bytesAfter = [&](int rounds) {
    for (int k = 0; k < rounds; ++k) {
      const BodyId hull = world.addBody(test::body(wedge(1 + .1 * (k % 3)), {3, 0, 1}));
      BodyDef def = test::body(bowl(), {-9, 0, 0});
      def.motion = Motion::Static;
      const BodyId mesh = world.addBody(def);
      world.step();
      world.removeBody(k % 2 ? hull : mesh), world.removeBody(k % 2 ? mesh : hull);
    }
    return world.memoryBytes();
  };
  const std::size_t few = bytesAfter(6);
  EXPECT_EQ(bytesAfter(120), few);
}

TEST(Shapes, OfPlacesThatAreUsedAgainAreWhole) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  World first(scene, test::options(4)), second(scene, test::options(4));
  const std::array shapes{wedge(1), dumbbell(), wedge(2)};
  std::vector<BodyId> passing;
  for (const Shape& shape : shapes) passing.push_back(second.addBody(test::body(shape, {0, 0, 1})));
  test::run(second, 3);
  // the places are given back in another order than they were taken
  for (const int k : {1, 0, 2}) second.removeBody(passing[static_cast<std::size_t>(k)]);
  test::run(first, 3);
  for (World* const world : {&first, &second}) {
    for (int k = 0; k < 3; ++k)
      world->addBody(test::body(shapes[static_cast<std::size_t>(2 - k)], {4. * k, 0, 1.1}));
    test::run(*world, 40);
  }
  std::vector<Vec3> places[2];
  for (const BodyId id : first.bodies()) places[0].push_back(first.state(id).position);
  for (const BodyId id : second.bodies()) places[1].push_back(second.state(id).position);
  std::ranges::sort(places[0], {}, &Vec3::x), std::ranges::sort(places[1], {}, &Vec3::x);
  EXPECT_EQ(places[0], places[1]);
}

TEST(Shapes, ComeBackWithSnapshotsAndSaveGames) {
  World world = emptyWorld();
  const ShapeId held = world.addShape(wedge(1));
  std::array<BodyId, 2> bodies{world.addBody(test::body(world.definition(held), {})),
                               world.addBody(test::body(dumbbell(), {5, 0, 0}))};
  const Snapshot snapshot = world.snapshot();
  test::run(world, 5);
  const std::uint64_t hash = world.hash();
  world.removeBodies(bodies);
  world.removeShape(held);
  world.addBody(test::body(wedge(3), {}));
  for (const Snapshot& from : {snapshot, Snapshot::fromBytes(snapshot.bytes())}) {
    world.restore(from);
    EXPECT_EQ(world.useCount(held), 2);
    EXPECT_EQ(world.shapeOf(bodies[0]), held);
    EXPECT_EQ(world.addShape(world.definition(held)), held);
    EXPECT_EQ(world.shapeUserData(bodies[1], 1), kRight);
    test::run(world, 5);
    EXPECT_EQ(world.hash(), hash);
  }
}

TEST(Shapes, OfOtherUserDataAreOthersWithTheSameBits) {
  World world(test::tower(2), test::options(4)), reference(test::tower(2), test::options(4));
  test::run(world, 20), test::run(reference, 20);
  const BodyId top = world.bodyAt(2), below = world.bodyAt(1);
  Shape marked = world.definition(world.shapeOf(top));
  marked.userData = kOwn;
  world.setShape(top, marked);
  EXPECT_EQ(world.shapeUserData(top), kOwn);
  EXPECT_EQ(world.shapeUserData(below), 0u);
  EXPECT_NE(world.shapeOf(top), world.shapeOf(below));
  test::run(world, 20), test::run(reference, 20);
  EXPECT_EQ(world.hash(), reference.hash()) << "contacts are kept";
}

TEST(Shapes, TellTheirUserDataInHitsAndEvents) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies[0].shape.userData = kOwn + 1;
  scene.bodies.push_back(test::body(dumbbell(), {0, 0, .5}));
  WorldOptions options = test::options(4);
  options.events = true;
  World world(scene, options);
  world.step();
  const BodyId body = world.bodyAt(1);
  EXPECT_EQ(world.castRay({{-1, 0, 5}, {0, 0, -1}, 9, {}}).shapeUserData, kLeft);
  EXPECT_EQ(world.castRay({{1, 0, 5}, {0, 0, -1}, 9, {}}).shapeUserData, kRight);
  EXPECT_EQ(world.castRay({{0, 3, 5}, {0, 0, -1}, 9, {}}).shapeUserData, kOwn + 1);
  const ClosestQuery beside[] = {{{2, 0, .6}, 1, {}}};
  EXPECT_EQ(world.closestPoints(beside).front().shapeUserData, kRight);
  const OverlapQuery around[] = {{Shape::sphere(.1), {1, 0, .5}, {}, {}}};
  EXPECT_EQ(world.overlapsAll(around).front().front().shapeUserData, kRight);

  ASSERT_EQ(world.events().contacts.size(), 1u);
  const ContactEvent& contact = world.events().contacts.front();
  EXPECT_EQ(contact.shapeUserDataA, kOwn + 1);
  EXPECT_EQ(contact.shapeUserDataB, kOwn);
  ASSERT_EQ(contact.points.size(), 2u);
  for (const ContactPoint& point : contact.points) {
    EXPECT_EQ(point.partA, 0);
    EXPECT_EQ(world.shapeUserData(point.b, point.partB), point.position.x < 0 ? kLeft : kRight);
  }
  EXPECT_THROW(world.shapeUserData(body, 2), Error);
  world.removeBody(body);
  world.step();
  ASSERT_EQ(world.events().contacts.size(), 1u);
  EXPECT_EQ(world.events().contacts.front().phase, Phase::End);
  EXPECT_EQ(world.events().contacts.front().shapeUserDataB, kOwn) << "of a body that is gone";
}

TEST(Shapes, OfWorldsInABatchEndInEachAlone) {
  const Shape shape = wedge(1), later = wedge(2);
  Scene scene = test::tower(1);
  scene.bodies.push_back(test::body(shape, {3, 0, 1}));
  Worlds worlds(test::options(4));
  worlds.addCopies(scene, 2);
  World alone(scene, test::options(4));
  const auto change = [&](World& world) {
    const ShapeId id = world.shapeOf(world.bodyAt(2));
    world.removeBody(world.bodyAt(2));
    EXPECT_FALSE(world.alive(id));
    world.addBody(test::body(dumbbell(), {-4, 0, 1}));
    world.addBody(test::body(later, {6, 0, 1}));
  };
  worlds.step(), alone.step();
  const Snapshot before = worlds[0].snapshot();
  change(worlds[0]), change(alone);
  for (int k = 0; k < 20; ++k) worlds.step(), alone.step();
  for (const BodyId id : alone.bodies())
    EXPECT_EQ(worlds[0].state(id).position, alone.state(id).position) << id.index;
  EXPECT_EQ(worlds[1].useCount(worlds[1].shapeOf(worlds[1].bodyAt(2))), 1);
  // the other world goes on with its own, and the first one goes back to it
  worlds[0].restore(before);
  for (int k = 0; k < 20; ++k) worlds.step();
  World again(scene, test::options(4));
  test::run(again, 21);
  EXPECT_EQ(worlds[0].state(worlds[0].bodyAt(2)).position, again.state(again.bodyAt(2)).position);
  const auto bytesAfter = [&](int rounds) {
    for (int k = 0; k < rounds; ++k) {
      const BodyId id = worlds[1].addBody(test::body(wedge(1.5), {-3, 0, 1}));
      worlds.step();
      worlds[1].removeBody(id);
    }
    return worlds.memoryBytes();
  };
  const std::size_t few = bytesAfter(3);
  EXPECT_EQ(bytesAfter(100), few) << "places are used again";
}

}  // namespace
}  // namespace rubble
