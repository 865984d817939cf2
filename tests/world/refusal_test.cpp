/// Invalid input is refused with the path of the faulty field, and an Error changes nothing.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::expectError;
using test::kNan;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// As a static body of a scene: refused by validate(), before anything is cooked, and by a world.
void expectBadShape(const std::string& member, const Shape& shape) {
  Scene scene = test::tower(1);
  scene.bodies[0] = test::body(shape, {});
  scene.bodies[0].motion = Motion::Static;
  expectError("bodies[0].shape" + member, [&] { validate(scene); });
  expectError("bodies[0].shape" + member, [&] { World world(scene, test::options()); });
}

const std::vector<Vec3> kTriangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
const std::vector<Vec3> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TEST(Refusal, OfLatticesWhoseCountsDoNotFitTheirSamples) {
  expectBadShape(".distances", Shape::distanceField({2, 2, 3}, {}, 1, {-1, 1, 1, 1}));
  expectBadShape(".heights", Shape::heightField(3, 2, {1, 1, 0}, {0, 0, 0, 0}));
  // products of 2^64 and of 2^32
  expectBadShape(".counts", Shape::distanceField({1 << 22, 1 << 21, 1 << 21}, {}, 1, {}));
  expectBadShape(".counts", Shape::heightField(65536, 65536, {1, 1, 0}, {}));
  expectBadShape(".counts", Shape::heightField(2147483647, 2147483647, {1, 1, 0}, {}));
  expectBadShape(".counts", Shape::heightField(2, -2, {1, 1, 0}, {}));
}

TEST(Refusal, OfNumbersInShapesThatAreNotFinite) {
  expectBadShape(".heights[2]", Shape::heightField(2, 2, {1, 1, 0}, {0, 0, kNan, 0}));
  expectBadShape(".heights[3]", Shape::heightField(2, 2, {1, 1, 0}, {0, 0, 0, kInfinity}));
  expectBadShape(".spacing.y", Shape::heightField(2, 2, {1, kInfinity, 0}, {0, 0, 0, 0}));
  expectBadShape(".distances[7]", Shape::distanceField({2, 2, 2}, {}, 1, {-1, 1, 1, 1, 1, 1, 1, kNan}));
  expectBadShape(".origin", Shape::distanceField({2, 2, 2}, {kNan, 0, 0}, 1, {-1, 1, 1, 1, 1, 1, 1, 1}));
  expectBadShape(".spacing", Shape::distanceField({2, 2, 2}, {}, kInfinity, {-1, 1, 1, 1, 1, 1, 1, 1}));
  expectBadShape(".points[1]", Shape::hull({{0, 0, 0}, {kNan, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  expectBadShape(".parts[0].density", Shape::compound({{Shape::sphere(1), {}, {}, {}, kNan}}));
}

TEST(Refusal, OfShapesWithoutTheirGeometryOrThatPointOutsideOfIt) {
  for (const auto& [type, member] : {std::pair{ShapeType::Hull, ".points"},
                                     {ShapeType::Compound, ".parts"},
                                     {ShapeType::Mesh, ".triangles"},
                                     {ShapeType::HeightField, ".counts"},
                                     {ShapeType::DistanceField, ".counts"}}) {
    Shape shape;
    shape.type = type;
    expectBadShape(member, shape);
  }
  expectBadShape(".triangles[0]", Shape::mesh(kTriangle, {{0, 1, 3}}));
  expectBadShape(".triangles[1]", Shape::mesh(kTriangle, {{0, 1, 2}, {0, -1, 2}}));
}

TEST(Refusal, OfCompoundsInCompoundsWhereTheFirstOneBegins) {
  Shape nested = Shape::sphere(1);
  for (int depth = 0; depth < 5; ++depth) nested = Shape::compound({{nested, {}, {}}});
  expectBadShape(".parts[0].shape", nested);
  expectBadShape(".parts[1].shape", Shape::compound({{Shape::sphere(1), {}, {}},
                                                     {Shape::mesh(kTriangle, {{0, 1, 2}}), {}, {}}}));
}

TEST(Refusal, OfEnumerationsThatNameNothing) {
  const auto bad = [](const std::string& path, const std::function<void(Scene&)>& spoil) {
    Scene scene = test::tower(2);
    scene.joints.push_back(test::ball(1, {0, 0, .5}, 2, {0, 0, -.5}));
    spoil(scene);
    expectError(path, [&] { World world(scene, test::options()); });
  };
  bad("bodies[1].shape.type", [](Scene& s) { s.bodies[1].shape.type = static_cast<ShapeType>(99); });
  bad("bodies[1].motion", [](Scene& s) { s.bodies[1].motion = static_cast<Motion>(-1); });
  bad("bodies[1].material.frictionCombine",
      [](Scene& s) { s.bodies[1].material.frictionCombine = static_cast<Combine>(6); });
  bad("bodies[1].material.restitutionCombine",
      [](Scene& s) { s.bodies[1].material.restitutionCombine = static_cast<Combine>(-7); });
  bad("joints[0].type", [](Scene& s) { s.joints[0].type = static_cast<JointType>(99); });
  World world(test::tower(1), test::options());
  expectError("array", [&] { world.array(static_cast<StateArray>(17)); });
  JointDef joint;
  joint.type = static_cast<JointType>(-3);
  expectError("joint.type", [&] { world.addJoint(joint, world.bodyAt(1), {}); });
}

TEST(Refusal, OfForcesAndSettingsThatAreNotFinite) {
  Scene scene = test::tower(2);
  scene.deformables.push_back(straightCable({3, 0, 1}, {4, 0, 1}, 4));
  World world(scene, test::options());
  const std::uint64_t before = world.hash();
  const BodyId body = world.bodyAt(1);
  for (const double odd : {kNan, kInfinity, -kInfinity}) {
    const Vec3 v{0, odd, 0};
    expectError("force", [&] { world.applyForce(body, v); });
    expectError("force", [&] { world.applyForceAt(body, v, {}); });
    expectError("point", [&] { world.applyForceAt(body, {1, 0, 0}, v); });
    expectError("torque", [&] { world.applyTorque(body, v); });
    expectError("gravity", [&] { world.setGravity(v); });
    expectError("force", [&] { world.applyVertexForce(world.deformableAt(0), 0, v); });
    expectError("point", [&] { world.addDragJoint(body, v, 1); });
    if (odd > 0) expectError("frequency", [&] { world.addDragJoint(body, {}, 1, odd); });
  }
  EXPECT_EQ(world.joints().size(), 0u);
  EXPECT_EQ(world.hash(), before);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(world.step().quarantined, 0);
}

TEST(Refusal, OfNumbersThatAreInfiniteInSinglePrecision) {
  World world(test::tower(2), test::options());
  const BodyId body = world.bodyAt(1);
  BodyState state = world.state(body);
  state.velocity.x = 1e300;
  expectError("state.velocity", [&] { world.setState(body, state); });
  expectError("force", [&] { world.applyForce(body, {0, 0, -1e39}); });
  world.setMass(body, 1e-3);
  const std::uint64_t before = world.hash();
  expectError("torque", [&] { world.applyForceAt(body, {0, 1e17, 0}, {1e3, 0, 0}); });
  expectError("angular impulse", [&] { world.applyImpulseAt(body, {0, 1e17, 0}, {1e3, 0, 0}); });
  expectError("state.velocity", [&] {
    world.applyImpulseAt(body, {0, 1e17, 0}, world.state(body).position);
  });
  EXPECT_EQ(world.hash(), before);
  for (const double size : {1e-40, 1e30}) {
    state = world.state(body);
    state.orientation = {size, {0, 0, 0}};
    expectError("state.orientation", [&] { world.setState(body, state); });
  }
  const int row = body.index;
  const auto scatter = [&](StateArray which, const std::array<double, 4>& numbers) {
    const std::int64_t columns = which == StateArray::Orientation ? 4 : 3;
    world.scatter(which, {&row, {1, 1}, {4, 4}, "<i4"},
                  {numbers.data(), {1, columns}, {8 * columns, 8}, "<f8"});
  };
  expectError("values[0]", [&] { scatter(StateArray::Position, {1e40, 0, 0, 0}); });
  expectError("values[0]", [&] { scatter(StateArray::Orientation, {0, 0, 0, 0}); });
  expectError("values[0]", [&] { scatter(StateArray::Orientation, {0, 1e17, 0, 0}); });
  EXPECT_NO_THROW(scatter(StateArray::Orientation, {2, 0, 0, 0}));
  const RayQuery far{{0, 0, 5}, {0, 0, -1}, 1e300, {}};
  expectError("rays[0].maxDistance", [&] { world.castRays({&far, 1}); });
}

TEST(Refusal, OfBodiesWhoseInertiaIsInfiniteOrZeroInSinglePrecision) {
  World world(test::tower(1), test::options());
  expectError("body.inertia", [&] { world.addBody(test::body(Shape::box({1e8, 1e8, 1e8}), {})); });
  expectError("body.mass", [&] { world.addBody(test::body(Shape::box({1e13, 1e13, 1e13}), {})); });
  expectError("body.mass", [&] { world.addBody(test::body(Shape::sphere(1e-14), {})); });
  EXPECT_NO_THROW(world.addBody(test::body(Shape::sphere(1e-4), {0, 0, 5})));
}

TEST(Refusal, OfTargetsThatAreNotFinite) {
  Scene scene = test::tower(1);
  scene.bodies[1].motion = Motion::Kinematic;
  World world(scene, test::options());
  expectError("position", [&] { world.setTarget(world.bodyAt(1), {kNan, 0, 0}, {}); });
  expectError("orientation", [&] { world.setTarget(world.bodyAt(1), {}, {kNan, 0, 0, 0}); });
  expectError("orientation", [&] { world.setTarget(world.bodyAt(1), {}, {0, 0, 0, 0}); });
}

TEST(Refusal, OfDampersThatAreNotFinite) {
  JointDef joint;
  joint.type = JointType::Fixed;
  joint.stiffness = joint.angularStiffness = 100;
  EXPECT_NO_THROW(validate(joint, "joint"));
  const auto bad = [&](const std::string& member, double JointDef::*field) {
    for (const double odd : {kNan, kInfinity}) {
      JointDef changed = joint;
      changed.*field = odd;
      expectError("joint" + member, [&] { validate(changed, "joint"); });
    }
  };
  bad(".dampingRatio", &JointDef::dampingRatio);
  bad(".angularDampingRatio", &JointDef::angularDampingRatio);
  bad(".friction", &JointDef::friction);
  JointDef changed = joint;
  changed.axes[2].limitDamping = kInfinity;
  expectError("joint.axes[2].limitDamping", [&] { validate(changed, "joint"); });
}

/// Only an id that was never set means the world, or none.
TEST(Refusal, OfIdsThatNameNothing) {
  Scene scene = test::tower(2);
  scene.deformables = {clothSheet({0, 9, 0}, {1, 0, 0}, {0, 1, 0}, 1, 1)};
  World world(scene, test::options());
  const BodyId body = world.bodyAt(1);
  const DeformableId cloth = world.deformableAt(0);
  AttachmentDef tie;
  tie.vertices = {0};
  for (const int index : {-1, -2, -7, std::numeric_limits<int>::min(), 99}) {
    const BodyId none{index, index == -1 ? 3u : 0u};
    expectError("body", [&] { world.addJoint({}, body, none); });
    expectError("body", [&] { world.addJoint({}, none, body); });
    expectError("body", [&] { world.addAttachment(tie, cloth, none); });
    expectError("deformable", [&] { world.addAttachment(tie, cloth, {}, {none.index, none.generation}); });
  }
  world.step();
}

TEST(Refusal, OfRoomAndThreadsWithoutBound) {
  World world(test::tower(1), test::options());
  expectError("count", [&] { world.reserve("pairs", 2000000000); });
  EXPECT_NO_THROW(world.reserve("pairs", 100000));
  for (const char* backend : {"cpu", "reference", "lockstep"})
    expectError("threads", [&] { World many(test::tower(1), test::options(4, backend, 1000000)); });
}

/// Five bodies of which one cannot be made: what is wrong is found out by the cook alone.
void expectAllOrNothing(const std::string& path, const BodyDef& bad) {
  World world(test::tower(2), test::options());
  const std::uint64_t hash = world.hash();
  const std::size_t bytes = world.memoryBytes(), bodies = world.bodies().size();
  std::vector<BodyDef> several;
  for (int i = 0; i < 5; ++i) several.push_back(test::body(Shape::hull(kCorners), {3. * i, 0, 5}));
  several[0].name = "first";
  several[4] = bad;
  expectError(path, [&] { world.addBodies(several); });
  EXPECT_EQ(world.bodies().size(), bodies);
  EXPECT_THROW(world.findBody("first"), Error);
  EXPECT_EQ(world.memoryBytes(), bytes);
  EXPECT_EQ(world.hash(), hash);
  several.pop_back();
  EXPECT_EQ(world.addBodies(several).size(), 4u);
  EXPECT_EQ(world.bodies().size(), bodies + 4);
}

TEST(Refusal, OfOneOfSeveralBodiesAddsNone) {
  expectAllOrNothing("bodies[4].shape.points",
                     test::body(Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), {}));
  BodyDef inertia = test::body(Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}}), {});
  inertia.inertia = Vec3{1, 2, 2.5};
  expectAllOrNothing("bodies[4].inertia", inertia);
}

}  // namespace
}  // namespace rubble
